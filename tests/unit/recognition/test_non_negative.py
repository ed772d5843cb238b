import numpy as np
import pytest
from scipy.optimize import nnls

from harmface.errors import ArgumentError
from harmface.light.non_negative import nearest_in_cone, sampled_light
from harmface.recognition import (
    non_negative_distances,
    non_negative_light,
    orthonormal_basis,
    subspace_distances,
)
from harmface.rendering import clamped_cosines, harmonic_images
from harmface.sphere import random_directions

SUBJECTS, PIXELS = 4, 200


@pytest.fixture
def images(rng):
    normals = random_directions((SUBJECTS * PIXELS), rng).reshape(SUBJECTS, PIXELS, 3)
    normals[..., 2] = np.abs(normals[..., 2])
    return np.stack([harmonic_images(own, 0.2 + rng.random(PIXELS)) for own in normals])


@pytest.fixture
def probes(images, rng):
    """Images in reach of a few lights, some of them negative, and noise."""
    light = rng.standard_normal((12, 9))
    return light @ images[0] + 0.1 * rng.standard_normal((12, PIXELS))


def test_distances_are_those_of_non_negative_least_squares(images, probes):
    rays = sampled_light(2)
    expected = [
        [nnls((rays @ own).T, probe)[1] / np.linalg.norm(probe) for own in images]
        for probe in probes
    ]
    # A distance loses half the digits of the squares that it is the root of a difference of.
    assert np.allclose(non_negative_distances(probes, images), expected, atol=1e-6)


def test_never_nearer_than_with_free_light(images, probes):
    free = subspace_distances(probes, orthonormal_basis(images, 9))
    bound = non_negative_distances(probes, images)
    assert (bound >= free - 1e-9).all()
    assert (bound > free + 0.01).any()


def test_lamps_at_sampled_directions_are_found(images):
    strengths = np.zeros(150)
    strengths[[3, 77]] = [0.5, 2.0]
    light = strengths @ sampled_light(2)
    found = non_negative_light((light @ images[1])[None], images[1:2])[0, 0]
    assert np.allclose(found, light, atol=1e-5)


def test_light_is_a_sum_of_sampled_lamps(images, probes):
    rays = sampled_light(2)
    for light in non_negative_light(probes, images).reshape(-1, 9):
        assert nnls(rays.T, light)[1] <= 1e-6 * np.linalg.norm(light)


def test_a_photograph_under_a_lamp_lies_as_near_as_the_free_fit_almost(rng):
    normals = random_directions(PIXELS, rng)
    albedo = 0.2 + rng.random(PIXELS)
    photograph = albedo * clamped_cosines(normals, np.array([[0.6, 0, 0.8]]))
    images = harmonic_images(normals, albedo)[None]
    free = subspace_distances(photograph, orthonormal_basis(images, 9))
    assert 0 <= non_negative_distances(photograph, images) - free < 0.02


def test_problems_are_solved_a_few_at_a_time_without_effect(images, probes, monkeypatch):
    together = non_negative_light(probes, images)
    monkeypatch.setattr("harmface.recognition.non_negative.CHUNK", 5)
    assert np.allclose(together, non_negative_light(probes, images))


def test_a_search_cut_short_is_still_within_the_cone(images, probes, monkeypatch):
    monkeypatch.setattr("harmface.light.non_negative.MAX_STEPS", 2)
    short = non_negative_light(probes[:1], images[:1])[0, 0]
    assert nnls(sampled_light(2).T, short)[1] < 1e-9


def test_what_no_ray_reaches_gets_no_light():
    nothing = nearest_in_cone(np.array([[-1.0, -1.0]]), np.eye(2)[None], np.eye(2))
    assert np.array_equal(nothing, [[0.0, 0.0]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: non_negative_distances(np.ones((1, 4)), np.ones((2, 8, 4))), "square"),
        (lambda: non_negative_distances(np.ones((1, 3)), np.ones((2, 9, 4))), "4 pixels"),
        (lambda: non_negative_distances(np.zeros((1, 4)), np.ones((2, 9, 4))), "all black"),
        (lambda: non_negative_distances(np.ones((1, 4)), np.full((2, 9, 4), np.nan)), "finite"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
