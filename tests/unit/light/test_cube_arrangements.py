import numpy as np
import pytest

from harmface.conventions import map_frame
from harmface.errors import ArgumentError
from harmface.light import (
    ARRANGEMENTS,
    LAYOUTS,
    faces_from_image,
    faces_from_opengl,
    image_from_faces,
)
from harmface.light.cube_arrangements import arrangement_of, opengl_order_of_cross

CUBE = LAYOUTS["cube"]
SHAPES = {
    "vertical-strip": (24, 4),
    "horizontal-strip": (4, 24),
    "horizontal-cross": (12, 16),
    "vertical-cross": (16, 12),
}


@pytest.mark.parametrize("channels", [(), (3,)])
@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_faces_come_back_from_every_arrangement(arrangement, channels):
    faces = np.random.default_rng(0).random((6, 4, 4, *channels))
    image = image_from_faces(faces, arrangement)
    assert image.shape == (*SHAPES[arrangement], *channels)
    assert arrangement_of(image.shape) == arrangement
    np.testing.assert_array_equal(faces_from_image(image), faces)


@pytest.mark.parametrize("arrangement", ["horizontal-cross", "vertical-cross"])
def test_crosses_fold_up_without_a_break(arrangement):
    """Directions are continuous from face to face inside a cross, the middle looking to -z."""
    side = 16
    image = image_from_faces(CUBE.directions(side), arrangement)
    middle = image[side + side // 2, side + side // 2]
    np.testing.assert_allclose(middle, [0, 0, -1], atol=0.1)
    shown = np.linalg.norm(image, axis=-1) > 0
    for axis in (0, 1):
        step = np.linalg.norm(np.diff(image, axis=axis), axis=-1)
        both = shown[1:] & shown[:-1] if axis == 0 else shown[:, 1:] & shown[:, :-1]
        assert step[both].max() < 2.5 / side


# Table 8.19 of the OpenGL 4.6 core specification: for each face the direction (rx, ry, rz) that
# has texture coordinates (s, t), both from -1 to 1, t growing towards the image's last row.
OPENGL = {
    0: lambda s, t: (1, -t, -s),
    1: lambda s, t: (-1, -t, s),
    2: lambda s, t: (s, 1, t),
    3: lambda s, t: (s, -1, -t),
    4: lambda s, t: (s, -t, 1),
    5: lambda s, t: (-s, -t, -1),
}


def opengl_directions(side):
    t, s = np.meshgrid(*[(2 * np.arange(side) + 1) / side - 1] * 2, indexing="ij")
    faces = [np.stack(np.broadcast_arrays(*OPENGL[face](s, t)), axis=-1) for face in range(6)]
    return np.stack([face / np.linalg.norm(face, axis=-1, keepdims=True) for face in faces])


def test_opengl_faces_are_turned_into_ours():
    turned = faces_from_opengl(opengl_directions(5))
    ours = CUBE.directions(5) @ map_frame("cube", "opengl").T
    np.testing.assert_allclose(turned, ours, atol=1e-15)
    np.testing.assert_array_equal(faces_from_opengl(turned), opengl_directions(5))


def test_three_js_samples_opengl_faces_with_x_flipped():
    turned = faces_from_opengl(opengl_directions(5) * [-1, 1, 1])
    ours = CUBE.directions(5) @ map_frame("cube", "three.js").T
    np.testing.assert_allclose(turned, ours, atol=1e-15)


def test_crosses_of_opengl_have_its_forward_face_in_the_middle():
    """OpenGL's +z has +x at its right and -x at its left, as our -z has."""
    directions = opengl_directions(4)
    cross = np.zeros((12, 16, 3))
    for face, (row, column) in enumerate([(1, 2), (1, 0), (0, 1), (2, 1), (1, 1), (1, 3)]):
        cross[4 * row : 4 * row + 4, 4 * column : 4 * column + 4] = directions[face]
    step = np.linalg.norm(np.diff(cross[4:8], axis=1), axis=-1)
    assert step.max() < 0.7
    np.testing.assert_array_equal(opengl_order_of_cross(faces_from_image(cross)), directions)


@pytest.mark.parametrize("shape", [(16, 16), (24, 5), (0, 0), (13, 16), (12, 17)])
def test_other_shapes_are_refused(shape):
    with pytest.raises(ArgumentError, match="neither a cross"):
        arrangement_of(shape)


def test_unknown_arrangement_is_refused():
    with pytest.raises(ArgumentError, match="vertical-strip"):
        image_from_faces(np.ones((6, 2, 2)), "spiral")
