import numpy as np
import pytest
from scipy.spatial.distance import cdist
from sklearn.base import clone
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.pipeline import make_pipeline

from harmface.errors import ArgumentError
from harmface.recognition import METHODS, SubjectClassifier, distance_named
from harmface.recognition.baselines import EigenfacesDistance, gradient_direction, standardized
from harmface.recognition.normalizers import NORMALIZERS

SHAPE = (24, 20)
NAMES = ["ann", "bob", "cyd", "dan"]


@pytest.fixture
def faces(rng):
    """Four textures, five images each under gains that change across the image."""
    albedo = 0.2 + rng.random((4, 1, *SHAPE))
    slope = np.exp(rng.normal(0, 0.2, (4, 5, 1, 1)) * np.linspace(-1, 1, SHAPE[1]))
    return (albedo * slope).reshape(20, -1), np.repeat(NAMES, 5)


# dlib's network is not installed everywhere: test_peers is for it.
DISTANCES = {name: distance_named(name) for name in METHODS if name != "dlib"}
OF_PHOTOGRAPHS = [n for n, each in DISTANCES.items() if not (each.of_surfaces or each.learns)]
# Normalised photographs are negative; what takes light for light cannot do with them.
NAMES_OF_ALL = [
    f"{before}+{method}"
    for before in NORMALIZERS
    for method in OF_PHOTOGRAPHS
    if method not in ("local", "cone", "likelihood")
]


@pytest.mark.parametrize("name", [*OF_PHOTOGRAPHS, *NAMES_OF_ALL])
def test_every_method_knows_its_gallery_under_other_light(name, faces, rng):
    images, names = faces
    probes = images * (1 + 0.01 * rng.random(images.shape))
    fitted = clone(SubjectClassifier(name, SHAPE)).fit(images, names)
    assert (fitted.predict(probes) == names).mean() >= 0.95
    distances = fitted.distances(probes)
    assert distances.shape == (20, 4)
    assert np.array_equal(fitted.classes_[distances.argmin(axis=1)], fitted.predict(probes))


def test_distance_to_a_subject_is_that_to_its_nearest_image():
    gallery = np.array([[4.0, 0], [0, 0], [0, 3]])
    classifier = SubjectClassifier("nearest").fit(gallery, ["b", "b", "a"])
    assert np.allclose(classifier.distances([[4.0, 3.0]]), [[4, 3]])


def test_what_stands_before_a_method_is_done_to_probes(rng):
    images = rng.random((6, 30))
    found = SubjectClassifier("self-quotient+nearest", (5, 6)).fit(images, np.arange(6))
    assert found.distances(2 * images) == pytest.approx(found.distances(images))


def test_fisherfaces_are_those_of_scikit_learn(faces):
    images, names = faces
    found = SubjectClassifier("fisherfaces", SHAPE).fit(images, names)
    theirs = make_pipeline(PCA(16, random_state=0), LinearDiscriminantAnalysis(solver="svd"))
    features = theirs.fit(images, names).transform(images)
    expected = cdist(features, features).reshape(20, 4, 5).min(axis=2)
    assert np.allclose(found.distances(images), expected, atol=1e-6 * expected.max())


def test_distances_of_standardised_images_are_those_of_correlation(rng):
    a, b = standardized(rng.random((2, 50)))
    correlation = np.corrcoef(a, b)[0, 1]
    assert np.sum((a - b) ** 2) == pytest.approx(2 - 2 * correlation)
    assert not standardized(np.ones((1, 5))).any()


def test_eigenfaces_leave_out_the_strongest_components(rng):
    images = rng.standard_normal((30, 8)) * np.array([50, 20, 10, 1, 1, 1, 1, 1])
    distance, stack = EigenfacesDistance(left_out=3), images[:, None]
    coordinates = distance.features(distance.learn(stack, np.arange(30)), stack)
    assert coordinates.shape == (30, 5)
    assert coordinates.std(axis=0).max() < 3


def test_gradient_direction_is_a_unit_vector_along_the_slope():
    ramp = np.add.outer(3 * np.arange(5.0), 4 * np.arange(6.0))[None]
    direction = gradient_direction(ramp)
    assert np.allclose(direction[0, 0], 0.6)
    assert np.allclose(direction[0, 1], 0.8)
    assert not gradient_direction(np.ones((1, 4, 4))).any()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("eigen", "method must be best, or one of local, whitened"),
        ("sharp+nearest", "method must be best"),
        ("equalized+equalized+nearest", "method must be best"),
        ("relit+shadowed+subspace", "method must be best"),
        ("framed+framed+local", "method must be best"),
        ("", "method must be best"),
        ("equalized+9d", "9d must have photographs"),
        ("shadowed+lbph", "lbph must have one of photographs, relit"),
    ],
)
def test_an_unknown_name_is_refused(name, message):
    with pytest.raises(ArgumentError, match=message):
        distance_named(name)


def test_fisherfaces_need_several_images_of_a_subject(faces):
    images, names = faces
    with pytest.raises(ArgumentError, match="several of a subject"):
        SubjectClassifier("fisherfaces", SHAPE).fit(images[::5], names[::5])
