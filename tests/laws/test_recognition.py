"""What holds of every gallery and every probe."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from harmface.recognition import (
    extreme_lights,
    lamp_images,
    non_negative_distances,
    orthonormal_basis,
    posteriors,
    subspace_distances,
)
from harmface.recognition.evaluation import cumulative_match
from harmface.recognition.non_negative_4d import non_negative_distances_4d

SEEDS = st.integers(0, 2**32 - 1)


def world(seed):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((5, 30)), rng.standard_normal((3, 9, 30)), rng


@given(seed=SEEDS, dimension=st.integers(1, 8))
def test_a_larger_subspace_is_never_farther(seed, dimension):
    probes, images, _ = world(seed)
    small, large = (
        subspace_distances(probes, orthonormal_basis(images, d)) for d in (dimension, dimension + 1)
    )
    assert (large <= small + 1e-9).all()


@given(seed=SEEDS, scale=st.floats(1e-3, 1e3))
def test_exposure_plays_no_part_under_non_negative_light(seed, scale):
    probes, images, _ = world(seed)
    one, other = (non_negative_distances(s * probes, images) for s in (1.0, scale))
    # Distances are roots: 1e-6 is the root of the tolerance of the search.
    assert np.allclose(one, other, atol=1e-4)


@given(seed=SEEDS)
def test_light_that_may_be_negative_is_never_farther(seed):
    probes, images, _ = world(seed)
    free = subspace_distances(probes, orthonormal_basis(images, 9))
    assert (free <= non_negative_distances(probes, images) + 1e-9).all()
    free = subspace_distances(probes, orthonormal_basis(images[:, :4], 4))
    assert (free <= non_negative_distances_4d(probes, images[:, :4]) + 1e-7).all()


@given(seed=SEEDS)
def test_the_more_harmonics_the_nearer_non_negative_light_comes(seed):
    probes, images, _ = world(seed)
    few = non_negative_distances_4d(probes, images[:, :4])
    ambient = non_negative_distances(probes, images[:, :1])
    assert (few <= ambient + 1e-7).all()


@given(seed=SEEDS)
def test_pixels_may_be_shuffled(seed):
    probes, images, rng = world(seed)
    order = rng.permutation(30)
    one = subspace_distances(probes, orthonormal_basis(images, 9))
    other = subspace_distances(probes[:, order], orthonormal_basis(images[..., order], 9))
    assert np.allclose(one, other)


@given(seed=SEEDS, independent=st.floats(0.1, 1e4))
def test_posteriors_are_probabilities_in_the_order_of_distances(seed, independent):
    distances = np.random.default_rng(seed).random((4, 6)) + 1e-3
    found = posteriors(distances, independent)
    assert np.allclose(found.sum(axis=1), 1)
    assert np.array_equal(found.argmax(axis=1), distances.argmin(axis=1))


@given(seed=SEEDS)
def test_cumulative_match_rises_to_one(seed):
    rng = np.random.default_rng(seed)
    curve = cumulative_match(rng.random((20, 7)), rng.integers(0, 7, 20))
    assert (np.diff(curve) >= 0).all()
    assert curve[-1] == 1


@given(seed=SEEDS)
def test_the_illumination_cone_is_the_same_under_every_linear_map_of_its_normals(seed):
    rng = np.random.default_rng(seed)
    normals, change = rng.standard_normal((3, 30)), rng.standard_normal((3, 3))
    one, other = (
        lamp_images(own, extreme_lights(own, 40, seed)) for own in (normals, change.T @ normals)
    )
    one, other = (rays / np.linalg.norm(rays, axis=1, keepdims=True) for rays in (one, other))
    if np.linalg.det(change) < 0:
        # A reflection makes of each lamp the opposite one, which stands beside it.
        other = other.reshape(-1, 2, 30)[:, ::-1].reshape(-1, 30)
    # Rounding grows with the condition of the map, and where a ray is faint.
    assert np.allclose(one, other, atol=1e-10 * np.linalg.cond(change) ** 2)
