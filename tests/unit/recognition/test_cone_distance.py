import numpy as np
import pytest
from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer

from data_synth.lightings import yale64
from harmface.errors import ArgumentError
from harmface.recognition import (
    SubjectClassifier,
    SubspaceDistance,
    enroll,
    subject_photographs,
)
from harmface.recognition.illumination_cone import ConeDistance
from harmface.reproduce.synthetic import light_of

SIZE = 48
SUBSET = yale64().subset
NAMES = [f"subject {seed}" for seed in range(6)]


@pytest.fixture(scope="module")
def meshes(similar_heads):
    return {name: similar_heads[name] for name in NAMES}


@pytest.fixture(scope="module")
def photographs(meshes):
    lights = light_of(yale64())
    images = [subject_photographs(mesh, lights, SIZE) for mesh in meshes.values()]
    return np.stack(images).reshape(len(NAMES), 64, -1)


def test_photographs_from_the_front_predict_attached_shadows(photographs):
    """The cone of seven photographs against their linear subspace, on light from the side."""
    gallery, names = photographs[:, SUBSET == 1], np.repeat(NAMES, 7)
    probes, truth = photographs[:, SUBSET == 4].reshape(-1, SIZE * SIZE), np.repeat(NAMES, 14)
    flat = gallery.reshape(len(names), -1)
    plain = SubjectClassifier(SubspaceDistance(dimension=3)).fit(flat, names)
    cone = SubjectClassifier("cone").fit(flat, names)
    errors = (plain.predict(probes) != truth).sum()
    assert errors >= 10
    assert (cone.predict(probes) != truth).sum() <= errors / 2


def test_meshes_serve_as_a_gallery(meshes, photographs):
    gallery = enroll(meshes, SIZE, cast_shadows=False)
    classifier = SubjectClassifier.from_gallery(gallery, "harmonic+cone")
    probes = photographs[:, SUBSET == 2].reshape(-1, SIZE * SIZE)
    assert classifier.score(probes, np.repeat(NAMES, 12)) == 1
    assert np.allclose(classifier.distances(probes), classifier.distances(1e3 * probes), atol=1e-5)


def test_works_in_a_pipeline_and_as_a_clone(photographs):
    gallery, names = photographs[:2, SUBSET == 1].reshape(14, -1), np.repeat(NAMES[:2], 7)
    cone = clone(SubjectClassifier(ConeDistance(rays=40, dimension=10)))
    scaled = make_pipeline(FunctionTransformer(lambda X: 2 * X), cone).fit(gallery, names)
    assert scaled.score(gallery, names) == 1
    assert scaled[-1].model_["rays"].shape == (2, 40, 10)


def test_a_subject_of_two_photographs_is_named(rng):
    with pytest.raises(ArgumentError, match=r"'bob': images must number at least 3 .*, got 2"):
        SubjectClassifier("cone").fit(rng.random((6, 9)), ["ann"] * 4 + ["bob"] * 2)
