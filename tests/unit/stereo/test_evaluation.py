import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.errors import ArgumentError
from harmface.stereo import (
    angular_errors,
    summary,
    without_bas_relief,
    without_convexity,
    without_linear_map,
    without_lorentz,
    without_rotation,
)
from harmface.stereo.lorentz import lorentz_transformation

Z = np.array([[0.0, 0, 1]])


def tilted(degrees):
    a = np.radians(degrees)
    return np.stack([np.sin(a), np.zeros_like(a), np.cos(a)], axis=-1)


def test_angles_are_exact_even_when_small():
    angles = np.array([0.0, 1e-7, 1.0, 90.0, 179.0, 180.0])
    truth = np.repeat(Z, len(angles), axis=0)
    # Near 180 degrees the chord is flat: the root of eps, 1e-8 radians.
    assert np.allclose(angular_errors(tilted(angles), truth), angles, rtol=1e-8, atol=2e-6)
    assert angular_errors(tilted(angles[1:2]), Z)[0] == pytest.approx(1e-7, rel=1e-6)


def test_summary_is_mean_and_percentiles():
    found = summary(np.arange(101.0))
    assert (found.mean, found.median, found.p90, found.p99) == (50, 50, 90, 99)


def test_ambiguities_are_undone(hills):
    n = hills.normals
    turn = Rotation.from_rotvec([1, 2, 0.5]).as_matrix() @ np.diag([1, 1, -1])
    assert angular_errors(without_rotation(n @ turn, n), n).max() < 1e-6
    assert angular_errors(without_convexity(n * (-1, -1, 1), n), n).max() == 0
    null = np.concatenate([np.ones((len(n), 1)), n], axis=1)
    image = null @ lorentz_transformation(np.array([0.2, -0.3, 0.1, 1, 0, 2.0])).T
    moved = image[:, 1:] / image[:, :1]
    assert angular_errors(without_rotation(moved, n), n).mean() > 3
    assert angular_errors(without_lorentz(moved, n), n).max() < 1e-5


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bas_relief_is_undone(hills, sign):
    n = hills.normals
    bent = sign * np.array([1, 1, 0]) * n + n[:, 2:] * (0.3, -0.4, 0.5)
    bent /= np.linalg.norm(bent, axis=1, keepdims=True)
    assert angular_errors(bent, n).mean() > 10
    assert angular_errors(without_bas_relief(bent, n), n).max() < 1e-3
    # A turn about the line of sight is none.
    turned = n @ Rotation.from_rotvec([0, 0, 0.5]).as_matrix()
    assert angular_errors(without_bas_relief(turned, n), n).mean() > 5


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: angular_errors(2 * Z, Z), "unit vectors"),
        (lambda: angular_errors(Z, 2 * Z), "unit vectors"),
        (lambda: angular_errors(Z, Z.repeat(2, axis=0)), "truth must match"),
        (lambda: summary(np.empty(0)), "at least one angle"),
    ],
)
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()


def test_oracle_is_not_drawn_to_faint_dimensions(hills, rng):
    seen = hills.normals + 0.01 * rng.standard_normal(hills.normals.shape)
    faint = 1e-4 * rng.standard_normal((len(seen), 3))
    structure = np.concatenate([seen, faint], axis=1)
    normals = without_linear_map(structure, hills.normals)
    # 0.01 across the normal, in two directions: 0.8 degrees.
    assert angular_errors(normals, hills.normals).mean() < 1
