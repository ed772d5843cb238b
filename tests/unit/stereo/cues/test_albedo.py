from dataclasses import replace

import numpy as np

from harmface.stereo.cues import Albedo, scale_of
from tests.unit.stereo.conftest import bas_relief

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])


def test_albedo_of_one_value_does_not_change(egg):
    cue = Albedo.of(egg.field(FRAME))
    truth = np.linalg.inv(FRAME)
    assert np.abs(cue.residuals(truth)).max() < 1e-12
    assert scale_of(cue.residuals(truth), cue.floor) == cue.floor
    # Shading of a sphere of radius 20 that is not taken out changes by some percent a pixel.
    assert scale_of(cue.residuals(bas_relief(0.5, 0, 0.5) @ truth), cue.floor) > 3 * cue.floor


def test_residuals_are_the_slopes_of_its_logarithm(egg):
    albedo = np.exp(0.05 * egg.places[:, 0] - 0.03 * egg.places[:, 1])
    cue = Albedo.of(egg.field(albedo=albedo, slope=(0.05, -0.03)))
    count = len(cue.v)
    assert np.allclose(cue.residuals(np.eye(3))[:count], 0.05)
    assert np.allclose(cue.residuals(np.eye(3))[count:], -0.03)


def test_turns_and_scale_change_nothing(egg, rng):
    cue = Albedo.of(egg.field(FRAME))
    rows = rng.standard_normal((3, 3))
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    assert np.allclose(cue.residuals(5 * turn @ rows), cue.residuals(rows))


def test_the_border_is_left_out_unless_there_is_nothing_else(egg):
    seen = egg.field()
    assert len(Albedo.of(seen).v) == seen.inner.sum() < len(seen.middle)
    thin = replace(seen, inner=np.zeros_like(seen.inner))
    assert len(Albedo.of(thin).v) == len(seen.middle)


def test_a_pixel_of_no_albedo_is_no_change(egg):
    albedo = np.ones(len(egg.normals))
    albedo[::7] = 0
    assert np.isfinite(Albedo.of(egg.field(albedo=albedo)).residuals(np.eye(3))).all()
