"""What a person is told, from results that are made up."""

import numpy as np
import pytest

from harmface.stereo.advice import doubts, relative_strengths
from harmface.stereo.result import Recovered
from harmface.stereo.uncertainty import MapError
from tests.unit.stereo.conftest import front_lights

WIDE = front_lights(12)


def recovered(tilt=(0.0, 0.0), stretch=0.0, lamps=WIDE, convexity="outline"):
    of_map = MapError(np.zeros(2), tilt, stretch)
    return Recovered("refined", np.eye(3)[:2], np.zeros(2), of_map, convexity, lamps=lamps)


def about(x, y):
    """Lamps within some ten degrees of a direction."""
    middle = np.array([x, y, 1.0])
    lamps = middle + 0.15 * np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    return lamps / np.linalg.norm(lamps, axis=1, keepdims=True)


def test_a_sure_result_needs_no_words():
    assert doubts(recovered()) == ()
    assert doubts(recovered(tilt=(7.9, 7.9), stretch=0.24)) == ()


@pytest.mark.parametrize(
    ("axis", "lamps", "side"),
    [
        ("x", about(0.0, 0.4), "below"),
        ("x", about(0.0, -0.4), "above"),
        ("y", about(0.4, 0.0), "the left"),
        ("y", about(-0.4, 0.0), "the right"),
    ],
)
def test_narrow_lamps_need_one_from_the_other_side(axis, lamps, side):
    tilt = (12.0, 0.0) if axis == "x" else (0.0, 12.0)
    (said,) = doubts(recovered(tilt=tilt, lamps=lamps))
    assert f"tilt about {axis} is uncertain by 12 degrees" in said
    assert f"add a lamp from {side}, or give one normal (normals_known)" in said
    middle = lamps.mean(axis=0) / np.linalg.norm(lamps.mean(axis=0))
    angle = np.degrees(np.arccos(lamps @ middle)).max()
    assert angle < 10
    place = ", ".join(f"{part:.2f}" for part in middle)
    assert f"all lamps lie within {angle:.0f} degrees of ({place}): " in said


@pytest.mark.parametrize("lamps", [WIDE, None])
def test_other_light_needs_a_normal(lamps):
    said = doubts(recovered(tilt=(12.0, 30.0), lamps=lamps))
    assert len(said) == 2
    assert said[0].startswith("tilt about x is uncertain by 12 degrees; give one normal")
    assert said[1].startswith("tilt about y is uncertain by 30 degrees; give one normal")
    assert not any("add a lamp" in each for each in said)


def test_stretch():
    (said,) = doubts(recovered(stretch=0.4))
    assert "the depth may be stretched by 40%" in said
    assert "give one normal, or the directions of the lamps" in said


def test_unequal_strengths():
    (said,) = doubts(recovered(lamps=WIDE * np.linspace(1, 3, 12)[:, None]))
    low, high = np.percentile(np.linspace(1, 3, 12), [10, 90])
    assert said == f"strengths of the lamps differ by {high / low:.1f} times"
    assert doubts(recovered(lamps=WIDE * np.linspace(1, 1.4, 12)[:, None])) == ()
    # A single one among many is no reason to worry.
    alone = np.ones(12)
    alone[3] = 9
    assert doubts(recovered(lamps=WIDE * alone[:, None])) == ()


def test_convex_assumed():
    (said,) = doubts(recovered(convexity="assumed"))
    assert said.startswith("convex was assumed")


def test_known_light_leaves_no_map_to_doubt():
    found = Recovered("known-lights", np.eye(3)[:2], np.zeros(2), None, "light", lamps=WIDE)
    assert doubts(found) == ()


def test_strengths_are_relative_to_their_mean():
    assert relative_strengths(np.diag([1.0, 2.0, 6.0])) == pytest.approx((1 / 3, 2 / 3, 2))
    assert relative_strengths(np.zeros((2, 3))) == (0, 0)
