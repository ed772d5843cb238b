import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, EnvironmentMap, project, project_map
from harmface.light.projection import pixels
from harmface.light.projection.latlong import fejer_weights
from harmface.sphere import real_harmonics, synthesize

EPS = np.finfo(float).eps


def relative(found, expected):
    return np.linalg.norm(found - expected) / np.linalg.norm(expected)


def band_limited(layout, height, max_degree, channels=(3,), seed=0):
    """Return random coefficients and the map that has them."""
    coefficients = np.random.default_rng(seed).standard_normal((*channels, (max_degree + 1) ** 2))
    return coefficients, synthesize(coefficients, LAYOUTS[layout].directions(height))


@pytest.mark.parametrize(("height", "max_degree"), [(64, 20), (9, 4), (5, 2), (130, 3), (1, 0)])
def test_band_limited_latlong_maps_give_their_coefficients_back(height, max_degree):
    coefficients, radiance = band_limited("latlong", height, max_degree)
    # Synthesis and projection each err by about eps a degree.
    assert relative(project_map(radiance, "latlong", max_degree), coefficients) < (
        16 * EPS * (2 * max_degree + 1)
    )


def test_single_precision():
    coefficients, radiance = band_limited("latlong", 96, 20)
    found = project_map(radiance.astype(np.float32), "latlong", 20)
    assert found.dtype == np.float32
    # Rounded pixels, rounded rows and blocks of 64 terms: each a few eps of float32.
    assert relative(found, coefficients) < 4 * np.finfo(np.float32).eps


@pytest.mark.parametrize("order", ["planar", "interleaved", "reversed"])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_order_in_memory_does_not_matter(layout, order):
    _, radiance = band_limited(layout, 12, 3)
    expected = project_map(radiance, layout, 3)
    last = np.moveaxis(radiance, 0, -1)
    if order == "interleaved":
        radiance = np.moveaxis(np.ascontiguousarray(last), -1, 0)
    if order == "reversed":
        radiance = np.moveaxis(np.ascontiguousarray(last[..., ::-1])[..., ::-1], -1, 0)
    np.testing.assert_allclose(project_map(radiance, layout, 3), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("layout", ["angular", "mirror-ball", "cube"])
def test_other_layouts_sum_harmonics_over_pixels(layout):
    form = LAYOUTS[layout]
    _, radiance = band_limited(layout, 15, 4)
    weighted = radiance * form.solid_angles(15)
    harmonics = real_harmonics(form.directions(15), 4)
    expected = np.tensordot(weighted.reshape(3, -1), harmonics.reshape(25, -1).T, axes=1)
    np.testing.assert_allclose(project_map(radiance, layout, 4), expected, atol=1e-12)


@pytest.mark.parametrize("layout", ["angular", "cube"])
def test_error_of_other_layouts_is_of_second_order(layout):
    errors = []
    for height in (16, 32, 64):
        coefficients, radiance = band_limited(layout, height, 2)
        errors.append(relative(project_map(radiance, layout, 2), coefficients))
    assert errors[0] / errors[1] > 3
    assert errors[1] / errors[2] > 3
    assert errors[2] < 2e-3


def test_tables_too_large_for_the_cache_give_the_same(monkeypatch):
    _, radiance = band_limited("cube", 24, 3)
    expected = project_map(radiance, "cube", 3)
    monkeypatch.setattr(pixels, "MAX_CACHED", 0)
    monkeypatch.setattr(pixels, "BLOCK", 100)
    np.testing.assert_allclose(project_map(radiance, "cube", 3), expected, atol=1e-13)


@pytest.mark.parametrize(("height", "max_degree"), [(4, 6), (8, 3), (1, 2)])
def test_areas_are_exact_for_maps_constant_on_each_pixel(height, max_degree):
    """Against a fine map with the same value on every part of a pixel."""
    coarse = np.random.default_rng(3).random((height, 2 * height))
    parts = 96
    fine = coarse.repeat(parts, axis=0).repeat(parts, axis=1)
    expected = project_map(fine, "latlong", max_degree, "areas")
    np.testing.assert_allclose(
        project_map(coarse, "latlong", max_degree, "areas"), expected, atol=1e-12
    )
    # The plain sum over the fine map, an independent check to second order in its pixels.
    form = LAYOUTS["latlong"]
    weighted = fine * form.solid_angles(height * parts)
    harmonics = real_harmonics(form.directions(height * parts), max_degree)
    plain = np.tensordot(harmonics, weighted, axes=2)
    bound = (max_degree * np.pi / (height * parts)) ** 2 * np.abs(plain).max()
    np.testing.assert_allclose(expected, plain, atol=bound)


@pytest.mark.parametrize("count", [1, 2, 3, 8, 31])
def test_fejer_weights_are_positive_and_integrate_polynomials(count):
    weights = fejer_weights(count)
    assert weights.min() > 0
    heights = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    for power in range(count):
        exact = 2 / (power + 1) if power % 2 == 0 else 0
        assert weights @ heights**power == pytest.approx(exact, abs=8 * EPS)


def test_sums_of_large_single_precision_maps_keep_their_digits():
    # Added one by one in float32 the half million values would lose three digits.
    radiance = np.full((512, 1024), 0.1, np.float32)
    found = project_map(radiance, "latlong", 0)
    assert found[0] == pytest.approx(np.sqrt(4 * np.pi) * np.float32(0.1), rel=2e-7)


def test_frame_of_a_map_is_that_of_the_world():
    coefficients, radiance = band_limited("latlong", 16, 3)
    mirror = np.diag([1.0, 1.0, -1.0])
    environment = EnvironmentMap(radiance - radiance.min(), LAYOUTS["latlong"], mirror)
    found = project(environment, 3)
    shown = synthesize(coefficients, LAYOUTS["latlong"].directions(16)) - radiance.min()
    np.testing.assert_allclose(synthesize(found, environment.directions), shown, atol=1e-11)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")
def test_values_that_are_not_finite_are_refused(layout, value):
    radiance = np.ones(LAYOUTS[layout].shape(6))
    radiance[..., 3, 3] = value
    with pytest.raises(ArgumentError, match="finite"):
        project_map(radiance, layout, 1)


@pytest.mark.parametrize(
    ("layout", "max_degree", "rule", "said"),
    [
        ("latlong", 4, "samples", "rows"),
        ("latlong", -1, "samples", "max_degree"),
        ("cube", 1, "areas", "rule"),
        ("latlong", 1, "midpoint", "rule"),
        ("octahedral", 1, "samples", "layout"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(unchecked, layout, max_degree, rule, said):
    shape = LAYOUTS[layout].shape(4) if layout in LAYOUTS else (4, 4)
    with pytest.raises(ArgumentError, match=said):
        project_map(np.ones(shape), layout, max_degree, rule)


def test_shape_must_fit_the_layout():
    with pytest.raises(ArgumentError, match="twice as wide"):
        project_map(np.ones((4, 6)), "latlong", 1)
