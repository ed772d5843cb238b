import numpy as np
import pytest

from harmface.stereo.cues import Symmetry
from harmface.stereo.cues.symmetry import mirrored_pixels
from tests.unit.stereo.conftest import Quadric, bas_relief

# Turned about x only: its left and right are alike.
EVEN = Quadric((18.0, 15.0, 20.0), (0.4, 0.0, 0.0))


def test_a_symmetric_surface_is_its_own_mirror_image(egg):
    cue = Symmetry.of(EVEN.field())
    assert np.abs(cue.residuals(np.eye(3))).max() < 1e-12
    # Nor does a tilt about the x axis, or a stretch, spoil it.
    assert np.abs(cue.residuals(bas_relief(0, 0.5, 0.4))).max() < 1e-12
    assert np.median(np.abs(cue.residuals(bas_relief(0.3, 0, 1)))) > 3 * cue.floor
    assert np.median(np.abs(Symmetry.of(egg.field()).residuals(np.eye(3)))) > 3 * cue.floor


def test_albedo_need_not_be_symmetric(rng):
    cue = Symmetry.of(EVEN.field(albedo=rng.uniform(0.2, 1, len(EVEN.normals))))
    assert np.abs(cue.residuals(np.eye(3))).max() < 1e-12


def test_no_component_gains_by_vanishing(egg):
    cue = Symmetry.of(egg.field())
    each = np.abs(cue.residuals(np.eye(3))).reshape(-1, 3)
    flat = np.abs(cue.residuals(np.diag([1e-6, 1.0, 1.0]))).reshape(-1, 3)
    assert flat[:, 0].mean() == pytest.approx(each[:, 0].mean(), rel=0.3)


def test_pixels_meet_their_mirror_images():
    mask = np.array([[0, 0, 1, 1, 1], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0]], bool)
    here, there = mirrored_pixels(mask)
    # Columns 2 to 4; the pixel in the second row has no counterpart.
    assert here.tolist() == [0, 1, 2, 4]
    assert there.tolist() == [2, 1, 0, 4]


def test_a_mask_at_the_border_has_no_counterparts_outside():
    mask = np.ones((2, 3), bool)
    here, there = mirrored_pixels(mask)
    assert here.tolist() == [0, 1, 2, 3, 4, 5]
    assert there.tolist() == [2, 1, 0, 5, 4, 3]
