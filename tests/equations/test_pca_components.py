"""The K x K eigenproblem against the covariance of the pixels, R05 0.3.3."""

import numpy as np
import pytest

from harmface.pca import LightDistribution, analytic_pca
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics

DEGREE, PIXELS = 4, 80
ROUNDING = 1e3 * np.finfo(np.float64).eps
"""Sums over 80 pixels and 25 harmonics, two square roots of matrices."""


@pytest.fixture
def scene(rng):
    """Normals, albedo, weights and a light with a mean and correlated coefficients."""
    normals = rng.normal(size=(PIXELS, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    spread = rng.normal(size=(25, 25))
    light = LightDistribution(rng.normal(size=25), spread @ spread.T)
    return normals, rng.uniform(0.2, 0.9, PIXELS), rng.uniform(0.5, 2.0, PIXELS), light


def covariance_of_pixels(normals, albedo, light, subtract_mean):
    images = albedo * lambert_per_coefficient(DEGREE)[:, None] * real_harmonics(normals, DEGREE)
    covariance = images.T @ light.covariance @ images
    mean = light.mean @ images
    return covariance if subtract_mean else covariance + np.outer(mean, mean)


@pytest.mark.parametrize("subtract_mean", [True, False])
def test_eigenvalues_are_those_of_the_pixel_covariance(scene, subtract_mean):
    normals, albedo, weights, light = scene
    pixels = covariance_of_pixels(normals, albedo, light, subtract_mean)
    roots = np.sqrt(weights)
    expected = np.linalg.eigvalsh(roots[:, None] * pixels * roots)[::-1][:25]
    pca = analytic_pca(normals, albedo, weights, light, DEGREE, subtract_mean)
    assert np.abs(pca.eigenvalues - expected).max() < ROUNDING * expected[0]
    assert np.abs(pca.fractions - expected / expected.sum()).max() < ROUNDING
    assert abs(pca.cumulative[4] - expected[:5].sum() / expected.sum()) < ROUNDING


@pytest.mark.parametrize("subtract_mean", [True, False])
def test_modes_are_eigenvectors_of_the_pixel_covariance(scene, subtract_mean):
    normals, albedo, weights, light = scene
    pixels = covariance_of_pixels(normals, albedo, light, subtract_mean)
    pca = analytic_pca(normals, albedo, weights, light, DEGREE, subtract_mean)
    # Degree 3 reflects nothing, so 18 modes are left of 25.
    assert len(pca.expansion) == 18
    modes = pca.modes(18)
    residual = (modes * weights) @ pixels - pca.eigenvalues[:18, None] * modes
    assert np.abs(residual).max() < ROUNDING * pca.eigenvalues[0]
    # The least mode has as much less precision as it has variance.
    precision = ROUNDING * pca.eigenvalues[0] / pca.eigenvalues[17]
    assert np.abs((modes * weights) @ modes.T - np.eye(18)).max() < precision
