import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer

from data_synth.camera_noise import photograph
from data_synth.faces import head
from data_synth.lightings import nine_points, yale64
from harmface.errors import ArgumentError
from harmface.geometry import OrthographicCamera, gbuffer
from harmface.recognition import (
    SubjectClassifier,
    Windows,
    local_distances,
    log_intensity,
    orthonormal_basis,
    subspace_distances,
)
from harmface.reflectance import Phong
from harmface.rendering import box_average, render
from harmface.reproduce.synthetic import light_of, mesh_of

SHAPE = (48, 42)
SUBJECTS = 6
GRID = yale64()
GALLERY = (GRID.directions @ nine_points().directions.T).argmax(axis=0)
EXTREME = np.setdiff1d(np.flatnonzero(GRID.subset == 5), GALLERY)


@pytest.fixture(scope="module")
def faces():
    """People alike in face, cropped, shiny, photographed in 8 bits half a pixel off the mark."""
    rng = np.random.default_rng(5)
    used = np.concatenate([GALLERY, EXTREME])
    lights = light_of(GRID)
    stacks = []
    for seed in range(SUBJECTS):
        mesh = mesh_of(head(seed, n_vertices=5000))
        front = float(mesh.bounds[1, 2] + 50)
        images = []
        for light in used:
            x, y = rng.normal(0, 1.5, 2)
            view = gbuffer(mesh, OrthographicCamera((x, y - 26, front), 148.0, (96, 84)))
            lamp = type(lights)(lights.directions[[light]], np.ones((1, 1)))
            seen = render(view, lamp, caster=mesh)[0]
            white = np.ones(view.mask.shape)
            coat = Phong(10, 0.04)
            seen += render(view, lamp, albedo=white, caster=mesh, material=coat)[0]
            images.append(box_average(seen, 2) + 0.005 * view.mask.any())
        stack = np.stack(images)
        full = np.percentile(stack[0], 95)
        stacks.append(photograph(stack / full, rng=rng, exposure=0.9, bits=8))
    return np.stack(stacks).reshape(SUBJECTS, len(used), -1)


def enrolled(classifier, faces):
    count = len(GALLERY)
    gallery = faces[:, :count].reshape(-1, faces.shape[-1])
    return classifier.fit(gallery, np.repeat(np.arange(SUBJECTS), count))


def errors(classifier, faces):
    probes = faces[:, len(GALLERY) :].reshape(-1, faces.shape[-1])
    return (
        enrolled(classifier, faces).predict(probes) != np.repeat(np.arange(SUBJECTS), len(EXTREME))
    ).sum()


def test_works_in_a_pipeline_and_as_a_clone(faces):
    local = SubjectClassifier("local", SHAPE)
    scaled = make_pipeline(FunctionTransformer(np.sqrt), clone(local))
    assert enrolled(scaled, faces).predict(faces[:, 0]).tolist() == list(range(SUBJECTS))


def test_an_unfitted_classifier_says_so():
    with pytest.raises(NotFittedError):
        SubjectClassifier("local", SHAPE).predict(np.ones((1, 2016)))


def test_halves_the_errors_of_the_plain_distance_in_extreme_light(faces):
    plain = errors(SubjectClassifier("subspace"), faces)
    assert plain >= 20
    assert errors(SubjectClassifier("local", SHAPE), faces) <= plain / 2


def test_exact_framing_tells_apart_what_movement_would_explain(faces):
    exact = enrolled(SubjectClassifier("local", SHAPE, aligned=True), faces)
    loose = enrolled(SubjectClassifier("local", SHAPE), faces)
    probe = faces[:1, 0]
    assert (exact.distances(probe) > loose.distances(probe))[0, 1:].all()


def test_distance_is_that_of_the_windows_and_a_little_of_the_whole(faces):
    classifier = enrolled(SubjectClassifier("local", SHAPE), faces)
    probes, gallery = faces[0, -3:], faces[:, : len(GALLERY)]
    logs = log_intensity(probes.reshape(-1, *SHAPE) / gallery.max(), 0.005)
    windows = local_distances(logs, classifier.model_["bases"], Windows(np.ones(SHAPE, bool)))
    whole = subspace_distances(probes, orthonormal_basis(gallery, 9))
    # Single precision, through a logarithm of values down to 0.015.
    assert np.allclose(classifier.distances(probes), windows * whole**0.06, atol=1e-4)


def test_one_photograph_of_a_subject_is_enough(faces):
    frontal = SubjectClassifier("local", SHAPE).fit(faces[:, 0], range(SUBJECTS))
    assert frontal.predict(faces[:, 0]).tolist() == list(range(SUBJECTS))


def test_the_unit_of_the_images_plays_no_part(faces):
    probes = faces[0, -3:]
    one = enrolled(SubjectClassifier("local", SHAPE), faces).distances(probes)
    codes = enrolled(SubjectClassifier("local", SHAPE), 255 * faces).distances(255 * probes)
    # Single precision, through a logarithm of values down to 0.016.
    assert np.allclose(one, codes, atol=1e-4)


def test_pixels_outside_the_mask_play_no_part(faces, rng):
    mask = np.zeros(SHAPE, bool)
    mask[8:, 6:36] = True
    classifier = enrolled(SubjectClassifier("local", SHAPE, mask=mask), faces)
    probes = faces[0, -3:]
    other = np.where(mask.ravel(), probes, rng.random(probes.shape))
    assert np.allclose(classifier.distances(probes), classifier.distances(other), atol=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: SubjectClassifier("local", (2, 4)).fit(np.zeros((4, 8)), [0, 0, 1, 1]),
            "all be black",
        ),
        (
            lambda: SubjectClassifier("local", (2, 4)).fit(-np.ones((4, 8)), [0, 0, 1, 1]),
            "images must not be negative",
        ),
        (
            lambda: (
                SubjectClassifier("local", (2, 4))
                .fit(np.arange(32.0).reshape(4, 8), [0, 0, 1, 1])
                .distances(np.zeros((1, 8)))
            ),
            "same value",
        ),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
