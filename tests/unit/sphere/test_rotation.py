import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.sphere import (
    random_directions,
    real_harmonics,
    rotate,
    rotate_zonal,
    rotation_matrices,
    synthesize,
)

EPS = np.finfo(float).eps
HARD = {
    "identity": Rotation.identity(),
    "half turn about x": Rotation.from_matrix(np.diag([1.0, -1.0, -1.0])),
    "half turn about y": Rotation.from_matrix(np.diag([-1.0, 1.0, -1.0])),
    "half turn about z": Rotation.from_matrix(np.diag([-1.0, -1.0, 1.0])),
    "axes exchanged": Rotation.from_matrix(np.eye(3)[[1, 2, 0]]),
    "almost no turn": Rotation.from_rotvec([1e-9, -1e-12, 1e-7]),
    "almost gimbal lock": Rotation.from_euler("ZYZ", [0.3, 1e-10, 0.4]),
    "almost upside down": Rotation.from_euler("ZYZ", [0.3, np.pi - 1e-9, 0.4]),
    "any": Rotation.from_euler("ZYZ", [0.3, 1.1, -2.0]),
}


@pytest.mark.parametrize("name", HARD)
@pytest.mark.parametrize("max_degree", [0, 2, 32])
def test_harmonics_of_turned_directions_mix_within_their_degree(name, max_degree):
    rotation = HARD[name].as_matrix()
    directions = np.concatenate([random_directions(50, 1), np.eye(3), -np.eye(3)])
    still = real_harmonics(directions, max_degree)
    turned = real_harmonics(directions @ rotation.T, max_degree)
    for degree, matrix in enumerate(rotation_matrices(rotation, max_degree)):
        rows = slice(degree**2, (degree + 1) ** 2)
        tolerance = 64 * EPS * (2 * degree + 1)
        assert np.abs(matrix @ still[rows] - turned[rows]).max() <= tolerance
        assert np.abs(matrix @ matrix.T - np.eye(len(matrix))).max() <= tolerance


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rotating_coefficients_turns_the_function(rng, dtype):
    rotation = HARD["any"].as_matrix()
    coefficients = rng.standard_normal((2, 3, 25)).astype(dtype)
    directions = random_directions(30, 2)
    turned = rotate(coefficients, rotation)
    assert turned.dtype == dtype
    np.testing.assert_allclose(
        synthesize(turned, directions),
        synthesize(coefficients, directions @ rotation),  # f(R^-1 w), vectors being rows
        atol=64 * np.finfo(dtype).eps * 9 * 5,
    )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_zonal_function_turns_as_any_other(rng, dtype):
    max_degree = 6
    zonal = rng.standard_normal((4, max_degree + 1)).astype(dtype)
    flat = np.zeros((4, (max_degree + 1) ** 2), dtype)
    degree = np.arange(max_degree + 1)
    flat[:, degree * (degree + 1)] = zonal
    rotation = HARD["any"].as_matrix()
    turned = rotate_zonal(zonal, rotation[:, 2])
    assert turned.dtype == dtype
    error = np.abs(turned - rotate(flat, rotation)).max(axis=0)
    assert (error <= 64 * np.finfo(dtype).eps * (2 * degrees(max_degree) + 1)).all()


def test_a_rotation_in_single_precision_gives_orthogonal_matrices():
    rotation = HARD["any"].as_matrix().astype(np.float32)
    for matrix in rotation_matrices(rotation, 4):
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(len(matrix)), atol=64 * 9 * EPS)


@pytest.mark.parametrize(
    "matrix", [np.diag([1.0, 1.0, -1.0]), 2 * np.eye(3), np.full((3, 3), np.nan), np.ones((3, 3))]
)
def test_refuses_what_is_not_a_rotation(matrix):
    with pytest.raises(ArgumentError, match="rotation must be"):
        rotation_matrices(matrix, 1)
    with pytest.raises(ArgumentError, match="rotation must be"):
        rotate(np.ones(4), matrix)


def test_refuses_degrees_and_coefficients_that_make_no_sense():
    with pytest.raises(ArgumentError, match="max_degree must be 0 or more"):
        rotation_matrices(np.eye(3), -1)
    with pytest.raises(ArgumentError, match="must be a square"):
        rotate(np.ones(5), np.eye(3))
    with pytest.raises(ArgumentError, match="coefficients must be finite"):
        rotate(np.full(4, np.nan), np.eye(3))


def test_refuses_a_zonal_function_without_axis_or_coefficients(unchecked):
    up = np.array([0.0, 0.0, 1.0])
    with pytest.raises(ArgumentError, match="axis must be unit"):
        rotate_zonal(np.ones(3), 2 * up)
    with pytest.raises(ArgumentError, match="zonal must be finite"):
        rotate_zonal(np.full(3, np.inf), up)
    with pytest.raises(ArgumentError, match=r"zonal must have shape"):
        rotate_zonal(np.ones((2, 0)), up)
    with pytest.raises(ArgumentError, match=r"axis shape \(3,\)"):
        rotate_zonal(np.ones(3), np.eye(3))
