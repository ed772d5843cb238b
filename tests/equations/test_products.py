"""Products of expansions by the Gaunt tensor, and derivatives of harmonics, against quadrature."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.sphere import (
    derivative_matrices,
    gaunt_tensor,
    gauss_legendre,
    harmonic_gradients,
    multiplication_matrix,
    product,
    random_directions,
    real_harmonics,
    synthesize,
    triple_product,
)

PUBLISHED = {
    (0, 5, 5): 0.282095,
    (1, 1, 6): -0.126157,
    (3, 3, 6): -0.126157,
    (1, 1, 8): -0.218510,
    (1, 2, 5): 0.218510,
    (1, 3, 4): 0.218510,
    (2, 3, 7): 0.218510,
    (3, 3, 8): 0.218510,
    (2, 2, 6): 0.252313,
    (4, 4, 6): -0.180224,
    (6, 8, 8): -0.180224,
    (4, 5, 7): 0.156078,
    (7, 7, 8): 0.156078,
    (5, 5, 8): -0.156078,
    (5, 5, 6): 0.090112,
    (6, 7, 7): 0.090112,
    (6, 6, 6): 0.180224,
}


@pytest.mark.parametrize(("degree", "count"), [(1, 10), (2, 83), (3, 353), (4, 1158)])
def test_most_of_the_gaunt_tensor_is_zero(degree, count):
    assert np.count_nonzero(gaunt_tensor(degree, degree, degree)) == count


@pytest.mark.parametrize("index", PUBLISHED)
def test_values_of_the_gaunt_tensor(index):
    tensor = gaunt_tensor(2, 2, 2)
    for order in ([0, 1, 2], [1, 2, 0], [2, 1, 0]):
        assert tensor[tuple(index[i] for i in order)] == pytest.approx(PUBLISHED[index], abs=1e-6)


@given(st.integers(0, 2**32 - 1), st.integers(0, 4), st.integers(0, 4))
def test_a_product_has_the_product_of_the_values(seed, one, two):
    rng = np.random.default_rng(seed)
    first = rng.standard_normal((2, (one + 1) ** 2))
    second = rng.standard_normal((2, (two + 1) ** 2))
    directions = random_directions(20, rng)
    found = synthesize(product(first, second), directions)
    expected = synthesize(first, directions) * synthesize(second, directions)
    np.testing.assert_allclose(found, expected, atol=1e-11)


def test_a_product_is_cut_off_where_it_is_asked_to(rng):
    first, second = rng.standard_normal((2, 16))
    np.testing.assert_allclose(product(first, second, 1), product(first, second)[:4], atol=1e-13)
    matrix = multiplication_matrix(second, 3, 2)
    np.testing.assert_allclose(first @ matrix, product(first, second, 2), atol=1e-13)


def test_a_triple_product_is_the_integral(rng):
    light, visibility, lobe = (rng.standard_normal((degree + 1) ** 2) for degree in (2, 3, 4))
    rule = gauss_legendre(9)
    values = np.prod(
        [synthesize(each, rule.directions) for each in (light, visibility, lobe)], axis=0
    )
    assert triple_product(light, visibility, lobe) == pytest.approx(values @ rule.weights)


@pytest.mark.parametrize("degree", range(6))
def test_gradients_are_differences(degree, rng):
    directions = random_directions(40, rng)
    step = 1e-5

    def moved(axis, by):
        points = directions + by * np.eye(3)[axis]
        return real_harmonics(points / np.linalg.norm(points, axis=1, keepdims=True), degree)

    expected = np.stack(
        [(moved(i, step) - moved(i, -step)) / (2 * step) for i in range(3)], axis=-1
    )
    found = harmonic_gradients(directions, degree)
    np.testing.assert_allclose(found, expected, atol=1e-8)
    assert np.abs(np.einsum("kni,ni->kn", found, directions)).max() < 1e-12


def test_derivatives_are_of_the_degree_below():
    degree = degrees(4)
    outside = degree[None, :] != degree[:, None] - 1
    assert not derivative_matrices(4)[:, outside].any()


def test_the_energy_of_the_gradient_is_that_of_laplace(rng):
    rule = gauss_legendre(10)
    gradients = harmonic_gradients(rule.directions, 5)
    energy = np.einsum("kni,kni,n->k", gradients, gradients, rule.weights)
    np.testing.assert_allclose(energy, degrees(5) * (degrees(5) + 1), atol=1e-11)


def test_nonsense_is_refused():
    for call in (
        lambda: gaunt_tensor(1, -1, 1),
        lambda: derivative_matrices(-1),
        lambda: product(np.ones(4), np.ones(5)),
        lambda: multiplication_matrix(np.ones(4), 1, -1),
        lambda: harmonic_gradients(np.ones((2, 3)), 1),
    ):
        with pytest.raises(ArgumentError):
            call()
