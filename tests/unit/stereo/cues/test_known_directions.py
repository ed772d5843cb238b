import numpy as np

from harmface.stereo.cues import KnownDirections
from tests.unit.stereo.conftest import bas_relief, front_lights

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])
DIRECTIONS = front_lights(12)
ONES = np.ones(12)


def test_the_true_map_leaves_nothing_whatever_the_strengths(rng):
    lamps = DIRECTIONS * rng.uniform(0.2, 3, (12, 1)) @ np.linalg.inv(FRAME)
    cue = KnownDirections(lamps, DIRECTIONS, ONES)
    truth = np.linalg.inv(FRAME)
    assert np.abs(cue.residuals(truth)).max() < 1e-14
    assert np.abs(cue.residuals(4 * truth)).max() < 1e-14
    assert np.abs(cue.residuals(bas_relief(0.2, 0, 1) @ truth)).max() > 10 * cue.floor


def test_lamps_weigh_by_what_they_light():
    turned = DIRECTIONS.copy()
    turned[0] = (1.0, 0, 0)
    weights = np.linspace(0, 2, 12)
    cue = KnownDirections(turned, DIRECTIONS, weights)
    assert np.abs(cue.residuals(np.eye(3))).max() < 1e-15
    cue = KnownDirections(turned, DIRECTIONS, weights[::-1].copy())
    found = cue.residuals(np.eye(3))
    assert np.allclose(found[:3], np.sqrt(2) * (turned[0] - DIRECTIONS[0]))


def test_a_start_is_the_map_itself(rng):
    lamps = DIRECTIONS * rng.uniform(0.2, 3, (12, 1)) @ np.linalg.inv(FRAME)
    rows = KnownDirections(lamps, DIRECTIONS, ONES).start()
    truth = np.linalg.inv(FRAME)
    assert np.allclose(rows / np.linalg.norm(rows), truth / np.linalg.norm(truth), atol=1e-12)
    # A lamp that lights nothing has no say.
    lamps[0] = rng.standard_normal(3)
    weights = ONES.copy()
    weights[0] = 0
    rows = KnownDirections(lamps, DIRECTIONS, weights).start()
    assert np.allclose(rows / np.linalg.norm(rows), truth / np.linalg.norm(truth), atol=1e-12)
