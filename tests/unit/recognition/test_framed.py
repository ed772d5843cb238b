from dataclasses import replace

import cv2
import numpy as np
import pytest

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.geometry import OrthographicCamera, gbuffer
from harmface.recognition import Gallery, Photographs, SubjectClassifier, framed
from harmface.recognition.framed import FramedDistance, misframed
from harmface.recognition.local_subspace import LocalDistance
from harmface.recognition.registration import Motion, undone
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of

SUBJECTS, SHAPE = 5, (48, 42)
GRID = yale64()
KNOWN = np.flatnonzero(GRID.subset == 1)
LIT = np.flatnonzero((GRID.subset == 2) | (GRID.subset == 3))[::4]


@pytest.fixture(scope="module")
def faces():
    """Faces cropped from a larger picture, so that what is moved in is face and not its rim."""
    lights = light_of(GRID)
    lights = type(lights)(lights.directions, lights.irradiances[np.concatenate([KNOWN, LIT])])
    stacks = []
    for seed in range(SUBJECTS):
        mesh = mesh_of(head(seed, n_vertices=5000, identity_scale=0.7))
        front = float(mesh.bounds[1, 2] + 50)
        view = gbuffer(mesh, OrthographicCamera((0, -26, front), 222.0, (72, 66)))
        images = render(view, lights, caster=mesh)
        stacks.append(images / images.max(axis=(1, 2), keepdims=True))
    return np.stack(stacks).astype(np.float32)


def cropped(images):
    return images[..., 12:60, 12:54]


@pytest.fixture(scope="module")
def gallery(faces):
    known = cropped(faces[:, : len(KNOWN)]).reshape(-1, *SHAPE)
    photographs = Photographs(np.repeat(np.arange(SUBJECTS), len(KNOWN)), known)
    return Gallery(photographs, photographs.everywhere)


def out_of_place(images, shift, turn, size, rng):
    """Move pictures by so much in random directions, by OpenCV's own rotation."""
    moved = []
    for image in images:
        angle = rng.uniform(0, 2 * np.pi)
        matrix = cv2.getRotationMatrix2D((32.5, 35.5), rng.choice([-turn, turn]), 1 + size)
        matrix[:, 2] += shift * np.cos(angle), shift * np.sin(angle)
        moved.append(cropped(cv2.warpAffine(image, matrix, (66, 72))))
    return np.stack(moved)


@pytest.mark.parametrize(
    ("shift", "turn", "size"),
    [(0.04 * 42, 4, 0.05), (0.08 * 42, 0, 0)],
    ids=["4 %, 4 degrees, 5 %", "8 %"],
)
def test_misframed_probes_lose_little(faces, gallery, shift, turn, size):
    probes = faces[:, len(KNOWN) :].reshape(-1, *faces.shape[2:])
    truth = np.repeat(np.arange(SUBJECTS), len(LIT))
    moved = out_of_place(probes, shift, turn, size, np.random.default_rng(1))
    rows = moved.reshape(len(moved), -1)
    plain = SubjectClassifier.from_gallery(gallery, "local")
    framed = SubjectClassifier.from_gallery(gallery, "framed+local")
    straight = framed.score(cropped(probes).reshape(len(probes), -1), truth)
    assert plain.score(rows, truth) < 0.9
    # One probe of thirty: 3.4 %.
    assert framed.score(rows, truth) >= straight - 0.034
    distances, motions = framed.placed(rows)
    assert np.array_equal(distances, framed.distances(rows))
    assert np.mean([misframed(motion, SHAPE[0]) for motion in motions]) > 0.9


def test_a_better_place_is_one_that_is_nearer(gallery, faces):
    distance, inner = FramedDistance(), LocalDistance()
    model, probes = distance.fit(gallery), cropped(faces[:, -1])
    found, motions = distance.search(model, probes, gallery.mask)
    assert (found.min(axis=1) <= inner.distances(model, probes, gallery.mask).min(axis=1)).all()
    assert len(motions) == SUBJECTS


def test_most_photographs_in_place_are_left_there(gallery):
    distance, images = FramedDistance(), gallery.photographs.images
    known = np.arange(len(images)) % 7 < 5
    model = distance.fit(gallery.chosen(known))
    motions = distance.search(model, images[~known], gallery.mask)[1]
    assert np.mean([motion == Motion() for motion in motions]) >= 0.7


