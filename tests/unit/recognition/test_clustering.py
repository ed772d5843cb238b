import numpy as np
import pytest
from scipy.optimize import lsq_linear

from data_synth.faces import head
from data_synth.lightings import uniform_directional
from harmface.errors import ArgumentError
from harmface.recognition import Gallery, Photographs, distance_named, subject_photographs
from harmface.recognition.clustering import (
    cluster_subjects,
    conic_affinity,
    kmeans_subjects,
    likely_subjects,
    mutual_distances,
    neighbour_affinity,
    neighbours_of,
    purity,
)
from harmface.reproduce.synthetic import light_of, mesh_of


@pytest.fixture
def photographs(rng):
    """Three people, each under 20 lights of its own within 45 degrees of the view."""
    stacks = []
    for seed in range(3):
        lights = light_of(uniform_directional(20, rng, max_polar=45.0))
        mesh = mesh_of(head(seed, n_vertices=5000))
        stacks.append(subject_photographs(mesh, lights, 48))
    return np.concatenate(stacks).reshape(60, -1).astype(np.float64)


def test_affinities_are_strengths_of_the_nearest_non_negative_mixture(rng):
    images = rng.random((5, 30))
    unit = images / np.linalg.norm(images, axis=1, keepdims=True)
    strengths = np.zeros((5, 5))
    for i in range(5):
        others = [j for j in range(5) if j != i]
        fit = lsq_linear(unit[others].T, unit[i], bounds=(0, np.inf), tol=1e-12)
        strengths[i, others] = fit.x
    assert np.allclose(conic_affinity(images), (strengths + strengths.T) / 2, atol=1e-5)


def test_a_mixture_of_two_images_takes_of_them_alone(rng):
    images = rng.random((4, 30))
    mixed = np.concatenate([images, [images[0] + 2 * images[1]]])
    affinity = conic_affinity(mixed)
    assert (affinity[4, [0, 1]] > 0.1).all()
    assert affinity[4, [0, 1]].min() > affinity[4, [2, 3]].max()


def test_photographs_are_sorted_by_what_they_show(photographs):
    found = cluster_subjects(conic_affinity(photographs), 3).reshape(3, 20)
    assert all(len(set(row)) == 1 for row in found)
    assert len(set(found[:, 0])) == 3


def test_whom_photographs_show_plays_no_part_in_their_distances(rng):
    images = rng.random((4, 5, 6))
    gallery = Gallery(Photographs(np.array(list("aabb")), images), np.ones((5, 6), bool))
    found = mutual_distances(gallery, distance_named("nearest"))
    expected = np.linalg.norm((images[:, None] - images).reshape(4, 4, -1), axis=-1)
    assert np.allclose(found, expected, atol=1e-6)


def test_neighbours_are_linked():
    places = np.array([0.0, 1.0, 3.0, 10.0])
    affinity = neighbour_affinity(np.abs(places[:, None] - places), 1)
    expected = np.zeros((4, 4))
    expected[0, 1] = expected[1, 0] = 1  # neighbours of each other
    expected[1, 2] = expected[2, 1] = expected[2, 3] = expected[3, 2] = 0.5
    assert np.array_equal(affinity, expected)


def test_neighbours_are_no_more_than_a_subject_has_other_images():
    assert neighbours_of(635) == 13  # 2 log 635 = 12.9
    assert neighbours_of(60, 10) == 5
    assert neighbours_of(10, 9) == 1


@pytest.mark.parametrize("parts", [2, 3, 5])
def test_parts_of_a_graph_are_counted(rng, parts):
    which = np.repeat(np.arange(parts), 8)
    affinity = np.where(which[:, None] == which, 1.0, 0.02 * rng.random((8 * parts, 8 * parts)))
    assert likely_subjects((affinity + affinity.T) / 2) == parts


def test_k_means_takes_no_notice_of_brightness():
    images = np.repeat([[1.0, 0, 0], [0, 1.0, 0.2]], 4, axis=0)
    found = kmeans_subjects(images * np.tile([[0.01], [1.0]], (4, 1)), 2)
    assert purity(found, np.repeat(["a", "b"], 4)) == 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: conic_affinity(np.ones((1, 4))), "at least 2"),
        (lambda: conic_affinity(np.zeros((3, 4))), "all black"),
        (lambda: conic_affinity(-np.ones((3, 4))), "negative"),
        (lambda: cluster_subjects(np.ones((3, 3)), 1), "at least 2 and fewer than the 3"),
        (lambda: cluster_subjects(np.ones((3, 3)), 3), "at least 2 and fewer than the 3"),
        (lambda: kmeans_subjects(np.ones((3, 4)), 3), "at least 2 and fewer than the 3"),
        (lambda: neighbour_affinity(np.ones((3, 3)), 3), "fewer than the 3 images"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
