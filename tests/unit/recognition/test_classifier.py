import numpy as np
import pytest
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import parametrize_with_checks

from data_synth.faces import head
from data_synth.lightings import mixed, yale64
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.recognition import HarmonicSubspaceClassifier, enroll
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of, probe_images

SIZE = 32
MESHES = {f"subject {seed}": mesh_of(head(seed, n_vertices=5000)) for seed in range(5)}


@pytest.fixture(scope="module")
def gallery():
    return enroll(MESHES, SIZE)


@pytest.fixture(scope="module")
def photographs():
    """Each subject under the 64 lights of the Yale grid, attached and cast shadows."""
    lights = light_of(yale64())
    stacks = []
    for mesh in MESHES.values():
        view = gbuffer(mesh, frame_orthographic(mesh, SIZE))
        stacks.append(render(view, lights, caster=mesh).reshape(64, -1))
    return np.concatenate(stacks), np.repeat(list(MESHES), 64)


def inapplicable(estimator):
    """Checks whose data are no images, with the reason."""
    position = "its classes differ in position, subspaces only in direction"
    return {
        "check_classifiers_train": position,
        "check_estimators_dtypes": "it makes an all-black image, which has no direction",
    }


@parametrize_with_checks(
    [HarmonicSubspaceClassifier(dimension=1)], expected_failed_checks=inapplicable
)
@pytest.mark.usefixtures("unchecked")
def test_scikit_learn_interface(estimator, check):
    """Each check asserts for itself."""
    check(estimator)


def test_subjects_enrolled_as_meshes_are_recognised_in_complex_light(gallery, rng):
    classifier = HarmonicSubspaceClassifier.from_gallery(gallery)
    right = [
        classifier.predict(probe_images(mesh, mixed(4, rng), SIZE, rng)[:, gallery.mask]) == name
        for name, mesh in MESHES.items()
    ]
    # At half the size of the claim, and with lights that may stand behind the head.
    assert np.mean(right) >= 0.9


def test_subjects_enrolled_as_photographs_are_recognised_in_other_light(photographs):
    images, names = photographs
    frontal = np.tile(yale64().subset <= 2, len(MESHES))
    classifier = HarmonicSubspaceClassifier(dimension=5).fit(images[frontal], names[frontal])
    third = np.tile(yale64().subset == 3, len(MESHES))
    assert classifier.score(images[third], names[third]) >= 0.9


def test_works_in_a_pipeline_under_cross_validation(photographs):
    images, names = photographs
    lit = np.tile(yale64().subset <= 3, len(MESHES))
    scale = FunctionTransformer(lambda X: X / X.max(axis=1, keepdims=True))
    pipeline = make_pipeline(scale, HarmonicSubspaceClassifier(dimension=4))
    assert cross_val_score(pipeline, images[lit], names[lit], cv=4).min() > 0.9


def test_exposure_plays_no_part(gallery, rng):
    classifier = HarmonicSubspaceClassifier.from_gallery(gallery, "4d")
    probes = rng.random((3, gallery.mask.sum()))
    assert np.allclose(classifier.distances(probes), classifier.distances(1e3 * probes))


def test_decision_scores_rank_as_distances_do(gallery, rng):
    classifier = HarmonicSubspaceClassifier.from_gallery(gallery)
    probes = rng.random((4, gallery.mask.sum()))
    scores, distances = classifier.decision_function(probes), classifier.distances(probes)
    assert np.array_equal(scores.argsort(axis=1), (-distances).argsort(axis=1))
    assert np.array_equal(classifier.predict(probes), classifier.classes_[scores.argmax(axis=1)])


def test_a_subject_with_too_few_photographs_is_named(rng):
    images, names = rng.random((12, 30)), ["ann"] * 9 + ["bob"] * 3
    with pytest.raises(ArgumentError, match="'bob' has 3 images, fewer than the 9"):
        HarmonicSubspaceClassifier().fit(images, names)
