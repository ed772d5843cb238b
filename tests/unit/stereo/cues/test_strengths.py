import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo.cues import Strengths, scale_of
from tests.unit.stereo.conftest import front_lights

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])


def test_equal_lamps_in_any_frame():
    # b = T v with v = F n, so the lamps of v are those of n times F^-1.
    cue = Strengths.of(front_lights(20) @ np.linalg.inv(FRAME), np.ones(20))
    truth = np.linalg.inv(FRAME)
    assert np.abs(cue.residuals(truth)).max() < 1e-14
    assert scale_of(cue.residuals(np.eye(3)), cue.floor) > 2 * cue.floor


def test_turning_or_scaling_all_lamps_changes_nothing(rng):
    cue = Strengths.of(rng.standard_normal((12, 3)), rng.uniform(0.1, 1, 12))
    rows = rng.standard_normal((3, 3))
    before = cue.residuals(rows)
    assert np.abs(before).max() > 0.1
    turn = Rotation.from_rotvec([1, 2, 3]).as_matrix()
    assert np.allclose(cue.residuals(turn @ rows), before)
    assert np.allclose(cue.residuals(7 * rows), before)


def test_residuals_are_logarithms_about_their_mean():
    strength = np.exp([0.3, -0.1, 0.5, -0.7])
    cue = Strengths.of(front_lights(4) * strength[:, None], np.ones(4))
    assert np.allclose(cue.residuals(np.eye(3)), [0.3, -0.1, 0.5, -0.7])


def test_a_lamp_weighs_by_what_it_lights():
    lamps = front_lights(5) * np.array([[1.0], [1], [1], [1], [30]])
    lit = np.array([1.0, 1, 1, 1, 0])
    cue = Strengths.of(lamps, lit)
    # Neither in the mean nor by itself.
    assert np.abs(cue.residuals(np.eye(3))).max() < 1e-14
    half = Strengths.of(lamps, np.array([1.0, 1, 1, 1, 0.5]))
    mean = np.log(30) * 0.5 / 4.5
    weights = np.array([1, 1, 1, 1, 0.5]) / 0.9
    expected = np.sqrt(weights) * (np.log([1, 1, 1, 1, 30]) - mean)
    assert np.allclose(half.residuals(np.eye(3)), expected)


@pytest.mark.parametrize(("lamps", "votes"), [(4, 4), (10, 10), (64, 10)])
def test_few_lamps_have_a_vote_each(lamps, votes):
    assert Strengths.of(front_lights(lamps), np.ones(lamps)).votes == votes


def test_lamps_that_differ_are_not_believed(rng):
    """A spread of 30 % is, to Cauchy, a scale of two thirds of it."""
    cue = Strengths.of(front_lights(40) * np.exp(0.5 * rng.standard_normal((40, 1))), np.ones(40))
    assert scale_of(cue.residuals(np.eye(3)), cue.floor) > cue.believable
    alike = Strengths.of(front_lights(40) * np.exp(0.1 * rng.standard_normal((40, 1))), np.ones(40))
    assert scale_of(alike.residuals(np.eye(3)), alike.floor) < alike.believable
