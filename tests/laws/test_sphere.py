"""Identities of the harmonics, for any direction, rotation and function."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation
from scipy.special import eval_legendre

from harmface.conventions import degrees, harmonic_count
from harmface.sphere import (
    energy_per_degree,
    gauss_legendre,
    lebedev,
    project,
    real_harmonics,
    rotate,
    rotation_matrices,
    synthesize,
)

EPS = np.finfo(float).eps
MAX_DEGREE = 12
K = harmonic_count(MAX_DEGREE)
components = st.floats(-1, 1, allow_subnormal=False)


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


directions = (
    arrays(float, 3, elements=components).filter(lambda v: np.linalg.norm(v) > 1e-3).map(unit)
)
rotations = (
    arrays(float, 4, elements=components)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(lambda q: Rotation.from_quat(q).as_matrix())
)
functions = arrays(float, K, elements=components)


def accuracy(degree: np.ndarray | int) -> np.ndarray | float:
    """Return how well a harmonic of a degree is known."""
    return 64 * EPS * (2 * degree + 1)


@pytest.mark.parametrize("rule", [gauss_legendre, lebedev])
def test_harmonics_are_orthonormal(rule):
    quadrature = rule(2 * MAX_DEGREE)
    harmonics = real_harmonics(quadrature.directions, MAX_DEGREE)
    gram = (harmonics * quadrature.weights) @ harmonics.T
    assert (np.abs(gram - np.eye(K)) <= accuracy(degrees(MAX_DEGREE))).all()


@given(directions, directions)
def test_addition_theorem(a, b):
    products = real_harmonics(a, MAX_DEGREE) * real_harmonics(b, MAX_DEGREE)
    sums = np.add.reduceat(products, np.arange(MAX_DEGREE + 1) ** 2)
    degree = np.arange(MAX_DEGREE + 1)
    legendre = (2 * degree + 1) / (4 * np.pi) * eval_legendre(degree, np.clip(a @ b, -1, 1))
    assert (np.abs(sums - legendre) <= accuracy(degree) * (2 * degree + 1) / (2 * np.pi)).all()


@given(directions)
def test_parity(direction):
    odd = (-1.0) ** degrees(MAX_DEGREE)
    np.testing.assert_array_equal(
        real_harmonics(-direction, MAX_DEGREE), odd * real_harmonics(direction, MAX_DEGREE)
    )


@given(rotations, directions)
def test_harmonics_are_equivariant(rotation, direction):
    still, turned = (real_harmonics(d, MAX_DEGREE) for d in (direction, rotation @ direction))
    for degree, matrix in enumerate(rotation_matrices(rotation, MAX_DEGREE)):
        rows = slice(degree**2, (degree + 1) ** 2)
        assert np.abs(matrix @ still[rows] - turned[rows]).max() <= accuracy(degree)


@given(rotations, rotations)
def test_rotations_compose(first, second):
    both = rotation_matrices(second @ first, MAX_DEGREE)
    one, other = rotation_matrices(first, MAX_DEGREE), rotation_matrices(second, MAX_DEGREE)
    for degree in range(MAX_DEGREE + 1):
        assert np.abs(other[degree] @ one[degree] - both[degree]).max() <= accuracy(degree)


@given(functions, rotations)
def test_rotation_keeps_the_energy_of_every_degree(coefficients, rotation):
    before, after = (
        energy_per_degree(coefficients),
        energy_per_degree(rotate(coefficients, rotation)),
    )
    assert (np.abs(after - before) <= accuracy(np.arange(MAX_DEGREE + 1)) * before).all()


@given(functions, rotations)
def test_turning_back_undoes_turning(coefficients, rotation):
    back = rotate(rotate(coefficients, rotation), rotation.T)
    assert (np.abs(back - coefficients) <= 2 * K * accuracy(degrees(MAX_DEGREE))).all()


@pytest.mark.parametrize("rule", [gauss_legendre, lebedev])
@given(functions)
def test_projection_undoes_synthesis(rule, coefficients):
    quadrature = rule(2 * MAX_DEGREE)
    back = project(synthesize(coefficients, quadrature.directions), quadrature, MAX_DEGREE)
    assert (np.abs(back - coefficients) <= K * accuracy(degrees(MAX_DEGREE))).all()


@given(functions)
def test_parseval(coefficients):
    quadrature = gauss_legendre(2 * MAX_DEGREE)
    integral = synthesize(coefficients, quadrature.directions) ** 2 @ quadrature.weights
    energy = energy_per_degree(coefficients).sum()
    assert abs(integral - energy) <= K * accuracy(MAX_DEGREE) * energy


@given(functions, rotations)
def test_equivariance_of_functions(coefficients, rotation):
    points = gauss_legendre(6).directions
    turned = synthesize(rotate(coefficients, rotation), points @ rotation.T)
    assert np.abs(turned - synthesize(coefficients, points)).max() <= K * accuracy(MAX_DEGREE)
