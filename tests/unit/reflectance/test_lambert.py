from fractions import Fraction

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.reflectance import (
    clamped_cosine_coefficients,
    energy_by_degree,
    lambda_normalization,
    lambert_coefficients,
    lambert_per_coefficient,
    mean_accuracy_bound,
    truncation_error,
)

EPS = np.finfo(float).eps


def exact(max_degree: int) -> list[float]:
    """Return A_l by the ratio A_l / A_(l-2) = (3 - l) / (l + 2), in exact fractions of pi."""
    fractions = [Fraction(1), Fraction(2, 3)]
    for degree in range(2, max_degree + 1):
        fractions.append(fractions[degree - 2] * Fraction(3 - degree, degree + 2))
    return [np.pi * float(fraction) for fraction in fractions[: max_degree + 1]]


@pytest.mark.parametrize("max_degree", [0, 1, 2, 3, 1000, 1001])
def test_coefficients_are_exact_at_any_degree(max_degree):
    coefficients = lambert_coefficients(max_degree)
    assert coefficients.shape == (max_degree + 1,)
    np.testing.assert_allclose(coefficients, exact(max_degree), rtol=3 * EPS)


def test_degrees_far_beyond_the_factorials_that_float64_holds():
    # Stirling: A_l tends to 2 pi sqrt(2 / pi) l^(-5/2), with a correction of order 1 / l.
    degree = 4000
    expected = 2 * np.pi * np.sqrt(2 / np.pi) * degree**-2.5
    assert abs(lambert_coefficients(degree)[-1]) == pytest.approx(expected, rel=2 / degree)


def test_every_flat_index_has_the_coefficient_of_its_degree():
    a0, a1, a2 = lambert_coefficients(2)
    np.testing.assert_array_equal(lambert_per_coefficient(2), [a0, *[a1] * 3, *[a2] * 5])


def test_energies_add_up_to_that_of_the_clamped_cosine():
    # The tail falls as the cube of the degree: squares of 2 l A_l^2 / (4 pi) summed.
    assert 0 < 1 - energy_by_degree(200).sum() < 200**-3


@pytest.mark.parametrize(
    "function",
    [
        clamped_cosine_coefficients,
        energy_by_degree,
        lambda_normalization,
        lambert_coefficients,
        lambert_per_coefficient,
        mean_accuracy_bound,
        truncation_error,
    ],
)
def test_refuses_a_negative_degree(function):
    with pytest.raises(ArgumentError, match="max_degree must be 0 or more"):
        function(-1)
