import numpy as np
import pytest
from scipy.optimize import lsq_linear

from data_synth.faces import head
from data_synth.lightings import uniform_directional
from harmface.errors import ArgumentError
from harmface.recognition import subject_photographs
from harmface.recognition.clustering import cluster_subjects, conic_affinity
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
    found = cluster_subjects(photographs, 3).reshape(3, 20)
    assert all(len(set(row)) == 1 for row in found)
    assert len(set(found[:, 0])) == 3


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: conic_affinity(np.ones((1, 4))), "at least 2"),
        (lambda: conic_affinity(np.zeros((3, 4))), "all black"),
        (lambda: conic_affinity(-np.ones((3, 4))), "negative"),
        (lambda: cluster_subjects(np.ones((3, 4)), 1), "at least 2 and fewer than the 3"),
        (lambda: cluster_subjects(np.ones((3, 4)), 3), "at least 2 and fewer than the 3"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
