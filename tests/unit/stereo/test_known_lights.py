import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.rendering import harmonic_images
from harmface.stereo import (
    angular_errors,
    normals_from_coefficients,
    normals_from_directions,
    point_source_structure,
    without_rotation,
)
from harmface.stereo.known_lights import normals_from_few, robust_weights


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def test_directions_without_shadow_are_exact(hills, single_lights):
    images = hills.images(single_lights, np.eye(len(single_lights)))
    b = normals_from_directions(images, single_lights, usable=images > 0)
    assert np.allclose(b, hills.b, atol=1e-12)


def test_robust_fit_withstands_highlights_and_cast_shadows(hills, single_lights, rng):
    images = hills.images(single_lights, np.eye(len(single_lights)))
    usable = images > 0
    images = np.abs(images + 0.005 * rng.standard_normal(images.shape))
    draw = rng.random(images.shape)
    images[draw < 0.05] += 1.0
    images[draw > 0.95] *= 0.1
    robust = normals_from_directions(images, single_lights, usable=usable, robust=True)
    plain = normals_from_directions(images, single_lights, usable=usable)
    error = angular_errors(unit(robust), hills.normals).mean()
    # 0.5 % of noise on albedo 0.6 over some 20 images: 0.0083 / sqrt(20 / 3) rad = 0.2 degrees.
    assert error < 0.6
    assert error < 0.1 * angular_errors(unit(plain), hills.normals).mean()


def test_few_lit_observations_are_explained_with_the_dark_ones(ball, single_lights, rng):
    lights = single_lights[::5]
    images = ball.images(lights, np.eye(len(lights)))
    usable = np.ones(images.shape, bool)
    usable[0] = rng.random(len(ball.b)) < 0.5
    few = ((images > 0) & usable).sum(axis=0) == 2
    assert few.sum() > 100
    values, usable = np.where(usable, images, 9.0)[:, few], usable[:, few]
    b = normals_from_few(values, lights, usable)
    # Two equations and the horizons of the dark lights can all be met.
    left = np.where(usable, np.maximum(lights @ b.T, 0) - values, 0)
    assert np.abs(left).max() < 1e-6
    by_lit_alone = normals_from_directions(values, lights, usable=usable & (values > 0))
    errors = [angular_errors(unit(each), ball.normals[few]).mean() for each in (b, by_lit_alone)]
    assert errors[0] < errors[1]


def test_outliers_are_told_where_enough_is_lit(single_lights, rng):
    lights = single_lights[:12]
    b = np.array([0.1, 0.2, 0.9]) + 0.1 * rng.standard_normal((40, 3))
    predicted = lights @ b.T
    values = predicted + 1e-3 * rng.standard_normal(predicted.shape)
    values[0] += 0.3
    usable = np.ones(values.shape, bool)
    usable[5:, :20] = False
    weights = robust_weights(values, predicted, usable)
    assert np.array_equal(weights[:, :20], usable[:, :20])
    # 300 deviations, three times as bad for being above: (2.385 / 900)^2.
    assert weights[0, 20:].max() < 1e-4
    assert np.median(weights[1:, 20:]) > 0.5


def test_what_is_saturated_may_be_left_out_of_harmonic_light(hills, rng):
    light = np.concatenate([rng.uniform(4, 6, (20, 1)), rng.standard_normal((20, 8))], axis=1)
    images = light @ harmonic_images(hills.normals, hills.albedo, 2)
    level = np.percentile(images, 90)
    clipped = np.minimum(images, level)
    b = normals_from_coefficients(clipped, light, usable=images < level)
    assert angular_errors(unit(b), hills.normals).max() < 1e-4
    bent = normals_from_coefficients(clipped, light)
    assert angular_errors(unit(bent), hills.normals).mean() > 0.5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda light: light[:-1], "row for each of the 24 images"),
        (lambda light: light * (1, 1, 0), "span three dimensions"),
        (lambda light: light * np.nan, "finite"),
        (lambda light: light[:, :2], r"shape \(..., 3\)"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(hills, single_lights, change, message):
    images = hills.images(single_lights, np.eye(24))
    with pytest.raises(ArgumentError, match=message):
        normals_from_directions(images, change(single_lights))


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_harmonic_light_is_exact(hills, rng, degree):
    light = rng.standard_normal((30, (degree + 1) ** 2))
    light[:, 0] += 5
    light[:, 4:] *= 0.3
    images = light @ harmonic_images(hills.normals, hills.albedo, degree)
    b = normals_from_coefficients(images, light)
    assert angular_errors(unit(b), hills.normals).max() < 1e-4
    assert np.allclose(np.linalg.norm(b, axis=1), hills.albedo, rtol=1e-6)


@pytest.mark.usefixtures("unchecked")
def test_coefficients_must_match_the_images(hills):
    with pytest.raises(ArgumentError, match="row for each of the 5 images"):
        normals_from_coefficients(np.ones((5, 1600)), np.ones((4, 9)))


def test_equal_point_sources_leave_a_rotation(hills, single_lights):
    images = hills.images(single_lights, np.eye(24))
    b = point_source_structure(images, images > 0)
    turned = without_rotation(unit(b), hills.normals)
    # The robust loop ends at a relative change of 1e-4 in energy.
    assert angular_errors(turned, hills.normals).mean() < 0.1


def test_point_sources_need_six_images(hills, single_lights):
    images = hills.images(single_lights[:5], np.eye(5))
    with pytest.raises(ArgumentError, match="at least 6"):
        point_source_structure(images)


def test_sources_of_no_common_strength_are_refused(hills, rng):
    light = np.exp(rng.normal(0, 3, (24, 1))) * np.eye(3)[np.arange(24) % 3]
    light[:, 2] += 1e-3
    values = np.abs(light @ hills.b.T)
    with pytest.raises(ArgumentError, match="equal strength"):
        point_source_structure(values)
