"""RH01 eq. 1, 7, 10-13: irradiance by integration and in its three closed forms."""

import numpy as np
import pytest

from harmface.light import LAYOUTS, PUBLISHED_PROBES, project_map, published_probe
from harmface.rendering.irradiance import (
    C1,
    C2,
    C3,
    C4,
    C5,
    harmonic_irradiance,
    irradiance_matrix,
    matrix_irradiance,
    polynomial_irradiance,
)
from harmface.sphere import gauss_legendre, random_directions, real_harmonics, synthesize

NORMALS = random_directions(500, rng=11)


def test_constants_of_equation_12():
    printed = [0.429043, 0.511664, 0.743125, 0.886227, 0.247708]
    # The paper multiplied A_l and eq. 3 as printed, each of six digits: 0.743125 is 0.7431239.
    np.testing.assert_allclose([C1, C2, C3, C4, C5], printed, rtol=2e-6)


def test_equations_7_11_and_13_agree(rng):
    coefficients = rng.standard_normal((20, 3, 9))
    terms = harmonic_irradiance(coefficients, NORMALS)
    by_matrix = matrix_irradiance(irradiance_matrix(coefficients), NORMALS)
    by_polynomial = polynomial_irradiance(coefficients, NORMALS)
    assert terms.shape == by_matrix.shape == by_polynomial.shape == (20, 3, 500)
    np.testing.assert_allclose(by_matrix, terms, atol=1e-13)
    np.testing.assert_allclose(by_polynomial, terms, atol=1e-13)


@pytest.mark.parametrize("name", PUBLISHED_PROBES)
def test_equations_agree_on_the_published_probes(name):
    coefficients = published_probe(name)
    terms = harmonic_irradiance(coefficients, NORMALS)
    scale = np.abs(terms).max()
    for other in (
        matrix_irradiance(irradiance_matrix(coefficients), NORMALS),
        polynomial_irradiance(coefficients, NORMALS),
    ):
        assert np.abs(other - terms).max() < 1e-14 * scale


def test_matrix_is_symmetric_with_eight_of_its_numbers_and_a_trace():
    matrix = irradiance_matrix(np.arange(1.0, 10.0))
    np.testing.assert_array_equal(matrix, matrix.T)
    assert matrix[0, 0] == -matrix[1, 1]


def test_equation_7_is_the_integral_of_equation_1(rng):
    """The hemisphere about every normal, integrated in its own polar angles."""
    coefficients = rng.standard_normal((2, 16))
    # In height over the hemisphere the integrand is a polynomial: degree 3 and the cosine.
    nodes, weights = np.polynomial.legendre.leggauss(4)
    height, weights = (nodes + 1) / 2, weights / 2
    azimuth = 2 * np.pi * np.arange(8) / 8
    for normal in NORMALS[:20]:
        side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        side /= np.linalg.norm(side)
        across = np.cos(azimuth)[:, None] * side + np.sin(azimuth)[:, None] * np.cross(normal, side)
        root = np.sqrt(1 - height**2)
        directions = height[:, None, None] * normal + root[:, None, None] * across
        radiance = synthesize(coefficients, directions)
        expected = np.einsum("chp,h->c", radiance, height * weights) * 2 * np.pi / 8
        np.testing.assert_allclose(
            harmonic_irradiance(coefficients, normal[None])[:, 0], expected, atol=1e-13
        )


def test_equation_10_is_the_integral_over_the_sphere():
    """A map of a function that is no harmonic series, against Gauss-Legendre at high degree."""

    def radiance(directions):
        return np.exp(directions @ [0.5, 1.0, -0.7])

    rule = gauss_legendre(60)
    expected = (rule.weights * radiance(rule.directions)) @ real_harmonics(rule.directions, 2).T
    form = LAYOUTS["latlong"]
    found = project_map(radiance(form.directions(32)), "latlong", 2)
    np.testing.assert_allclose(found, expected, atol=1e-13)
