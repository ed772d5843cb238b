from dataclasses import replace

import numpy as np
import pytest

from data_synth.faces import head
from data_synth.shapes import sphere, torus
from harmface.errors import ArgumentError
from harmface.geometry import (
    Mesh,
    Texture,
    axis_rotations,
    face_rotation,
    frame_orthographic,
    gbuffer,
    outward_share,
    paints_a_face,
)
from harmface.geometry.texture import TextureImage
from harmface.reproduce.synthetic import mesh_of

HEAD = mesh_of(head(3))
BALL = mesh_of(sphere())


@pytest.mark.parametrize(
    ("text", "vector", "turned"),
    [
        ("y:90", [0, 0, 1], [1, 0, 0]),
        ("x:90", [0, 1, 0], [0, 0, 1]),
        ("z:90", [1, 0, 0], [0, 1, 0]),
        ("x:-90, y:180", [0, 1, 0], [0, 0, 1]),
        ("", [1, 2, 3], [1, 2, 3]),
    ],
)
def test_turns_are_made_one_after_the_other(text, vector, turned):
    assert np.allclose(axis_rotations(text) @ vector, turned)


@pytest.mark.parametrize("text", ["y", "y:", "w:90", "y:90;x:3", "y:nan", "90", "y:90,", "y:inf"])
def test_what_is_no_turn_is_refused(text):
    with pytest.raises(ArgumentError, match=r"AXIS:DEGREES"):
        axis_rotations(text)


def test_all_24_orientations_are_looked_at():
    from harmface.geometry.orientation import _orientations

    found = {np.round(matrix).astype(int).tobytes() for _, matrix in _orientations()}
    assert len(found) == len(list(_orientations())) == 24


@pytest.mark.parametrize(
    "text", ["", "y:180", "x:-90", "x:90,y:180", "z:180", "y:-90", "z:90,x:90"]
)
def test_a_face_is_turned_to_the_front(text):
    back = face_rotation(HEAD.rotated(axis_rotations(text)))
    assert back is not None
    assert np.allclose(axis_rotations(back) @ axis_rotations(text), np.eye(3))


def test_a_face_that_is_inside_out_is_found_as_well():
    assert face_rotation(HEAD.flipped()) == ""


def test_a_ring_has_no_face():
    assert face_rotation(mesh_of(torus())) is None


def test_a_plane_has_no_face_and_shows_nothing_edge_on():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    plane = Mesh(corners, np.array([[0, 1, 2]]), np.tile([0.0, 0, 1], (3, 1)), np.ones((3, 3)))
    assert face_rotation(plane) is None
    assert outward_share(plane) == 1
    with pytest.raises(ArgumentError, match="seen from the front"):
        outward_share(plane.rotated(axis_rotations("y:90")))


def test_what_points_to_the_viewer_is_counted():
    assert outward_share(BALL) > 0.99
    assert outward_share(BALL.flipped()) < 0.01
    # One half of a ball turned inside out, left and right of the middle.
    sides = np.where(BALL.vertices[:, :1] > 0, 1, -1)
    assert outward_share(replace(BALL, normals=sides * BALL.normals)) == pytest.approx(
        0.5, abs=0.02
    )


def painted(flip):
    """Return a head on which its own picture, shadows and all, lies as it is seen."""
    view = gbuffer(HEAD, frame_orthographic(HEAD, 128))
    low, high = HEAD.bounds[:, :2]
    uv = 0.5 + (HEAD.vertices[:, :2] - (low + high) / 2) / (1.05 * (high - low).max())
    uv = uv * [1, -1] + [0, 1] if flip else uv
    picture = view.albedo * np.maximum(view.normals[..., 2:], 0)
    texture = Texture(
        (TextureImage(picture),), np.zeros(len(HEAD.faces), int), uv, np.ones_like(HEAD.albedo)
    )
    return Mesh(HEAD.vertices, HEAD.faces, HEAD.normals, HEAD.albedo, texture)


def test_a_painted_face_is_told_from_one_upside_down():
    assert paints_a_face(painted(False))
    assert not paints_a_face(painted(True))


def test_black_albedo_paints_nothing():
    assert not paints_a_face(replace(HEAD, albedo=HEAD.albedo * 0))
