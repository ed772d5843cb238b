import numpy as np
import pytest

from harmface import checks
from harmface.conventions import linear_to_srgb, luminance, srgb_to_linear
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, vertex_normals


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int64, bool])
@pytest.mark.parametrize("function", [luminance, srgb_to_linear, linear_to_srgb])
def test_codes_are_no_light(unchecked, function, dtype):
    with pytest.raises(ArgumentError, match=r"must be floating point, got dtype .*divide"):
        function(np.full((2, 3), 1, dtype))


def test_light_of_half_precision_is_kept_in_single(unchecked):
    assert luminance(np.ones((2, 3), np.float16)).dtype == np.float32
    assert srgb_to_linear(np.ones(3, np.float32)).dtype == np.float32


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        ([[0.0, 1.0, 2.0]], "faces must hold whole numbers, got dtype float64"),
        ([[0, 1, 3]], "faces must index 3 vertices, got indices from 0 to 3"),
        ([[-1, 1, 2]], "faces must index 3 vertices, got indices from -1"),
        (np.zeros((0, 3), int), "faces must hold at least one triangle"),
    ],
)
def test_faces_are_indices(unchecked, faces, message):
    vertices, up = np.eye(3), np.tile([0.0, 0.0, 1.0], (3, 1))
    with pytest.raises(ArgumentError, match=message):
        Mesh(vertices, faces, up, up)
    with pytest.raises(ArgumentError, match=message):
        vertex_normals(vertices, faces)


def test_a_mesh_is_made_of_lists(unchecked):
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 3 * [[0, 0, 1]], 3 * [[1, 1, 1]])
    assert mesh.vertices.dtype == np.float64
    assert mesh.bounds.tolist() == [[0, 0, 0], [1, 1, 0]]


def test_a_mask_is_true_or_false():
    assert checks.mask("mask", [[True, False]], (1, 2)).dtype == bool
    with pytest.raises(ArgumentError, match=r"mask must be true or false, .*image > 0"):
        checks.mask("mask", np.array([[0, 255]], np.uint8), (1, 2))
    with pytest.raises(ArgumentError, match=r"mask must have the size \(1, 2\)"):
        checks.mask("mask", np.ones((2, 1), bool), (1, 2))


def test_no_indices_are_no_error():
    assert checks.indices("faces", np.zeros((0, 3), int), 0).shape == (0, 3)


@pytest.mark.parametrize("shape", [(), (2,), (2, 2, 2), (2, 2, 3, 3), (0, 2), (2, 0, 3)])
def test_a_picture_has_pixels_and_one_or_three_channels(shape):
    with pytest.raises(ArgumentError, match=r"image must have shape \(H, W\) or \(H, W, 3\)"):
        checks.picture("image", np.ones(shape))
