import numpy as np
import pytest
from sklearn.base import clone

from harmface.errors import ArgumentError
from harmface.recognition.baselines import (
    METHODS,
    NORMALIZERS,
    Eigenfaces,
    gradient_direction,
    recognizer,
    standardized,
)
from harmface.recognition.nearest import NearestImageClassifier

SHAPE = (24, 20)
NAMES = ["ann", "bob", "cyd", "dan"]


@pytest.fixture
def faces(rng):
    """Four textures, five images each under gains that change across the image."""
    albedo = 0.2 + rng.random((4, 1, *SHAPE))
    slope = np.exp(rng.normal(0, 0.2, (4, 5, 1, 1)) * np.linspace(-1, 1, SHAPE[1]))
    return (albedo * slope).reshape(20, -1), np.repeat(NAMES, 5)


# The local method takes off slow light itself; it and the cone take photographs, nowhere negative.
NAMES_OF_ALL = [
    f"{before}+{method}"
    for before in NORMALIZERS
    for method in METHODS
    if method not in ("local", "cone")
]


@pytest.mark.parametrize("name", [*METHODS, *NAMES_OF_ALL])
def test_every_method_knows_its_gallery_under_other_light(name, faces, rng):
    images, names = faces
    probes = images * (1 + 0.01 * rng.random(images.shape))
    fitted = clone(recognizer(name, SHAPE, 5)).fit(images, names)
    assert (fitted.predict(probes) == names).mean() >= 0.95
    scores = fitted[-1].distances(fitted[:-1].transform(probes) if len(fitted) > 1 else probes)
    assert scores.shape == (20, 4)
    assert np.array_equal(fitted.classes_[scores.argmin(axis=1)], fitted.predict(probes))


def test_distance_to_a_subject_is_that_to_its_nearest_image():
    gallery = np.array([[4.0, 0], [0, 0], [0, 3]])
    classifier = NearestImageClassifier().fit(gallery, ["b", "b", "a"])
    assert np.allclose(classifier.distances([[4.0, 3.0]]), [[4, 3]])


def test_distances_of_standardised_images_are_those_of_correlation(rng):
    a, b = standardized(rng.random((2, 50)))
    correlation = np.corrcoef(a, b)[0, 1]
    assert np.sum((a - b) ** 2) == pytest.approx(2 - 2 * correlation)
    assert not standardized(np.ones((1, 5))).any()


def test_eigenfaces_leave_out_the_strongest_components(rng):
    images = rng.standard_normal((30, 8)) * np.array([50, 20, 10, 1, 1, 1, 1, 1])
    coordinates = Eigenfaces(left_out=3).fit(images).transform(images)
    assert coordinates.shape == (30, 5)
    assert coordinates.std(axis=0).max() < 3


def test_gradient_direction_is_a_unit_vector_along_the_slope():
    ramp = np.add.outer(3 * np.arange(5.0), 4 * np.arange(6.0))[None]
    direction = gradient_direction(ramp)
    assert np.allclose(direction[0, 0], 0.6)
    assert np.allclose(direction[0, 1], 0.8)
    assert not gradient_direction(np.ones((1, 4, 4))).any()


@pytest.mark.parametrize("name", ["eigen", "sharp+nearest", "equalized+equalized+nearest", ""])
def test_an_unknown_name_is_refused(name):
    with pytest.raises(ArgumentError, match="method must be one of local, robust"):
        recognizer(name, SHAPE, 5)


def test_fisherfaces_need_several_images_of_a_subject(faces):
    images, names = faces
    with pytest.raises(ArgumentError, match="several of a subject"):
        recognizer("fisherfaces", SHAPE, 1).fit(images[::5], names[::5])
