import numpy as np
import pytest
from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import parametrize_with_checks

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.errors import ArgumentError
from harmface.recognition import (
    HarmonicSubspaceClassifier,
    IlluminationConeClassifier,
    enroll,
    subject_photographs,
)
from harmface.reproduce.synthetic import light_of, mesh_of

SIZE = 48
SUBSET = yale64().subset
NAMES = [f"subject {seed}" for seed in range(6)]


@pytest.fixture(scope="module")
def meshes():
    return {
        name: mesh_of(head(seed, n_vertices=5000, identity_scale=0.5))
        for seed, name in enumerate(NAMES)
    }


@pytest.fixture(scope="module")
def photographs(meshes):
    lights = light_of(yale64())
    images = [subject_photographs(mesh, lights, SIZE) for mesh in meshes.values()]
    return np.stack(images).reshape(len(NAMES), 64, -1)


def inapplicable(estimator):
    """Checks whose data are no photographs, with the reason."""
    flat = "its images of a subject lie in a plane"
    few = "it wants words of scikit-learn's own for what is refused"
    return {
        "check_estimators_overwrite_params": flat,
        "check_estimators_fit_returns_self": flat,
        "check_readonly_memmap_input": flat,
        "check_classifier_data_not_an_array": flat,
        "check_classifiers_classes": flat,
        "check_classifiers_train": flat,
        "check_fit_idempotent": flat,
        "check_fit_check_is_fitted": flat,
        "check_n_features_in": flat,
        "check_fit2d_1sample": few,
        "check_fit2d_1feature": few,
        "check_positive_only_tag_during_fit": few,
        "check_methods_subset_invariance": "of three pixels, every image is in every cone: all tie",
        "check_estimators_dtypes": "it makes an all-black image, which has no direction",
    }


@parametrize_with_checks([IlluminationConeClassifier()], expected_failed_checks=inapplicable)
@pytest.mark.usefixtures("unchecked")
def test_scikit_learn_interface(estimator, check):
    """Each check asserts for itself."""
    check(estimator)


def test_photographs_from_the_front_predict_attached_shadows(photographs):
    """The cone of seven photographs against their linear subspace, on light from the side."""
    gallery, names = photographs[:, SUBSET == 1], np.repeat(NAMES, 7)
    probes, truth = photographs[:, SUBSET == 4].reshape(-1, SIZE * SIZE), np.repeat(NAMES, 14)
    flat = gallery.reshape(len(names), -1)
    plain = HarmonicSubspaceClassifier(3).fit(flat, names)
    cone = IlluminationConeClassifier().fit(flat, names)
    errors = (plain.predict(probes) != truth).sum()
    assert errors >= 10
    assert (cone.predict(probes) != truth).sum() <= errors / 2


def test_meshes_serve_as_a_gallery(meshes, photographs):
    gallery = enroll(meshes, SIZE)
    classifier = IlluminationConeClassifier.from_gallery(gallery)
    probes = photographs[:, SUBSET == 2].reshape(-1, SIZE * SIZE)[:, gallery.mask.ravel()]
    assert classifier.score(probes, np.repeat(NAMES, 12)) == 1
    assert np.allclose(classifier.distances(probes), classifier.distances(1e3 * probes), atol=1e-5)


def test_works_in_a_pipeline_and_as_a_clone(photographs):
    gallery, names = photographs[:2, SUBSET == 1].reshape(14, -1), np.repeat(NAMES[:2], 7)
    cone = clone(IlluminationConeClassifier(rays=40, dimension=10))
    scaled = make_pipeline(FunctionTransformer(lambda X: 2 * X), cone).fit(gallery, names)
    assert scaled.score(gallery, names) == 1
    assert scaled[-1].cones_[0][1].shape == (40, 10)


def test_a_subject_of_two_photographs_is_named(rng):
    with pytest.raises(ArgumentError, match=r"'bob': images must number at least 3 .*, got 2"):
        IlluminationConeClassifier().fit(rng.random((6, 9)), ["ann"] * 4 + ["bob"] * 2)