def test_a_probe_is_moved_only_if_it_comes_much_nearer(gallery, faces):
    """Of noise and light from the side some places are nearer by chance."""
    distance = FramedDistance()
    model = distance.fit(gallery)
    probes = cropped(faces[:, len(KNOWN) :]).reshape(-1, *SHAPE)
    noise = np.random.default_rng(0).standard_normal(probes.shape)
    probes = np.maximum(probes + 0.15 * noise, 0).astype(np.float32)
    before = distance.inner.distances(model, probes, gallery.mask)
    nearest = distance._nearest(model, probes, gallery.mask, before)[0]
    ratios = nearest.min(axis=1) / before.min(axis=1)
    model = {**model, "ratio_in_place": np.median(ratios)}
    found, motions = distance.search(model, probes, gallery.mask)
    moved = np.array([motion != Motion() for motion in motions])
    assert np.array_equal(moved, ratios < np.median(ratios))
    assert np.array_equal(found[moved], nearest[moved])
    assert np.array_equal(found[~moved], before[~moved])
    nowhere = {**model, "ratio_in_place": np.array(0.0)}
    assert {*distance.search(nowhere, probes, gallery.mask)[1]} == {Motion()}


def test_the_search_goes_on_from_more_than_the_nearest_place(gallery, faces, monkeypatch):
    """Turned, enlarged and shifted at once, a probe is found from several places, not from one."""
    distance = FramedDistance(inner=LocalDistance())
    model = {**distance.fit(gallery), "ratio_in_place": np.array(1.0)}
    probes = cropped(faces[:, len(KNOWN) :]).reshape(-1, *SHAPE).astype(np.float32)
    probes = np.stack([undone(probe, Motion(2.2, -1.9, 4.0, 1.05)) for probe in probes])
    nearest = {}
    for beam in (1, 5):
        monkeypatch.setattr(framed, "BEAM", beam)
        nearest[beam] = distance.search(model, probes, gallery.mask)[0].min(axis=1)
    assert (nearest[5] <= nearest[1] + 1e-6).mean() > 0.9
    assert (nearest[5] < nearest[1] - 1e-4).mean() > 0.2


def test_without_photographs_to_try_any_nearer_place_will_do(gallery):
    model = FramedDistance().fit(gallery.chosen(np.arange(len(gallery.which)) % 7 < 2))
    assert model["ratio_in_place"] == 1


def test_the_gallery_itself_is_not_searched(gallery):
    framed = SubjectClassifier.from_gallery(gallery, "framed+local")
    plain = SubjectClassifier.from_gallery(gallery, "local")
    assert np.array_equal(framed.held_out_.distances, plain.held_out_.distances)
    assert np.array_equal(framed.known_.distances, plain.known_.distances)
    assert plain.placed(gallery.photographs.images[:1].reshape(1, -1))[1] is None


def test_strangers_are_told_where_probes_lie(gallery, faces):
    rows = cropped(np.roll(faces[:, -1], 3, axis=2)).reshape(SUBJECTS, -1)
    framed = SubjectClassifier.from_gallery(gallery, "framed+local")
    in_place = framed.distances_in_place(rows)
    plain = SubjectClassifier.from_gallery(gallery, "local")
    assert np.array_equal(in_place, plain.distances(rows))
    assert not np.array_equal(in_place, framed.distances(rows))


def test_what_counts_as_misframed():
    assert not misframed(Motion(), 48)
    assert not misframed(Motion(1.0, -1.0, 1.5, 1.02), 48)
    for motion in (Motion(2.0), Motion(down=-2.0), Motion(rotation=-3), Motion(scale=0.96)):
        assert misframed(motion, 48)


def test_harmonic_images_are_searched_too(gallery):
    images = np.random.default_rng(0).random((SUBJECTS, 9, *SHAPE))
    meshes = replace(gallery, harmonic=images)
    found = SubjectClassifier.from_gallery(meshes, "framed+9d")
    pictures, light = found.explained(gallery.photographs.images[:2], np.array([0, 1]))
    assert pictures.shape == (2, *SHAPE)
    assert light.shape == (2, 9)
