import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.sphere import (
    energy_per_degree,
    gauss_legendre,
    lebedev,
    project,
    project_function,
    random_directions,
    synthesize,
)


@pytest.mark.parametrize("rule", [gauss_legendre, lebedev])
def test_projects_a_polynomial_written_out(rule):
    # x y + z + 2 in the harmonics of RH01 eq. 3.
    def function(w):
        return w[:, 0] * w[:, 1] + w[:, 2] + 2

    expected = np.zeros(9)
    expected[[0, 2, 4]] = 2 / 0.28209479, 1 / 0.48860251, 1 / 1.09254843
    np.testing.assert_allclose(project_function(function, rule(4), 2), expected, atol=1e-7)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_leading_axes_and_precision_are_kept(rng, dtype):
    quadrature = gauss_legendre(6)
    values = rng.standard_normal((2, 3, quadrature.weights.size)).astype(dtype)
    coefficients = project(values, quadrature, 3)
    assert coefficients.shape == (2, 3, 16)
    assert coefficients.dtype == dtype
    np.testing.assert_array_equal(coefficients[1, 2], project(values, quadrature, 3)[1, 2])
    directions = random_directions(20, 1).astype(dtype).reshape(4, 5, 3)
    result = synthesize(coefficients, directions)
    assert result.shape == (2, 3, 4, 5)
    assert result.dtype == dtype
    alone = synthesize(coefficients[1, 2], directions[3, 4])
    np.testing.assert_allclose(result[1, 2, 3, 4], alone, rtol=64 * np.finfo(dtype).eps)


def test_single_precision_is_summed_in_double():
    quadrature = gauss_legendre(200)
    values = np.full(quadrature.weights.size, 0.1, np.float32)
    constant = project(values, quadrature, 0)[0]
    assert constant == np.float32(np.float64(np.float32(0.1)) * np.sqrt(4 * np.pi))


def test_energy_per_degree_keeps_axes_and_precision():
    energy = energy_per_degree(np.arange(18, dtype=np.float32).reshape(2, 9))
    np.testing.assert_array_equal(energy, [[0, 14, 190], [81, 365, 1135]])
    assert energy.dtype == np.float32


def test_refuses_values_that_do_not_fit_the_quadrature():
    with pytest.raises(ArgumentError, match=r"shape \(\.\.\., 15\)"):
        project(np.ones(14), gauss_legendre(4), 2)
    with pytest.raises(ArgumentError, match="values must be finite"):
        project(np.full(15, np.inf), gauss_legendre(4), 2)


def test_refuses_a_quadrature_that_cannot_tell_the_harmonics_apart():
    with pytest.raises(ArgumentError, match="degree 4 or more"):
        project(np.ones(8), gauss_legendre(3), 2)


def test_refuses_what_is_not_a_set_of_coefficients(unchecked):
    direction = np.array([0.0, 0.0, 1.0])
    with pytest.raises(ArgumentError, match="must be a square"):
        synthesize(np.ones(3), direction)
    with pytest.raises(ArgumentError, match="coefficients must be finite"):
        synthesize(np.full(4, np.nan), direction)
    with pytest.raises(ArgumentError, match="coefficients must be finite"):
        energy_per_degree(np.full(4, np.nan))
    with pytest.raises(ArgumentError, match="single number"):
        energy_per_degree(np.float64(1.0))
