import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harmface.errors import ArgumentError
from harmface.recognition import orthonormal_basis, subspace_distances


def test_rows_are_orthonormal_and_span_the_images(rng):
    images = rng.standard_normal((3, 9, 40))
    basis = orthonormal_basis(images, 9)
    assert np.allclose(basis @ basis.swapaxes(1, 2), np.eye(9))
    assert np.allclose(images @ basis.swapaxes(1, 2) @ basis, images)


def test_a_smaller_subspace_keeps_the_strongest_directions(rng):
    images = np.diag([5.0, 4.0, 0.1])
    assert np.allclose(np.abs(orthonormal_basis(images, 2)), np.eye(3)[:2])


def test_dimensions_that_the_images_do_not_have_take_no_part():
    images = np.outer([1.0, 2.0, 3.0], [1.0, 1.0, 0.0, 0.0])
    basis = orthonormal_basis(images, 3)
    assert np.allclose(np.linalg.norm(basis, axis=1), [1, 0, 0])
    narrow = orthonormal_basis(np.eye(2)[[0, 1, 0, 1]], 4)
    assert narrow.shape == (4, 2)
    assert np.allclose(narrow[2:], 0)


@given(seed=st.integers(0, 2**32 - 1), scale=st.floats(1e-6, 1e6))
def test_distance_is_the_relative_residual_of_least_squares(seed, scale):
    rng = np.random.default_rng(seed)
    images, probe = rng.standard_normal((4, 30)), rng.standard_normal(30)
    basis = orthonormal_basis(images, 4)
    fit = np.linalg.lstsq(images.T, probe, rcond=None)[0] @ images
    expected = np.linalg.norm(probe - fit) / np.linalg.norm(probe)
    distance = subspace_distances(scale * probe[None], basis[None])[0, 0]
    assert distance == pytest.approx(expected, abs=1e-7)


def test_every_pair_is_compared_and_single_precision_stays(rng):
    bases = orthonormal_basis(rng.standard_normal((5, 3, 20)), 3).astype(np.float32)
    probes = rng.random((7, 20)).astype(np.float32)
    distances = subspace_distances(probes, bases)
    assert distances.dtype == np.float32
    each = [[subspace_distances(p[None], b[None])[0, 0] for b in bases] for p in probes]
    assert np.allclose(distances, each, atol=1e-6)


def test_an_image_inside_is_at_zero_and_one_outside_at_one():
    basis = np.eye(4)[None, :2]
    distances = subspace_distances(np.array([[3.0, 4, 0, 0], [0, 0, 0, 2]]), basis)
    assert np.allclose(distances, [[0], [1]], atol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: orthonormal_basis(np.ones((2, 5)), 3), "fewer|at least 3"),
        (lambda: orthonormal_basis(np.zeros((3, 5)), 3), "all be black"),
        (lambda: orthonormal_basis(np.full((3, 5), np.nan), 3), "finite"),
        (lambda: orthonormal_basis(np.ones((3, 5)), 0), "1 or more"),
        (lambda: subspace_distances(np.zeros((1, 4)), np.eye(4)[None]), "all black"),
        (lambda: subspace_distances(np.ones((1, 3)), np.eye(4)[None]), "4 pixels"),
        (lambda: subspace_distances(np.full((1, 4), np.inf), np.eye(4)[None]), "finite"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
