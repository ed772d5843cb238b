"""Shares of the first modes of a sphere, by theory and from 4,000 rendered images."""

import numpy as np
import pytest

from harmface.pca import (
    LightDistribution,
    analytic_pca,
    attached_shadow_pca,
    front_lights,
    lighting_pca,
    sphere_gram,
    uniform_lights,
)
from harmface.sphere import fibonacci_directions

DEGREE = 8
ROUNDED = 5e-4
"""Half a unit in the last digit of a published figure."""
AGREEMENT = 0.003

SETUPS = {
    "pixels, mean kept": ("pixels", "all", False, [0.619, 0.151, 0.151, 0.035, 0.015, 0.015]),
    "pixels": ("pixels", "all", True, [0.428, 0.241, 0.241, 0.024, 0.024, 0.019]),
    "normals, mean kept": ("normals", "all", False, [0.512, 0.184, 0.184, 0.053, 0.023, 0.023]),
    "normals": ("normals", "all", True, [0.294, 0.294, 0.277, 0.038, 0.038, 0.028]),
    "pixels, front lights": ("pixels", "front", True, [0.361, 0.361, 0.225, 0.022, 0.022]),
}


def distribution(lights: str) -> LightDistribution:
    return uniform_lights(DEGREE) if lights == "all" else front_lights(DEGREE)


@pytest.mark.parametrize(
    ("measure", "lights", "subtract_mean", "expected"), SETUPS.values(), ids=SETUPS
)
def test_sphere_from_the_front_in_closed_form(measure, lights, subtract_mean, expected):
    pca = lighting_pca(
        sphere_gram(DEGREE, measure), distribution(lights), subtract_mean=subtract_mean
    )
    assert np.abs(pca.fractions[: len(expected)] - expected).max() < ROUNDED


@pytest.mark.parametrize(
    ("measure", "lights", "subtract_mean", "expected"), SETUPS.values(), ids=SETUPS
)
def test_sphere_from_the_front_in_4000_images(measure, lights, subtract_mean, expected):
    normals = front_half(2000)
    weights = normals[:, 2] if measure == "pixels" else None
    directions = fibonacci_directions(4000) if lights == "all" else front_half(8000)
    images = attached_shadow_pca(
        normals, directions, weights=weights, count=len(expected), subtract_mean=subtract_mean
    )
    assert np.abs(images.fractions - expected).max() < AGREEMENT


@pytest.mark.parametrize("subtract_mean", [True, False])
def test_image_of_a_sphere_is_its_closed_form(subtract_mean):
    closed = lighting_pca(sphere_gram(DEGREE, "pixels"), subtract_mean=subtract_mean)
    image = analytic_pca(sphere_image(256), subtract_mean=subtract_mean)
    # Some 800 of 50,000 pixels lie on the rim, each in or out.
    assert np.abs(image.fractions[:6] - closed.fractions[:6]).max() < 1e-3


def test_whole_sphere():
    """All degrees: A_1^2 / 4 pi and A_2^2 / 4 pi over the variance 2 pi / 3 - pi / 4."""
    pca = lighting_pca(sphere_gram(DEGREE, "all"))
    exact = [4 / 15] * 3 + [3 / 80] * 5
    assert np.abs(pca.fractions[:8] - exact).max() < ROUNDED
    published = [0.2667] * 3 + [0.0375] * 5
    assert np.abs(pca.fractions[:8] - published).max() < ROUNDED


@pytest.mark.parametrize("degree", [2, 4, 8, 16])
def test_what_higher_degrees_add(degree):
    """Degrees left out have the rest of the variance 5 pi / 12 of a sphere's irradiance."""
    pca = lighting_pca(sphere_gram(degree, "all"))
    share = 4 / 15 / pca.fractions[0]
    assert abs(pca.eigenvalues.sum() / (5 * np.pi / 12) - share) < 1e-12
    assert 1 - 1 / degree**3 < share < 1


def sphere_image(size: int) -> np.ndarray:
    """Normals of a sphere that fills an orthographic image."""
    x = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(x, -x)
    squared = 1 - x**2 - y**2
    normals = np.stack([x, y, np.sqrt(np.maximum(squared, 0))], axis=-1)
    return np.where(squared[..., None] > 0, normals, 0)


def front_half(count: int) -> np.ndarray:
    directions = fibonacci_directions(count)
    return directions[directions[:, 2] > 0]
