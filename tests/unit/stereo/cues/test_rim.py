from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo.cues import Rim, outline_of, scale_of
from harmface.stereo.cues.rim import FEWEST, LEAN
from tests.unit.stereo.conftest import Quadric

TURNED = Rotation.from_rotvec([0.0, 0.0, 0.4]).as_matrix()


def circle(lean):
    """Normals that lean by a sine all around, and the outward directions."""
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    outward = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    towards = np.full((60, 1), np.sqrt(1 - lean**2))
    return np.concatenate([lean * outward, towards], axis=1), outward


def test_normals_lean_outwards_whatever_the_stretch():
    v, outward = circle(0.9)
    cue = Rim(v, outward)
    for stretch in (0.1, 1.0, 4.0):
        assert np.abs(cue.residuals(np.diag([1.0, 1.0, stretch]))).max() < 1e-15
    # And the sine of the angle by which they are turned.
    lean = 0.9 / np.sqrt(0.9**2 + LEAN**2)
    assert np.allclose(cue.residuals(TURNED), lean * np.sin(0.4))
    sheared = np.array([[1.0, 0.5, 0], [0, 1, 0], [0, 0, 1]])
    assert scale_of(cue.residuals(sheared), 0) > 3 * cue.floor


def test_a_normal_that_does_not_lean_says_nothing():
    v, outward = circle(1e-6)
    assert np.abs(Rim(v, outward).residuals(TURNED)).max() < 1e-4


@pytest.mark.parametrize("semiaxes", [(20.0, 20.0, 20.0), (20.0, 15.0, 17.0)])
def test_an_ellipsoid_has_a_rim(semiaxes):
    shape = Quadric(semiaxes)
    cue = Rim.of(shape.field())
    # A pixel inside the outline of a circle of 20 pixels subtends 3 degrees; the outline's own
    # direction follows the mean of a few pixels.
    assert scale_of(cue.residuals(np.eye(3)), cue.floor) < 2 * cue.floor
    assert scale_of(cue.residuals(TURNED), cue.floor) > 10 * cue.floor


def test_no_outline_no_cue():
    full = Quadric(width=15, size=15)
    assert full.mask.all()
    assert Rim.of(full.field()) is None


def test_a_rim_in_the_dark_is_not_relied_on(sphere):
    seen = sphere.field()
    outline = outline_of(sphere.mask).pixels
    lit = np.ones(len(seen.lit))
    lit[outline[FEWEST:]] = 0.5
    some = Rim.of(replace(seen, lit=lit))
    assert np.array_equal(some.v, seen.smoothed[outline[:FEWEST]])
    lit[outline[FEWEST - 1 :]] = 0.5
    assert Rim.of(replace(seen, lit=lit)) is None


def test_outward_directions_of_a_disc():
    y, x = np.mgrid[30:-31:-1, -30:31]
    outline = outline_of(np.hypot(x, y) < 25)
    inside = np.flatnonzero(np.hypot(x, y) < 25)
    radial = np.stack([x.ravel()[inside], y.ravel()[inside]], axis=1)[outline.pixels]
    radial = radial / np.linalg.norm(radial, axis=1, keepdims=True)
    # A pixel on a circle of radius 25 subtends 2.3 degrees.
    assert np.degrees(np.arccos((outline.outward * radial).sum(axis=1).clip(-1, 1))).max() < 4


def test_the_outline_is_a_pixel_inside():
    y, x = np.mgrid[30:-31:-1, -30:31]
    mask = np.hypot(x, y) < 25
    radius = np.hypot(x, y)[mask][outline_of(mask).pixels]
    # Erosion takes a pixel along the axes, and 0.7 along the diagonals.
    assert 25 - 3 < radius.min() <= radius.max() < 25 - 0.7


def test_the_border_of_the_picture_is_no_outline():
    assert len(outline_of(np.ones((9, 9), bool)).pixels) == 0
