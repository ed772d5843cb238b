"""Surfaces from films."""

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

from harmface.errors import ArgumentError
from harmface.moving import silhouettes, surface_from_film, views_from_poses
from harmface.moving.hull import VisualHull
from harmface.reproduce.moving import head_errors


@pytest.fixture(scope="module")
def found(film):
    return surface_from_film(film.frames, film.masks, film.views)


def test_depth_is_nearer_than_by_brightness_alone(film, found):
    angles, depth = head_errors(film, found)
    plain = surface_from_film(film.frames, film.masks, film.views, shading=False)
    plain_angles, plain_depth = head_errors(film, plain)
    assert depth.mean() < plain_depth.mean()
    assert angles.mean() < plain_angles.mean()


def test_the_mesh_lies_in_the_visual_hull(film, found):
    hull = VisualHull(film.masks, film.views, 48)
    # A pixel is what marching cubes and bilinear silhouettes may be off by.
    assert hull.distances(found.mesh.vertices).min() > -1.5


def test_maps_are_of_the_frame(film, found):
    assert (found.mask == film.masks[found.frame]).all()
    assert np.allclose(np.linalg.norm(found.normals[found.mask], axis=1), 1)
    assert not found.normals[~found.mask].any()
    assert found.albedo.max() <= 1
    assert 0 < found.residual <= found.shading_error < 1
    assert found.axes >= 2


def test_an_object_that_only_moves_is_refused(film):
    count = len(film.frames)
    moved = views_from_poses(
        np.tile(np.eye(3), (count, 1, 1)),
        film.views.matrices[:, :2, 3] + np.arange(count)[:, None],
        np.ones(count),
    )
    with pytest.raises(ArgumentError, match="must turn between the frames"):
        surface_from_film(film.frames, film.masks, moved)


def test_nonsense_is_refused(film):
    with pytest.raises(ArgumentError, match="of one film"):
        surface_from_film(film.frames, film.masks[1:], film.views)
    few = np.arange(len(film.frames)) < 5
    with pytest.raises(ArgumentError, match="at least 8"):
        surface_from_film(film.frames[few], film.masks[few], film.views[few])
    with pytest.raises(ArgumentError, match="in every frame"):
        surface_from_film(film.frames, np.zeros_like(film.masks), film.views)


def test_silhouettes_that_do_not_meet_are_refused(film):
    torn = film.masks.copy()
    torn[0] = np.roll(film.masks[0], 16, axis=1) & ~film.masks[0]
    with pytest.raises(ArgumentError, match="in common"):
        surface_from_film(film.frames, torn, film.views)


def test_an_object_is_found_before_a_background_of_another_hue():
    rng = np.random.default_rng(0)
    frames = np.empty((3, 40, 50, 3))
    frames[:] = [0.1, 0.1, 0.4]
    truth = np.zeros((3, 40, 50), bool)
    for number in range(3):
        truth[number, 10:30, 12 + 5 * number : 30 + 5 * number] = True
    frames[truth] = [0.5, 0.25, 0.1]
    frames += 0.005 * rng.random(frames.shape)
    found = silhouettes(frames)
    assert found[truth].all()
    # Colours at the edge are smoothed by less than a pixel.
    assert not found[~binary_dilation(truth, np.ones((1, 3, 3)))].any()
    with pytest.raises(ArgumentError, match="--mask"):
        silhouettes(np.full((3, 40, 50), 0.5))
