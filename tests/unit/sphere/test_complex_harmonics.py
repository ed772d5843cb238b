import numpy as np
import pytest

from harmface.conventions import flat_index, harmonic_count
from harmface.errors import ArgumentError
from harmface.sphere import (
    complex_harmonics,
    complex_to_real,
    random_directions,
    real_harmonics,
    real_to_complex,
)

MAX_DEGREE = 6


@pytest.fixture
def coefficients(rng):
    return rng.standard_normal((2, 3, harmonic_count(MAX_DEGREE)))


def test_both_kinds_of_coefficients_give_the_same_function(coefficients):
    directions = random_directions(20, 1)
    real = coefficients @ real_harmonics(directions, MAX_DEGREE)
    values = real_to_complex(coefficients) @ complex_harmonics(directions, MAX_DEGREE)
    # Sums of K products of the order of 1.
    np.testing.assert_allclose(values, real, atol=harmonic_count(MAX_DEGREE) * 1e-15)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_there_and_back_keeps_coefficients_and_precision(coefficients, dtype):
    coefficients = coefficients.astype(dtype)
    back = complex_to_real(real_to_complex(coefficients))
    assert back.dtype == dtype
    # Two products with sqrt 1/2 round by half an eps each, on both ways.
    np.testing.assert_allclose(back, coefficients, rtol=4 * np.finfo(dtype).eps)


def test_the_conversion_is_unitary():
    matrix = real_to_complex(np.eye(harmonic_count(MAX_DEGREE)))
    np.testing.assert_allclose(matrix @ matrix.conj().T, np.eye(len(matrix)), atol=1e-15)


def test_refuses_coefficients_of_a_function_that_is_not_real(coefficients):
    broken = real_to_complex(coefficients)
    broken[1, 2, flat_index(3, -2)] += 1e-3
    with pytest.raises(ArgumentError, match="real function"):
        complex_to_real(broken)


def test_refuses_a_zonal_coefficient_that_is_not_real():
    with pytest.raises(ArgumentError, match="real function"):
        complex_to_real(np.array([1j, 0, 0, 0]))


def test_refuses_real_numbers_as_complex_coefficients(unchecked):
    with pytest.raises(ArgumentError, match="must be complex"):
        complex_to_real(np.ones(4))


@pytest.mark.parametrize(
    ("convert", "dtype"), [(real_to_complex, float), (complex_to_real, complex)]
)
def test_refuses_what_is_not_a_set_of_coefficients(convert, dtype):
    with pytest.raises(ArgumentError, match="must be a square"):
        convert(np.ones(5, dtype))
    with pytest.raises(ArgumentError, match="must be finite"):
        convert(np.full(4, np.nan, dtype))
