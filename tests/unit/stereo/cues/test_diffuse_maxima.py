import numpy as np
import pytest

from harmface.stereo.cues import DiffuseMaxima, scale_of
from harmface.stereo.cues.diffuse_maxima import FEWEST
from tests.unit.stereo.conftest import bas_relief, front_lights

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])
STEEP = front_lights(60)
LAMPS = STEEP[STEEP[:, 2] > 0.6]


def test_where_the_normal_is_along_the_lamp_nothing_is_left():
    back = np.linalg.inv(FRAME)
    cue = DiffuseMaxima(LAMPS @ FRAME.T, LAMPS @ back)
    assert np.abs(cue.residuals(back)).max() < 1e-14
    assert np.median(cue.residuals(np.eye(3))) > 3 * cue.floor


def test_the_chord_is_that_of_the_angle():
    a = np.radians(25)
    cue = DiffuseMaxima(np.array([[np.sin(a), 0, np.cos(a)]]), np.array([[0.0, 0, 2]]))
    assert cue.residuals(np.eye(3)) == pytest.approx(2 * np.sin(a / 2))


def test_the_strength_of_lamps_and_albedo_do_not_matter(rng):
    n, rows = rng.standard_normal((30, 3)), rng.standard_normal((3, 3))
    lamps = rng.standard_normal((30, 3))
    scaled = DiffuseMaxima(n * rng.uniform(0.1, 3, (30, 1)), lamps * rng.uniform(0.1, 3, (30, 1)))
    assert np.allclose(scaled.residuals(rows), DiffuseMaxima(n, lamps).residuals(rows))


@pytest.mark.parametrize("frame", [np.eye(3), FRAME])
def test_maxima_of_an_ellipsoid(egg, frame):
    strengths = np.linspace(0.2, 5, len(LAMPS))[:, None]
    cue = DiffuseMaxima.of(egg.field(frame), strengths * LAMPS @ np.linalg.inv(frame))
    truth = np.linalg.inv(frame)
    assert len(cue.v) >= FEWEST
    # From pixel to pixel normals of a radius of 15 turn by four degrees, so within half a pixel
    # along x and y by a chord of 0.05.
    assert cue.residuals(truth).max() < 0.06
    assert scale_of(cue.residuals(bas_relief(0.3, 0.2, 0.6) @ truth), cue.floor) > 0.1


def test_a_maximum_on_the_rim_is_none(egg):
    """Behind the object's horizon the brightest place is its border."""
    aside = np.stack([np.cos(np.arange(9.0)), np.sin(np.arange(9.0)), np.full(9, -0.2)], axis=1)
    assert DiffuseMaxima.of(egg.field(), aside) is None


def test_too_few_maxima_say_nothing(egg):
    assert DiffuseMaxima.of(egg.field(), LAMPS[: FEWEST - 1]) is None
    assert len(DiffuseMaxima.of(egg.field(), LAMPS[:FEWEST]).v) == FEWEST
