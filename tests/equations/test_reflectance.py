"""Irradiance as a convolution: RH01 eq. 5-8 and R05 eq. 21-28, against quadrature."""

import numpy as np
import pytest
from scipy.special import eval_legendre

from harmface.reflectance import (
    clamped_cosine_coefficients,
    lambda_normalization,
    lambert_coefficients,
    lambert_per_coefficient,
)
from harmface.sphere import random_directions, real_harmonics, rotate_zonal, synthesize

EPS = np.finfo(float).eps
MAX_DEGREE = 40


def upper_half(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return heights and weights on [0, 1], exact for polynomials of degree 2 nodes - 1."""
    heights, weights = np.polynomial.legendre.leggauss(nodes)
    return (heights + 1) / 2, weights / 2


def hemisphere(normal: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return directions and weights over the half of the sphere that a normal sees."""
    heights, weights = upper_half(degree // 2 + 1)
    azimuths = 2 * np.pi / (degree + 1) * np.arange(degree + 1)
    _, _, frame = np.linalg.svd(normal[np.newaxis])
    radii = np.sqrt(1 - heights**2)
    around = np.cos(azimuths)[:, np.newaxis] * frame[1] + np.sin(azimuths)[:, np.newaxis] * frame[2]
    directions = (
        heights[:, np.newaxis, np.newaxis] * normal + radii[:, np.newaxis, np.newaxis] * around
    )
    return directions.reshape(-1, 3), np.repeat(weights * 2 * np.pi / azimuths.size, azimuths.size)


def test_rh01_eq_5_and_7_irradiance_is_a_product_of_coefficients(rng):
    degree = 9
    light = rng.standard_normal((degree + 1) ** 2)
    for normal in random_directions(5, 3):
        directions, weights = hemisphere(normal, degree + 1)
        integral = (synthesize(light, directions) * (directions @ normal)) @ weights
        irradiance = synthesize(lambert_per_coefficient(degree) * light, normal)
        assert irradiance == pytest.approx(integral, abs=64 * EPS * light.size * (2 * degree + 1))


def test_rh01_eq_6_and_r05_eq_24_relate_both_kinds_of_coefficients():
    np.testing.assert_allclose(
        lambda_normalization(MAX_DEGREE) * clamped_cosine_coefficients(MAX_DEGREE),
        lambert_coefficients(MAX_DEGREE),
        rtol=4 * EPS,
    )
    degree = np.arange(MAX_DEGREE + 1)
    # Lambda_l Y_l0 is the Legendre polynomial, which is 1 at the pole.
    zonal = real_harmonics(np.array([0.0, 0.0, 1.0]), MAX_DEGREE)[degree * (degree + 1)]
    np.testing.assert_allclose(lambda_normalization(MAX_DEGREE) * zonal, 1, rtol=64 * EPS * 81)


def test_rh01_eq_8_against_the_integral():
    heights, weights = upper_half(MAX_DEGREE // 2 + 2)
    degree = np.arange(MAX_DEGREE + 1)[:, np.newaxis]
    integrals = 2 * np.pi * (eval_legendre(degree, heights) * heights) @ weights
    np.testing.assert_allclose(lambert_coefficients(MAX_DEGREE), integrals, atol=64 * EPS)


def test_r05_eq_21_and_25_the_clamped_cosine_has_these_coefficients():
    up = np.array([0.0, 0.0, 1.0])
    directions, weights = hemisphere(up, MAX_DEGREE + 1)
    integrals = real_harmonics(directions, MAX_DEGREE) @ (weights * directions[:, 2])
    coefficients = rotate_zonal(clamped_cosine_coefficients(MAX_DEGREE), up)
    tolerance = 64 * EPS * (2 * MAX_DEGREE + 1)
    np.testing.assert_allclose(coefficients, integrals, atol=tolerance)
