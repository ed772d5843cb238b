"""Cameras and poses of a moving object."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.moving import views_from_cameras, views_from_poses
from harmface.reproduce.films import turns

ROTATIONS = turns("yaw:-30:30,pitch:-10:10", 8)


def perspective(rotations):
    """Cameras 5 units before the object: x right, y down, z away."""
    intrinsic = np.array([[200.0, 0, 60], [0, 210, 50], [0, 0, 1]])
    down = np.diag([1.0, -1, -1])
    return np.stack([intrinsic @ np.c_[down @ each, [0, 0, 5]] for each in rotations])


def test_a_pose_shows_the_right_at_the_right_and_the_top_at_the_top():
    views = views_from_poses(np.eye(3)[None], np.array([[50.0, 40.0]]), np.array([10.0]))
    seen = views.pixels(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))[0]
    assert np.allclose(seen, [[50, 40], [60, 40], [50, 30], [50, 40]])


@pytest.mark.parametrize("factor", [1, -3.0])
def test_cameras_give_back_the_rotations(factor):
    views, mirrored = views_from_cameras(factor * perspective(ROTATIONS))
    assert not mirrored
    assert np.allclose(views.rotations, ROTATIONS)


def test_left_handed_cameras_are_told_and_turned_over():
    views, mirrored = views_from_cameras(perspective(ROTATIONS) * [1, 1, -1, 1])
    assert mirrored
    assert np.allclose(views.rotations, ROTATIONS)


@pytest.mark.parametrize("kind", ["poses", "cameras"])
def test_rays_pass_through_the_points_of_their_pixels(kind):
    if kind == "poses":
        views = views_from_poses(ROTATIONS, np.full((8, 2), 50.0), np.full(8, 10.0))
    else:
        views, _ = views_from_cameras(perspective(ROTATIONS))
    points = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    for frame in range(8):
        origins, directions = views.rays(frame, views.pixels(points)[frame])
        assert np.allclose(np.cross(points - origins, directions), 0, atol=1e-9)
        towards = views.towards_camera(points)[frame]
        assert np.allclose(towards, -directions)


def test_cameras_of_parallel_rays_are_poses():
    views = views_from_poses(ROTATIONS, np.full((8, 2), 50.0), np.full(8, 10.0))
    again, mirrored = views_from_cameras(3.0 * views.matrices)
    assert not mirrored
    assert np.allclose(again.matrices, views.matrices)
    assert np.allclose(again.rotations, ROTATIONS)


def test_axes_are_counted():
    def axes(turn):
        rotations = turns(turn, 24)
        return views_from_poses(rotations, np.zeros((24, 2)), np.ones(24)).axes()

    assert axes("yaw:-30:30") == 1
    assert axes("yaw:-30:30,pitch:-10:10") >= 2


def test_nonsense_is_refused():
    with pytest.raises(ArgumentError, match="as many frames"):
        views_from_poses(ROTATIONS, np.zeros((7, 2)), np.ones(8))
    with pytest.raises(ArgumentError, match="scales must be positive"):
        views_from_poses(ROTATIONS, np.zeros((8, 2)), np.zeros(8))
    with pytest.raises(ArgumentError, match=r"shape \(frames, 3, 4\)"):
        views_from_cameras(np.ones((8, 3, 3)))
    with pytest.raises(ArgumentError, match="rank 3"):
        views_from_cameras(np.ones((8, 3, 4)))
    with pytest.raises(ArgumentError, match="origin before them"):
        views_from_cameras(np.zeros((8, 3, 4)))
    with pytest.raises(ArgumentError, match="rank 2"):
        views_from_cameras(np.tile(np.eye(4)[[0, 0, 3]], (8, 1, 1)))
    mixed = perspective(ROTATIONS)
    mixed[0] *= [1, 1, -1, 1]
    with pytest.raises(ArgumentError, match="handedness"):
        views_from_cameras(mixed)
