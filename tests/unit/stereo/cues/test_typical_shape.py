import numpy as np
import pytest
from scipy.integrate import dblquad

from harmface.stereo.cues import TypicalShape, cost_of
from harmface.stereo.cues.typical_shape import CROPPED, SPREAD, WHOLE, border_share
from tests.unit.stereo.conftest import Quadric, bas_relief


def test_a_hemisphere_over_its_disc_and_over_its_square():
    assert pytest.approx(2 / 3, abs=5e-4) == WHOLE
    half = np.sqrt(0.5)
    total, _ = dblquad(lambda y, x: np.sqrt(1 - x**2 - y**2), 0, half, 0, half)
    assert pytest.approx(total / half**2, abs=0.02) == CROPPED


def test_a_sphere_is_typical(sphere):
    cue = TypicalShape.of(sphere.field())
    assert cue.towards == WHOLE
    # 600 pixels on a disc of radius 20: its rim is known to half a pixel in 20.
    assert np.abs(cue.residuals(np.eye(3)) * SPREAD).max() < 0.02
    assert np.abs(cue.residuals(3 * np.eye(3)) * SPREAD).max() < 0.02
    for wrong in (bas_relief(0.6, 0, 1), bas_relief(0, -0.6, 1), bas_relief(0, 0, 0.2)):
        assert np.abs(cue.residuals(wrong)).max() > 2
        assert cost_of(cue, wrong) > cost_of(cue, np.eye(3)) + 1


def test_a_crop_of_a_sphere_is_typical_too():
    square = Quadric((20.0, 20.0, 20.0), size=28)
    assert square.mask.all()
    cue = TypicalShape.of(square.field())
    assert cue.towards == CROPPED
    assert np.abs(cue.residuals(np.eye(3))).max() < 0.5


def test_which_mean_is_off_is_told_in_units_of_its_spread():
    n = np.tile([[0.6, 0.0, 0.8]], (50, 1))
    found = TypicalShape(n, 0.7).residuals(np.eye(3))
    assert found == pytest.approx([6, 0, 0.1 / 0.07])


def test_share_of_the_rim_on_the_border_of_the_picture():
    mask = np.zeros((9, 9), bool)
    mask[2:7, 2:7] = True
    assert border_share(mask) == 0
    assert border_share(np.ones((9, 9), bool)) == 1
    mask[:2, 2:7] = True
    # Of a rim of 2 * 7 + 2 * 5 - 4 = 20 pixels five are on the border.
    assert border_share(mask) == 0.25
    assert border_share(np.zeros((4, 4), bool)) == 0
