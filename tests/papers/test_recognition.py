"""LHK05 table 2: which subspace errs how much on the grid of 64 lights.

Lee, Ho and Kriegman (PAMI 2005) on subset 4 of ten people of Yale B: eigenfaces 75.7 %, 3-D linear
subspace 15.0 %, 9-D harmonic 3.57 %, with cast shadows 2.7 %, nine points of light 0.
"""

import numpy as np
import pytest

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.light import DistantLight
from harmface.recognition import (
    SubjectClassifier,
    nearest_lights,
    nine_points,
    orthonormal_basis,
    subject_images,
    subject_photographs,
    subspace_distances,
)
from harmface.reproduce.synthetic import mesh_of

SUBJECTS, SIZE = 10, 32
GRID = yale64()
TRUTH = np.repeat(np.arange(SUBJECTS), 64)
FOURTH = np.tile(GRID.subset == 4, SUBJECTS)


@pytest.fixture(scope="module")
def errors():
    """Return the error of each method on subset 4, people alike and 1 % noise."""
    rng = np.random.default_rng(2005)
    light = DistantLight(GRID.directions, np.eye(64))
    plain, shadowed, photographs = [], [], []
    for seed in range(SUBJECTS):
        mesh = mesh_of(head(seed, identity_scale=0.5, n_vertices=5000))
        plain.append(subject_images(mesh, SIZE, 2))
        shadowed.append(subject_images(mesh, SIZE, 2, cast_shadows=True))
        photographs.append(subject_photographs(mesh, light, SIZE))
    mask = (np.stack(plain)[:, 0] > 0).all(axis=0)
    plain, shadowed, photographs = (
        np.stack(images)[..., mask] for images in (plain, shadowed, photographs)
    )
    noisy = photographs / photographs.max(axis=2, keepdims=True)
    noisy = np.maximum(noisy + 0.01 * rng.standard_normal(noisy.shape), 0).astype(np.float32)
    probes = noisy.reshape(len(TRUTH), -1)
    nine = photographs[:, nearest_lights(GRID.directions, nine_points())]
    frontal = noisy[:, GRID.subset == 1]
    pixels = probes.shape[1]
    eigenfaces = SubjectClassifier("eigenfaces")
    eigenfaces.fit(frontal.reshape(-1, pixels), np.repeat(np.arange(SUBJECTS), 7))
    bases = {"3-D": plain[:, 1:4], "9-D": plain, "shadows": shadowed, "nine points": nine}
    named = {
        name: subspace_distances(probes, orthonormal_basis(images, images.shape[1])).argmin(axis=1)
        for name, images in bases.items()
    } | {"eigenfaces": eigenfaces.predict(probes)}
    return {name: (given != TRUTH)[FOURTH].mean() for name, given in named.items()}


def test_the_order_of_the_methods_is_the_published_one(errors):
    assert errors["eigenfaces"] > errors["3-D"] > errors["9-D"] > errors["shadows"]
    assert errors["shadows"] >= errors["nine points"]


def test_nine_points_and_cast_shadows_err_as_little_as_published(errors):
    assert errors["nine points"] == 0
    assert errors["shadows"] <= 0.027
