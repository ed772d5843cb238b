import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, DistantLight, EnvironmentMap, directional_lights, project
from harmface.rendering.irradiance import (
    harmonic_irradiance,
    irradiance_error,
    irradiance_map,
    irradiance_matrix,
    matrix_irradiance,
    polynomial_irradiance,
)
from harmface.sphere import fibonacci_directions, random_directions

NORMALS = random_directions(60, rng=2).reshape(4, 15, 3)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_maps_hold_the_irradiance_of_every_direction(layout, rng):
    coefficients = rng.standard_normal((2, 16))
    form = LAYOUTS[layout]
    found = irradiance_map(coefficients, layout, 16)
    assert found.shape == (2, *form.shape(16))
    shows = form.solid_angles(16) > 0
    expected = harmonic_irradiance(coefficients, form.directions(16)[shows])
    np.testing.assert_allclose(found[..., shows], expected, atol=1e-12)
    assert (found[..., ~shows] == 0).all()
    assert shows.all() == (layout in ("latlong", "cube"))


def test_error_falls_with_degree_and_stays_within_the_worst_case(rng):
    """One light is the worst case: its error is that of the clamped cosine itself, BJ03."""
    light = DistantLight(random_directions(1, rng), np.array([[2.0], [5.0]]))
    normals = random_directions(2000, rng)
    errors = []
    for degree in (2, 4, 8):
        error = irradiance_error(directional_lights(light, degree), light, normals)
        assert error.shape == (2, 2000)
        np.testing.assert_allclose(error[0], error[1], atol=1e-12)
        errors.append(np.abs(error).max())
    assert errors[0] > errors[1] > errors[2]
    # At degree 2 the largest error is 3/32 of the light, RH01 3.1, at the horizon or behind.
    assert 0.08 < errors[0] <= 3 / 32 + 1e-12


def test_environment_of_low_degree_is_reproduced():
    """Light that has no degree above 2 has exactly the irradiance of nine coefficients."""
    form = LAYOUTS["latlong"]
    directions = form.directions(48)
    radiance = 2 + directions[..., 1] + directions[..., 0] * directions[..., 2]
    environment = EnvironmentMap(radiance, form)
    error = irradiance_error(project(environment, 2), environment.as_distant_light(), NORMALS)
    # What is left is the oracle's: its pixels are points, an error of second order.
    assert np.abs(error).max() < (np.pi / 48) ** 2 / 8


def test_precision_is_kept(rng):
    coefficients = rng.standard_normal((3, 9)).astype(np.float32)
    normals = NORMALS.astype(np.float32)
    assert harmonic_irradiance(coefficients, normals).dtype == np.float32
    assert polynomial_irradiance(coefficients, normals).dtype == np.float32
    assert matrix_irradiance(irradiance_matrix(coefficients), normals).dtype == np.float32
    assert irradiance_map(coefficients, "angular", 4).dtype == np.float32


NAN = np.full(9, np.nan)
LIGHT = DistantLight(np.eye(3), np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: harmonic_irradiance(np.ones(8), NORMALS), "square"),
        (lambda: harmonic_irradiance(NAN, NORMALS), "coefficients"),
        (lambda: harmonic_irradiance(np.ones(9), 2 * NORMALS), "unit"),
        (lambda: polynomial_irradiance(np.ones(9), 2 * NORMALS), "normals"),
        (lambda: polynomial_irradiance(np.ones(4), NORMALS), "nine"),
        (lambda: polynomial_irradiance(NAN, NORMALS), "finite"),
        (lambda: irradiance_matrix(np.ones(16)), "nine"),
        (lambda: irradiance_matrix(NAN), "finite"),
        (lambda: matrix_irradiance(np.ones((4, 3)), NORMALS), "matrix"),
        (lambda: matrix_irradiance(np.full((4, 4), np.nan), NORMALS), "matrix"),
        (lambda: matrix_irradiance(np.eye(4), 2 * NORMALS), "normals"),
        (lambda: irradiance_map(np.ones(9), "octahedral", 4), "layout"),
        (lambda: irradiance_map(np.ones(9), "angular", 0), "height"),
        (lambda: irradiance_map(NAN, "angular", 4), "coefficients"),
        (lambda: irradiance_error(np.ones((2, 9)), LIGHT, NORMALS), "dark"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(unchecked, call, said):
    with pytest.raises(ArgumentError, match=said):
        call()


def test_grey_coefficients_have_no_axis_of_channels(rng):
    grey = rng.standard_normal(9)
    normals = fibonacci_directions(40).reshape(5, 8, 3)
    expected = harmonic_irradiance(grey[None], normals)[0]
    assert irradiance_matrix(grey).shape == (4, 4)
    for found in (
        harmonic_irradiance(grey, normals),
        polynomial_irradiance(grey, normals),
        matrix_irradiance(irradiance_matrix(grey), normals),
    ):
        assert found.shape == (5, 8)
        # The published constants have six digits.
        np.testing.assert_allclose(found, expected, atol=2e-5)
    assert irradiance_map(grey, "cube", 4).shape == (6, 4, 4)
