"""On ellipsoids, whose normals are linear in place, so that derivatives are known exactly."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo import angular_errors, without_bas_relief
from harmface.stereo.cues import Integrability, scale_of, structure_field
from harmface.stereo.homogeneous import directions_of
from tests.unit.stereo.conftest import bas_relief

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])
TURNED = Rotation.from_rotvec([0.2, -0.1, 0.25]).as_matrix()


def test_the_surface_is_integrable_in_any_frame(egg):
    for frame in (np.eye(3), FRAME):
        cue = Integrability.of(egg.field(frame))
        truth = np.linalg.inv(frame)
        # Relative to derivatives: eps over the share of them that is expected to be wrong.
        assert np.abs(cue.residuals(truth)).max() < 1e-9
        assert scale_of(cue.residuals(TURNED @ truth), 0) > 1


def test_albedo_does_not_count(egg, rng):
    albedo = np.exp(0.05 * egg.places[:, 0] - 0.03 * egg.places[:, 1])
    cue = Integrability.of(egg.field(FRAME, albedo, (0.05, -0.03)))
    assert np.abs(cue.residuals(np.linalg.inv(FRAME))).max() < 1e-9
    plain = Integrability.of(egg.field(FRAME))
    rows = rng.standard_normal((3, 3))
    assert np.allclose(cue.residuals(rows), plain.residuals(rows), rtol=1e-9, atol=1e-9)


def test_bas_reliefs_change_nothing(egg, rng):
    cue = Integrability.of(egg.field(FRAME))
    rows = rng.standard_normal((3, 3))
    before = cue.residuals(rows)
    assert np.abs(before).max() > 1
    for mu, nu, stretch in ((0.7, 0, 1), (0, -1.3, 1), (0.2, 0.4, 0.1), (1.0, 2.0, 5.0)):
        after = cue.residuals(bas_relief(mu, nu, stretch) @ rows)
        assert np.allclose(after, before, rtol=1e-9, atol=1e-9)
    assert np.allclose(cue.residuals(3.0 * rows), before, rtol=1e-9, atol=1e-9)
    # A stretch of x alone is none.
    assert not np.allclose(cue.residuals(np.diag([2.0, 1, 1]) @ rows), before, rtol=0.1)


def test_flattening_does_not_pass_for_integrable(egg):
    cue = Integrability.of(egg.field())
    wrong = scale_of(cue.residuals(TURNED), 0)
    flat = scale_of(cue.residuals(np.diag([1.0, 1.0, 1e-6]) @ TURNED), 0)
    assert flat == pytest.approx(wrong, rel=1e-6)


def test_four_dimensions(egg):
    """Of (|b|, b), as of harmonic light, the last three are integrable."""
    frame = np.concatenate([np.ones((1, 3)), np.eye(3)])
    cue = Integrability.of(egg.field(frame))
    assert np.abs(cue.residuals(np.eye(4)[1:])).max() < 1e-9
    assert scale_of(cue.residuals(np.eye(4)[:3]), 0) > 1


def test_whitening_is_undone_by_the_rows(egg):
    cue = Integrability.of(egg.field(FRAME), np.diag([1.0, 0.1, 3.0]))
    assert np.abs(cue.residuals(np.linalg.inv(FRAME))).max() < 1e-9
    assert scale_of(cue.residuals(TURNED @ np.linalg.inv(FRAME)), 0) > 1


def test_noise_makes_residuals_that_are_expected(egg, rng):
    """Of unit variance: normal ones are likeliest at a scale of 0.61."""
    noisy = egg.normals + 0.1 * rng.standard_normal(egg.normals.shape)
    noise = np.full(len(noisy), 0.1)
    seen = structure_field(noisy, egg.mask, np.ones(len(noisy)), noise)
    at_truth = scale_of(Integrability.of(seen).residuals(np.eye(3))[seen.inner], 0)
    # The share of differences over a cell is small beside this noise, and there is a rim.
    assert at_truth == pytest.approx(0.61, rel=0.25)


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_search_finds_integrable_maps(sphere, rng, noise):
    v = (sphere.normals + noise * rng.standard_normal(sphere.normals.shape)) @ FRAME.T
    information = np.linalg.inv(FRAME @ FRAME.T)
    seen = structure_field(v, sphere.mask, np.ones(len(v)), np.full(len(v), noise))
    scale, axes = np.linalg.eigh(information)
    cue = Integrability.of(seen, (axes * np.sqrt(scale)) @ axes.T)
    found = cue.best_rows(rng)
    costs = [np.log1p(cue.residuals(rows) ** 2).sum() for rows in found]
    assert costs == pytest.approx(sorted(costs), rel=1e-9)
    rows = found[0]
    normals = without_bas_relief(directions_of(v @ rows.T), sphere.normals)
    # Noise of 0.4 % turns a normal by 0.2 degrees.
    assert angular_errors(normals, sphere.normals).mean() < 2
    if noise == 0:
        exact = Integrability.of(sphere.field(FRAME)).best_rows(rng)[0]
        left = without_bas_relief(directions_of(v @ exact.T), sphere.normals)
        assert angular_errors(left, sphere.normals).max() < 0.01


def test_found_rows_are_level(egg, rng):
    """t_x and t_y across t_z: of the bas-reliefs, one."""
    rows = Integrability.of(egg.field()).best_rows(rng)[0]
    assert rows[:2] @ rows[2] == pytest.approx([0, 0], abs=1e-12)
    assert np.linalg.norm(rows[2]) == pytest.approx(1)
    assert (rows[:2] ** 2).sum() == pytest.approx(2)
