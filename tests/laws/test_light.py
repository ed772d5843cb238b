"""Identities of light: linearity, rotation, power, and what cannot be negative."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from harmface.light import (
    LAYOUTS,
    DistantLight,
    EnvironmentMap,
    add_lights,
    directional_lights,
    non_negative_window,
    project,
    project_map,
    transformed,
    windowed,
)
from harmface.reflectance import lambert_coefficients
from harmface.rendering.irradiance import harmonic_irradiance
from harmface.sphere import random_directions, rotate, synthesize

NORMALS = random_directions(200, rng=3)
seeds = st.integers(0, 2**32 - 1)


def random_rotation(rng):
    return Rotation.random(rng=rng).as_matrix()


@given(seeds, st.sampled_from(sorted(LAYOUTS)), st.integers(1, 12), st.integers(0, 3))
def test_projection_is_linear(seed, layout, height, max_degree):
    max_degree = min(max_degree, height - 1)
    first, second = np.random.default_rng(seed).standard_normal((2, *LAYOUTS[layout].shape(height)))
    together = project_map(2 * first - 3 * second, layout, max_degree)
    apart = 2 * project_map(first, layout, max_degree) - 3 * project_map(second, layout, max_degree)
    np.testing.assert_allclose(together, apart, atol=1e-12)


@given(seeds, st.sampled_from(sorted(LAYOUTS)), st.integers(1, 12))
def test_degree_zero_is_the_mean_radiance(seed, layout, height):
    form = LAYOUTS[layout]
    radiance = np.random.default_rng(seed).random((3, *form.shape(height)))
    mean = project_map(radiance, layout, 0)[:, 0] / np.sqrt(4 * np.pi)
    assert (radiance.min() - 1e-12 <= mean).all() and (mean <= radiance.max() + 1e-12).all()
    if layout != "latlong":  # whose samples Fejer's rule weights otherwise than areas
        total = EnvironmentMap(radiance, form).total()
        np.testing.assert_allclose(mean * 4 * np.pi, total, rtol=1e-13)


@given(seeds, st.integers(0, 4))
def test_turning_the_light_is_turning_normals_back(seed, max_degree):
    """RH01 3.2."""
    rng = np.random.default_rng(seed)
    coefficients = rng.standard_normal((3, (max_degree + 1) ** 2))
    rotation = random_rotation(rng)
    turned = harmonic_irradiance(rotate(coefficients, rotation), NORMALS)
    back = harmonic_irradiance(coefficients, NORMALS @ rotation)
    np.testing.assert_allclose(turned, back, atol=1e-12)


@given(seeds)
def test_turning_a_map_turns_its_coefficients_and_its_lights(seed):
    rng = np.random.default_rng(seed)
    environment = EnvironmentMap(rng.random((3, 8, 16)), LAYOUTS["latlong"])
    rotation = random_rotation(rng)
    turned = environment.rotated(rotation)
    np.testing.assert_allclose(
        project(turned, 3), rotate(project(environment, 3), rotation), atol=1e-12
    )
    np.testing.assert_allclose(
        turned.as_distant_light().directions,
        environment.as_distant_light().rotated(rotation).directions,
        atol=1e-12,
    )


@given(seeds)
def test_moves_one_after_the_other_are_one_move(seed):
    """Rotations and mirrors form a group, and so do their effects."""
    rng = np.random.default_rng(seed)
    coefficients = rng.standard_normal(16)
    first, second = random_rotation(rng), -random_rotation(rng)
    np.testing.assert_allclose(
        transformed(transformed(coefficients, first), second),
        transformed(coefficients, second @ first),
        atol=1e-12,
    )


@given(seeds, st.integers(1, 6))
def test_lights_add_up(seed, count):
    rng = np.random.default_rng(seed)
    lights = [DistantLight(random_directions(2, rng), rng.random((3, 2))) for _ in range(count)]
    together = lights[0]
    for light in lights[1:]:
        together = together + light
    np.testing.assert_allclose(
        directional_lights(together, 3),
        add_lights(*(directional_lights(light, 3) for light in lights)),
        atol=1e-13,
    )


@pytest.mark.parametrize("max_degree", [1, 2, 3, 6])
@given(seed=seeds, count=st.integers(1, 4))
def test_windowed_irradiance_of_any_light_is_not_negative(max_degree, seed, count):
    rng = np.random.default_rng(seed)
    light = DistantLight(random_directions(count, rng), rng.exponential(size=count) ** 3)
    window = non_negative_window(lambert_coefficients(max_degree))
    coefficients = windowed(directional_lights(light, max_degree), window)
    # The normals where it is least are behind the lights: look there too.
    normals = np.concatenate([NORMALS, -light.directions])
    assert harmonic_irradiance(coefficients, normals).min() > -1e-13 * light.total()


@given(seed=seeds, max_degree=st.integers(0, 5))
def test_windowed_radiance_of_any_light_is_not_negative(seed, max_degree):
    rng = np.random.default_rng(seed)
    light = DistantLight(random_directions(3, rng), rng.random(3))
    window = non_negative_window(np.ones(max_degree + 1))
    coefficients = windowed(directional_lights(light, max_degree), window)
    assert synthesize(coefficients, NORMALS).min() > -1e-12 * light.total()


@given(seeds, st.integers(6, 300))
def test_gathering_lights_keeps_their_power(seed, n_directions):
    rng = np.random.default_rng(seed)
    light = DistantLight(random_directions(400, rng), rng.random((2, 400)))
    gathered = light.gathered(n_directions)
    assert len(gathered.directions) <= n_directions
    np.testing.assert_allclose(gathered.total(), light.total(), rtol=1e-13)
