import numpy as np
import pytest

from harmface.stereo.cues import Highlights, scale_of
from harmface.stereo.cues.highlights import FEWEST
from tests.unit.stereo.conftest import bas_relief, front_lights

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])
LAMPS = front_lights(24)
HALVES = LAMPS + np.array([0, 0, 1])
HALVES = HALVES / np.linalg.norm(HALVES, axis=1, keepdims=True)


def test_where_the_normal_halves_the_angle_nothing_is_left():
    back = np.linalg.inv(FRAME)
    cue = Highlights(HALVES @ FRAME.T, LAMPS @ back)
    assert np.abs(cue.residuals(back)).max() < 1e-14
    assert np.median(cue.residuals(np.eye(3))) > 3 * cue.floor


def test_the_strength_of_lamps_and_albedo_do_not_matter(rng):
    n, lamps, rows = *rng.standard_normal((2, 30, 3)), rng.standard_normal((3, 3))
    scaled = Highlights(n * rng.uniform(0.1, 3, (30, 1)), lamps * rng.uniform(0.1, 3, (30, 1)))
    assert np.allclose(scaled.residuals(rows), Highlights(n, lamps).residuals(rows))


def shine(shape, rng):
    """What a mirror lobe adds, and noise."""
    lobe = np.maximum(HALVES @ shape.normals.T, 0) ** 200
    return 0.3 * lobe + 0.003 * rng.standard_normal(lobe.shape)


def test_highlights_of_an_ellipsoid(egg, rng):
    beyond = shine(egg, rng)
    shown = np.ones(beyond.shape, bool)
    back = np.linalg.inv(FRAME)
    cue = Highlights.of(egg.field(FRAME), LAMPS @ back, beyond, shown)
    assert len(cue.v) > 12
    assert scale_of(cue.residuals(back), cue.floor) < cue.believable / 2
    # Normals of a radius of 15 turn by four degrees from pixel to pixel.
    assert np.median(cue.residuals(back)) < 0.06
    assert scale_of(cue.residuals(bas_relief(0.4, 0.2, 0.6) @ back), cue.floor) > cue.believable


def test_noise_is_no_highlight(egg, rng):
    beyond = 0.01 * rng.standard_normal((24, len(egg.normals)))
    shown = np.ones(beyond.shape, bool)
    assert Highlights.of(egg.field(), LAMPS, beyond, shown) is None


def test_what_is_not_shown_holds_none(egg, rng):
    beyond = shine(egg, rng)
    for count, found in ((FEWEST, True), (FEWEST - 1, False)):
        shown = np.zeros(beyond.shape, bool)
        # Lamps that are high, so that the highlight is well inside.
        shown[np.argsort(-LAMPS[:, 2])[:count]] = True
        cue = Highlights.of(egg.field(), LAMPS, beyond, shown)
        assert (cue is not None) == found
    assert len(cue.v if cue else np.empty(0)) in (0, FEWEST)


@pytest.mark.parametrize("spread", [0.02, 0.5])
def test_bright_places_at_random_are_not_believed(rng, spread):
    n = HALVES + spread * rng.standard_normal(HALVES.shape)
    cue = Highlights(n, LAMPS)
    scale = scale_of(cue.residuals(np.eye(3)), cue.floor)
    assert (scale < cue.believable) == (spread == 0.02)
