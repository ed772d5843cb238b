import numpy as np
import pytest
from scipy.optimize import nnls

from harmface.errors import ArgumentError
from harmface.recognition import orthonormal_basis, subspace_distances
from harmface.recognition.non_negative_4d import nearest_in_round_cone, non_negative_distances_4d
from harmface.rendering import harmonic_images
from harmface.sphere import fibonacci_directions, random_directions, real_harmonics

SUBJECTS, PIXELS = 3, 100


@pytest.fixture
def images(rng):
    normals = random_directions(SUBJECTS * PIXELS, rng).reshape(SUBJECTS, PIXELS, 3)
    normals[..., 2] = np.abs(normals[..., 2])
    return np.stack([harmonic_images(own, 0.2 + rng.random(PIXELS), 1) for own in normals])


@pytest.fixture
def probes(images, rng):
    return rng.standard_normal((60, 4)) @ images[0] + 0.1 * rng.standard_normal((60, PIXELS))


def test_distances_are_those_under_many_lamps(images, probes):
    rays = real_harmonics(fibonacci_directions(3000), 1).T
    found = non_negative_distances_4d(probes, images)
    for row, probe in zip(found[:12], probes, strict=False):
        for distance, own in zip(row, images, strict=True):
            sampled = nnls((rays @ own).T, probe)[1] / np.linalg.norm(probe)
            # The cone of 3,000 lamps, 4 degrees apart, is inside the round one by 2 degrees
            # squared over two, 6e-4.
            assert -6e-4 <= distance - sampled <= 1e-9


def test_light_is_within_the_cone_and_optimal(images, probes):
    grams = images @ images.swapaxes(1, 2)
    projections = np.einsum("np,skp->nsk", probes, images)
    light = nearest_in_round_cone(projections, grams)
    ascent = projections - np.einsum("skl,nsl->nsk", grams, light)
    scale = np.linalg.norm(projections, axis=-1)
    # The gradient may lead out of the cone only (its polar cone), and is normal to the light.
    assert (
        np.linalg.norm(light[..., 1:], axis=-1) <= np.sqrt(3) * light[..., 0] * (1 + 1e-5)
    ).all()
    leaving = ascent[..., 0] + np.sqrt(3) * np.linalg.norm(ascent[..., 1:], axis=-1)
    assert (leaving <= 1e-5 * scale).all()
    norm = np.linalg.norm(light, axis=-1)
    assert (np.abs((ascent * light).sum(axis=-1)) <= 1e-5 * scale * norm).all()


def test_the_three_kinds_of_minimum_all_occur(images, probes):
    grams = images @ images.swapaxes(1, 2)
    light = nearest_in_round_cone(np.einsum("np,skp->nsk", probes, images), grams)
    ratio = np.linalg.norm(light[..., 1:], axis=-1) / np.maximum(light[..., 0], 1e-300)
    dark = light[..., 0] == 0
    assert dark.any()
    assert (~dark & (np.abs(ratio - np.sqrt(3)) < 1e-4)).any()
    assert (~dark & (ratio < 1.7)).any()


def test_light_that_is_allowed_costs_nothing(images):
    probe = np.array([[1.0, 0.3, -0.4, 0.5]]) @ images[1]
    assert non_negative_distances_4d(probe, images)[0, 1] < 1e-6
    free = subspace_distances(probe, orthonormal_basis(images, 4))
    assert (non_negative_distances_4d(probe, images) >= free - 1e-9).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: non_negative_distances_4d(np.ones((1, 9)), np.ones((1, 9, 9))), "4 of each"),
        (lambda: non_negative_distances_4d(np.ones((1, 9)), np.ones((1, 4, 9))), "independent"),
        (lambda: non_negative_distances_4d(np.zeros((1, 9)), np.ones((1, 4, 9))), "all black"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
