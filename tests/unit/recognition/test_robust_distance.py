import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer

from data_synth.lightings import yale64
from harmface.recognition import (
    RobustDistance,
    SubjectClassifier,
    enroll,
    subject_photographs,
)
from harmface.reproduce.synthetic import light_of

SIZE = 32
SUBJECTS = [f"subject {seed}" for seed in range(8)]
LIT = np.flatnonzero(yale64().subset >= 3)


@pytest.fixture(scope="module")
def gallery(similar_heads):
    return enroll(similar_heads, SIZE, cast_shadows=False)


@pytest.fixture(scope="module")
def probes(similar_heads):
    """Each under lights from the side, with cast shadows and a per cent of noise."""
    rng = np.random.default_rng(3)
    lights = light_of(yale64())
    lights = type(lights)(lights.directions, lights.irradiances[LIT])
    images = [subject_photographs(mesh, lights, SIZE) for mesh in similar_heads.values()]
    images = np.concatenate(images).reshape(-1, SIZE * SIZE)
    images /= images.max(axis=1, keepdims=True)
    return np.clip(images + 0.01 * rng.standard_normal(images.shape), 0, 1)


def test_halves_the_errors_of_the_plain_distance_where_shadows_fall(gallery, probes):
    truth = np.repeat(SUBJECTS, len(LIT))
    plain = SubjectClassifier.from_gallery(gallery, "9d")
    robust = SubjectClassifier.from_gallery(gallery, "harmonic+robust")
    errors = (plain.predict(probes) != truth).sum()
    assert errors >= 10
    assert (robust.predict(probes) != truth).sum() <= errors / 2


def test_photographs_serve_as_a_gallery(probes):
    names = np.repeat(SUBJECTS, len(LIT))
    classifier = SubjectClassifier("robust", (SIZE, SIZE)).fit(probes[::4], names[::4])
    assert classifier.score(probes[1::8], names[1::8]) > 0.9


def test_exposure_and_what_lies_outside_the_mask_play_no_part(gallery, probes, rng):
    classifier = SubjectClassifier.from_gallery(gallery, RobustDistance("harmonic", dimension=4))
    other = 1e3 * np.where(gallery.mask.ravel(), probes[:3], rng.random((3, SIZE * SIZE)))
    # Single precision, through a root.
    assert np.allclose(classifier.distances(probes[:3]), classifier.distances(other), atol=1e-5)


def test_works_in_a_pipeline_and_as_a_clone(probes):
    few, names = probes[::9], np.repeat(SUBJECTS, len(LIT))[::9]
    robust = SubjectClassifier(RobustDistance(dimension=3), image_shape=(SIZE, SIZE))
    scaled = make_pipeline(FunctionTransformer(np.sqrt), clone(robust)).fit(few, names)
    assert scaled.predict(few[:2]).tolist() == [SUBJECTS[0]] * 2


def test_an_unfitted_classifier_says_so():
    with pytest.raises(NotFittedError):
        SubjectClassifier("robust", (3, 4)).predict(np.ones((1, 12)))
