import cv2
import numpy as np
import pytest
from sklearn.base import clone

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.errors import ArgumentError
from harmface.recognition import (
    SubjectClassifier,
    enroll,
    orthonormal_basis,
    subject_photographs,
    subspace_distances,
)
from harmface.recognition.registration import (
    Motion,
    RegisteredDistance,
    register,
    registered_distances,
    undone,
)
from harmface.reproduce.synthetic import light_of, mesh_of

SIZE = 48
SUBJECTS = 6
LIT = np.flatnonzero(yale64().subset <= 3)[::3]


@pytest.fixture(scope="module")
def meshes():
    return {
        str(seed): mesh_of(head(seed, n_vertices=5000, identity_scale=0.7))
        for seed in range(SUBJECTS)
    }


@pytest.fixture(scope="module")
def gallery(meshes):
    return enroll(meshes, SIZE)


@pytest.fixture(scope="module")
def bases(gallery):
    return orthonormal_basis(gallery.shadowed[:, :9][..., gallery.mask], 9)


@pytest.fixture(scope="module")
def probes(meshes):
    lights = light_of(yale64())
    lights = type(lights)(lights.directions, lights.irradiances[LIT])
    images = [subject_photographs(mesh, lights, SIZE) for mesh in meshes.values()]
    return np.concatenate(images)


@pytest.fixture(scope="module")
def moved(probes):
    """Probes out of place by 1 to 2 pixels, 2 degrees and 2 per cent, and by what motion."""
    rng = np.random.default_rng(11)
    motions = [
        Motion(
            float(shift * np.cos(angle)),
            float(shift * np.sin(angle)),
            float(rng.choice([-2, 2])),
            float(rng.choice([0.98, 1.02])),
        )
        for shift, angle in rng.uniform([1, 0], [2, 2 * np.pi], (len(probes), 2))
    ]
    images = [out_of_place(*each) for each in zip(probes, motions, strict=True)]
    return np.stack(images), motions


def out_of_place(image, motion):
    """By OpenCV's own rotation, without the package's matrix."""
    middle = ((SIZE - 1) / 2, (SIZE - 1) / 2)
    matrix = cv2.getRotationMatrix2D(middle, motion.rotation, motion.scale)
    matrix[:, 2] += motion.right, motion.down
    return cv2.warpAffine(image, matrix, (SIZE, SIZE), borderMode=cv2.BORDER_REPLICATE)


def test_a_known_motion_is_undone(probes):
    motion = Motion(1.3, -0.7, 2.0, 1.02)
    image = cv2.GaussianBlur(probes[3], (0, 0), 2)
    back = undone(out_of_place(image, motion), motion)
    inner = (slice(5, -5), slice(5, -5))
    # Two bilinear interpolations of an image that varies over some pixels.
    assert np.abs(back - image)[inner].max() < 0.02 * image.max()
    assert np.abs(out_of_place(image, motion) - image)[inner].max() > 0.2 * image.max()
    assert np.array_equal(undone(image, Motion()), image)


def test_known_motions_are_recovered_and_the_names_with_them(moved, bases, gallery):
    images, motions = moved
    truth = np.repeat(range(SUBJECTS), len(LIT))
    plain = subspace_distances(images[:, gallery.mask], bases).argmin(axis=1)
    distances, found = registered_distances(images, bases, gallery.mask, SUBJECTS)
    right = distances.argmin(axis=1) == truth
    assert (plain == truth).mean() < 0.7
    assert right.mean() > 0.95
    errors = np.abs(
        [
            (
                own.right - put.right,
                own.down - put.down,
                own.rotation - put.rotation,
                100 * (own.scale - put.scale),
            )
            for own, put in zip(found, motions, strict=True)
        ]
    )[right]
    # Pixels, pixels, degrees, per cent: a tenth of a pixel in the middle, a third at the edge.
    assert (np.median(errors, axis=0) < [0.1, 0.1, 0.8, 1.4]).all()


def test_what_is_in_place_stays_there(probes, bases, gallery):
    distances, _ = registered_distances(probes, bases, gallery.mask)
    plain = subspace_distances(probes[:, gallery.mask], bases)
    assert (distances <= plain + 1e-6).all()
    truth = np.repeat(range(SUBJECTS), len(LIT))
    assert (distances.argmin(axis=1) == truth).mean() > 0.95


def test_no_motion_is_made_out_where_there_is_nothing_alike(bases, gallery):
    start = Motion(right=0.5)
    assert register(np.ones((SIZE, SIZE)), bases[0], gallery.mask, start) == start


def test_a_motion_beyond_what_is_credible_is_not_believed(moved, bases, gallery, monkeypatch):
    probe = moved[0][0]
    assert register(probe, bases[0], gallery.mask) != Motion()
    monkeypatch.setattr("harmface.recognition.registration.LARGEST_SHIFT", 0.01)
    assert register(probe, bases[0], gallery.mask) == Motion()
    monkeypatch.setattr("harmface.recognition.registration.LARGEST_SHIFT", 1.0)
    monkeypatch.setattr("harmface.recognition.registration.LARGEST_SCALE", 1.001)
    assert register(probe, bases[0], gallery.mask) == Motion()


def test_a_classifier_compares_registered_probes(moved, probes):
    images = probes.reshape(len(probes), -1)
    names = np.repeat(np.array(list("abcdef")), len(LIT))
    distance = RegisteredDistance(dimension=6, candidates=2)
    classifier = clone(SubjectClassifier(distance, (SIZE, SIZE)))
    classifier.fit(images[::4], names[::4])
    few = moved[0][::7]
    distances = classifier.distances(few.reshape(len(few), -1))
    bases, mask = classifier.model_["bases"], np.ones((SIZE, SIZE), bool)
    assert np.array_equal(distances, registered_distances(few, bases, mask, 2)[0])


ALL = np.ones((2, 3), bool)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: register(np.full((2, 3), np.nan), np.ones((1, 6)), ALL), "finite"),
        (
            lambda: registered_distances(np.ones((1, 3, 2)), np.ones((1, 1, 6)), ALL),
            "mask must be of the probes' size",
        ),
        (
            lambda: registered_distances(np.ones((1, 2, 3)), np.ones((1, 1, 5)), ALL),
            "leave the 5 pixels",
        ),
        (
            lambda: registered_distances(np.zeros((1, 2, 3)), np.ones((1, 1, 6)), ALL),
            "all black",
        ),
        (
            lambda: registered_distances(np.ones((1, 2, 3)), np.ones((1, 1, 6)), ALL, 0),
            "candidates must be 1 or more",
        ),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
