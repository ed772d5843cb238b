from dataclasses import replace

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
from harmface.recognition import (
    Gallery,
    Photographs,
    SubjectClassifier,
    SubspaceDistance,
    best_method,
    distance_named,
    enroll,
)
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of, probe_images

SIZE = 32
MESHES = {f"subject {seed}": mesh_of(head(seed, n_vertices=5000)) for seed in range(5)}


@pytest.fixture(scope="module")
def gallery():
    return enroll(MESHES, SIZE, cast_shadows=False)


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
    black = "it makes an all-black image, which has no direction"
    position = "its classes differ in position, subspaces only in direction"
    flat = "it has images of one value everywhere, which show nothing"
    negative = "it makes negative light of scattered points"
    if estimator.method == "best":
        return {
            "check_estimators_dtypes": flat,
            "check_classifiers_train": position,
            "check_classifier_data_not_an_array": flat,
            "check_decision_proba_consistency": negative,
            "check_fit2d_1feature": flat,
            "check_positive_only_tag_during_fit": "it wants words of scikit-learn's own",
        }
    if estimator.method == "nearest":
        return {}
    whole = "of three pixels, every image is in every subspace: all tie"
    return {
        "check_classifiers_train": position,
        "check_estimators_dtypes": black,
        **({"check_methods_subset_invariance": whole} if estimator.method == "subspace" else {}),
    }


ESTIMATORS = [
    SubjectClassifier(),
    SubjectClassifier("subspace"),
    SubjectClassifier("nearest"),
    SubjectClassifier(SubspaceDistance(dimension=1)),
]


@parametrize_with_checks(ESTIMATORS, expected_failed_checks=inapplicable)
@pytest.mark.usefixtures("unchecked")
def test_scikit_learn_interface(estimator, check):
    """Each check asserts for itself."""
    check(estimator)


def rows(images):
    return images.reshape(len(images), -1)


def test_subjects_enrolled_as_meshes_are_recognised_in_complex_light(gallery, rng):
    classifier = SubjectClassifier.from_gallery(gallery, "9d")
    right = [
        classifier.predict(rows(probe_images(mesh, mixed(4, rng), SIZE, rng))) == name
        for name, mesh in MESHES.items()
    ]
    # At half the size of the claim, and with lights that may stand behind the head.
    assert np.mean(right) >= 0.9


def test_subjects_enrolled_as_photographs_are_recognised_in_other_light(photographs):
    images, names = photographs
    frontal = np.tile(yale64().subset <= 2, len(MESHES))
    distance = SubspaceDistance(dimension=5)
    classifier = SubjectClassifier(distance).fit(images[frontal], names[frontal])
    third = np.tile(yale64().subset == 3, len(MESHES))
    assert classifier.score(images[third], names[third]) >= 0.9


def test_works_in_a_pipeline_under_cross_validation(photographs):
    images, names = photographs
    lit = np.tile(yale64().subset <= 3, len(MESHES))
    scale = FunctionTransformer(lambda X: X / X.max(axis=1, keepdims=True))
    pipeline = make_pipeline(scale, SubjectClassifier(SubspaceDistance(dimension=4)))
    assert cross_val_score(pipeline, images[lit], names[lit], cv=4).min() > 0.9


def test_exposure_plays_no_part(gallery, rng):
    classifier = SubjectClassifier.from_gallery(gallery, "4d")
    probes = rng.random((3, SIZE * SIZE))
    assert np.allclose(classifier.distances(probes), classifier.distances(1e3 * probes))


def test_scores_and_probabilities_rank_as_distances_do(gallery, rng):
    classifier = SubjectClassifier.from_gallery(gallery, "9d")
    probes = rng.random((4, SIZE * SIZE))
    order = classifier.distances(probes).argsort(axis=1)
    assert np.array_equal((-classifier.decision_function(probes)).argsort(axis=1), order)
    chances = classifier.predict_proba(probes)
    assert np.array_equal((-chances).argsort(axis=1), order)
    assert np.allclose(chances.sum(axis=1), 1)
    assert np.array_equal(classifier.predict(probes), classifier.classes_[order[:, 0]])


def test_two_subjects_have_one_score(rng):
    images, names = rng.random((6, 12)), np.repeat([0, 1], 3)
    classifier = SubjectClassifier(SubspaceDistance(dimension=2)).fit(images, names)
    scores, distances = classifier.decision_function(images), classifier.distances(images)
    assert np.allclose(scores, np.log(distances[:, 0] / distances[:, 1]))
    assert np.array_equal(classifier.predict(images), scores > 0)


def test_the_best_method_is_what_the_gallery_allows(gallery, rng):
    cast = replace(gallery, shadowed=np.repeat(gallery.harmonic[:, :1], 25, axis=1))
    assert SubjectClassifier.from_gallery(cast).distance_ == distance_named("framed+25d")
    photographs = Photographs(np.repeat(["a", "b"], 2), rng.random((4, 6, 5)))
    plain = Gallery(photographs, photographs.everywhere)
    assert SubjectClassifier.from_gallery(plain).distance_ == distance_named("framed+local")
    fixed = replace(plain, aligned=True)
    assert SubjectClassifier.from_gallery(fixed).distance_ == distance_named("local")
    row = Gallery(
        Photographs(photographs.subjects, photographs.images[:, :1]), np.ones((1, 5), bool)
    )
    assert best_method(row) == "local"
    lit = replace(plain, lights=np.tile([0, 0, 1.0], (4, 1)), relit=photographs)
    assert SubjectClassifier.from_gallery(lit).distance_ == distance_named("framed+relit+local")


def test_held_out_photographs_do_not_know_themselves(rng):
    images, names = rng.random((12, 30)), np.tile(np.arange(3), 4)
    images[3] = images[0] + 0.01
    classifier = SubjectClassifier("nearest").fit(images, names)
    assert classifier.known_.distances.min() < 1e-12
    assert np.bincount(classifier.held_out_.truth).tolist() == [4, 4, 4]
    # Dealt out in turn, the first two images of a subject are compared with one another.
    assert classifier.held_out_.distances.min() == pytest.approx(0.01 * np.sqrt(30))


def test_too_few_photographs_leave_probabilities_unknown(rng):
    classifier = SubjectClassifier("subspace").fit(rng.random((5, 12)), [0, 0, 0, 1, 1])
    assert not classifier.calibrated
    with pytest.raises(ArgumentError, match="3 photographs of each"):
        classifier.predict_proba(rng.random((1, 12)))


@pytest.mark.parametrize(
    ("classifier", "message"),
    [
        (SubjectClassifier("subspace", (3, 3)), "8 pixels"),
        (SubjectClassifier("subspace", (2, 4), np.ones((2, 2), bool)), "mask must be of shape"),
        (SubjectClassifier("subspace", (2, 4), np.zeros((2, 4), bool)), "leave some pixels"),
        (SubjectClassifier("magic", (2, 4)), "method must be best"),
        (SubjectClassifier("9d", (2, 4)), "must hold harmonic images.*enroll meshes"),
        (SubjectClassifier("relit+local", (2, 4)), "must hold relit photographs"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(classifier, message):
    with pytest.raises(ArgumentError, match=message):
        classifier.fit(np.arange(32.0).reshape(4, 8), [0, 0, 1, 1])
