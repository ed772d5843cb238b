import numpy as np

from harmface.stereo.cues import Facing
from tests.unit.stereo.conftest import bas_relief


def test_what_is_in_front_looks_to_the_camera(egg):
    cue = Facing.of(egg.field())
    assert not cue.residuals(np.eye(3)).any()
    # Nor does a stretch, or a tilt of b_x, turn anything away.
    assert not cue.residuals(bas_relief(0.4, -2.0, 0.1)).any()


def test_what_looks_away_counts_by_how_far(egg):
    cue = Facing.of(egg.field())
    away = np.diag([1.0, 1.0, -1.0])
    assert np.allclose(cue.residuals(away), -egg.normals[:, 2])
    albedo = np.linspace(0.1, 2, len(egg.normals))
    assert np.allclose(Facing.of(egg.field(albedo=albedo)).residuals(3 * away), -egg.normals[:, 2])
