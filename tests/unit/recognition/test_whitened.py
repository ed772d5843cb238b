from dataclasses import replace

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition import (
    Gallery,
    Photographs,
    SubjectClassifier,
    best_method,
    log_intensity,
)
from harmface.recognition.local_subspace import FLOOR_PER_NOISE, RIDGE
from harmface.recognition.whitened import (
    FLOOR,
    RIDGES,
    WhitenedDistance,
    likeliest_ridge,
    windows_of,
)

SHAPE = (24, 20)
PEOPLE, LIGHTS = 12, 14


@pytest.fixture(scope="module")
def world():
    """Textures of many people, all changed alike by light that falls as bands over the picture."""
    rng = np.random.default_rng(8)
    rows, columns = np.mgrid[-1:1:24j, -1:1:20j]
    waves = [np.cos(k * rows + m * columns) for k in (0, 2, 5) for m in (0, 3, 6)]
    light = np.exp(0.7 * rng.standard_normal((LIGHTS, 9)) @ np.stack(waves).reshape(9, -1))
    texture = 0.3 + 0.05 * rng.random((2 * PEOPLE, 1, 24 * 20))
    images = texture * light
    images *= 1 + 0.002 * rng.standard_normal(images.shape)
    images /= images.max(axis=2, keepdims=True)
    return images.reshape(2 * PEOPLE, LIGHTS, *SHAPE)


def photographs(stack, first=0):
    names = np.repeat(np.arange(first, first + len(stack)), stack.shape[1])
    return Photographs(names, stack.reshape(-1, *SHAPE))


@pytest.fixture(scope="module")
def gallery(world):
    known = photographs(world[:PEOPLE, :1])
    return Gallery(known, known.everywhere, others=photographs(world[PEOPLE:], PEOPLE))


def errors(classifier, world):
    probes = world[:PEOPLE, 1:].reshape(-1, SHAPE[0] * SHAPE[1])
    return (classifier.predict(probes) != np.repeat(np.arange(PEOPLE), LIGHTS - 1)).mean()


def test_other_people_tell_what_one_photograph_does_not(gallery, world):
    assert errors(SubjectClassifier.from_gallery(gallery, "local"), world) > 0.3
    assert best_method(gallery) == "framed+whitened"
    # Light multiplies there however dark it is, so that no floor is needed.
    best = SubjectClassifier.from_gallery(gallery, WhitenedDistance(floor=0.015))
    assert errors(best, world) < 0.05
    # Other people stand in for photographs that a gallery of one a person cannot leave out.
    chances = best.predict_proba(world[:PEOPLE, 1].reshape(PEOPLE, -1))
    assert np.diag(chances).min() > 0.5
    assert best.rejection(0.01).strangers == PEOPLE


def test_windows_of_the_learned_are_white_up_to_the_ridge(gallery):
    """Within people the mean covariance of whitened windows is 1 but for the ridge."""
    model = WhitenedDistance().fit(gallery)
    others = gallery.others
    both = np.concatenate([others.images, others.images[..., ::-1]]) / others.images.max()
    cut = (
        windows_of(gallery.mask)
        .cut(log_intensity(both, FLOOR / FLOOR_PER_NOISE))
        .astype(np.float64)
    )
    white = (cut - model["mean"]) @ model["whitening"]
    subjects = np.tile(others.subjects, 2)
    own = [np.cov(white[0, subjects == s], rowvar=False, bias=True) for s in np.unique(subjects)]
    values = np.linalg.eigvalsh(np.mean(own, axis=0))
    assert values.max() < 1
    assert values.max() > 0.9
    assert np.allclose(np.mean(own, axis=0), np.diag(np.diag(np.mean(own, axis=0))), atol=1e-3)


def test_distance_is_that_of_the_nearest_mixture_of_all_photographs(gallery, world):
    """Against ridge regression by its normal equations, a window at a time."""
    two = photographs(world[:PEOPLE, :2])
    gallery = replace(gallery, photographs=two, aligned=True)
    distance = WhitenedDistance()
    model = distance.fit(gallery)
    probe = world[3:4, 5]
    found = distance.distances(model, probe, gallery.mask)[0]
    windows = windows_of(gallery.mask)
    noise = FLOOR / FLOOR_PER_NOISE
    cut = [windows.cut(log_intensity(x / two.images.max(), noise)) for x in (probe, two.images)]
    white = [(each - model["mean"]) @ model["whitening"] for each in cut]
    unit = [each / np.linalg.norm(each, axis=2, keepdims=True) for each in white]
    expected = np.zeros(PEOPLE)
    for x, own in zip(unit[0][:, 0], unit[1].reshape(-1, PEOPLE, 2, unit[1].shape[2]), strict=True):
        for person, A in enumerate(own):
            gram = A @ A.T
            ridge = RIDGE * max(1, np.linalg.eigvalsh(gram).max())
            explained = x @ A.T @ np.linalg.solve(gram + ridge * np.eye(2), A @ x)
            expected[person] += np.sqrt(1 - np.sqrt(explained))
    assert np.allclose(found, expected / len(windows.corners), atol=1e-4)


def test_windows_that_are_black_in_all_others_say_nothing(gallery):
    """As the corners of pictures of heads before a black wall."""
    corner = gallery.others.images.copy()
    # Mirrored images are learned from as well.
    corner[:, :8, :8] = corner[:, :8, -8:] = 0
    gallery = replace(gallery, others=Photographs(gallery.others.subjects, corner))
    model = WhitenedDistance().fit(gallery)
    assert all(np.isfinite(own).all() for own in model.values())


def test_a_step_aside_is_absorbed(gallery, world):
    probe = np.roll(world[:PEOPLE, 0], 1, axis=2).reshape(PEOPLE, -1)
    moved = SubjectClassifier.from_gallery(gallery, "whitened").distances(probe)
    framed = replace(gallery, aligned=True)
    fixed = SubjectClassifier.from_gallery(framed, "whitened").distances(probe)
    assert np.diag(moved).max() < 0.5 * np.diag(fixed).min()


def test_the_ridge_follows_from_the_number_of_people():
    """Of few people the covariance is poorly known, of many well."""
    rng = np.random.default_rng(0)
    scales = np.geomspace(1, 0.01, 30)
    few, many = (
        np.stack([np.cov(scales[:, None] * rng.standard_normal((30, 12)))[None] for _ in range(n)])
        for n in (4, 200)
    )
    assert likeliest_ridge(few) > likeliest_ridge(many)
    assert likeliest_ridge(many) in RIDGES


def test_what_cannot_be_learned_from_is_refused(gallery):
    lonely = replace(gallery, others=None)
    with pytest.raises(ArgumentError, match="--learn-from"):
        SubjectClassifier.from_gallery(lonely, "whitened")
    three = gallery.others.chosen(gallery.others.subjects < PEOPLE + 3)
    with pytest.raises(ArgumentError, match=r"at least 4 people.*got 3"):
        SubjectClassifier.from_gallery(replace(gallery, others=three), "whitened")
    once = gallery.others.chosen(np.arange(PEOPLE) * LIGHTS)
    with pytest.raises(ArgumentError, match=r"two photographs each.*with 1"):
        SubjectClassifier.from_gallery(replace(gallery, others=once), "whitened")
    black = replace(gallery.photographs, images=0 * gallery.photographs.images)
    with pytest.raises(ArgumentError, match="not all be black"):
        WhitenedDistance().fit(replace(gallery, photographs=black))
