import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo.cues import LightMetric, anisotropy
from harmface.stereo.lorentz import METRIC, lorentz_transformation


def test_isometries_leave_nothing():
    turn = Rotation.from_rotvec([1.0, -2.0, 0.3]).as_matrix()
    cue = LightMetric(np.eye(3))
    assert np.abs(cue.residuals(5 * turn)).max() < 1e-14
    mirror = np.diag([1.0, 1.0, -1.0])
    assert np.abs(cue.residuals(mirror @ turn)).max() < 1e-14
    boost = lorentz_transformation(np.array([0.4, -0.3, 0.5, 1.0, 0.2, -0.7]))[1:]
    cue = LightMetric(-METRIC)
    assert np.abs(cue.residuals(boost)).max() < 1e-13
    # The same boost is no rotation.
    assert np.abs(LightMetric(np.eye(4)).residuals(boost)).max() > 0.1


def test_a_stretch_is_what_it_is_relative_to_the_mean():
    # Of squares 1, 1 and 4 the mean is 2.
    found = LightMetric(np.eye(3)).residuals(np.diag([1.0, 1.0, 2.0]))
    assert found == pytest.approx([-0.5, 0, 0, -0.5, 0, 1])
    assert np.allclose(LightMetric(np.eye(3)).residuals(np.diag([7.0, 7, 14])), found)


def test_anisotropy_of_nothing_is_finite():
    assert np.isfinite(anisotropy(np.zeros((3, 3)))).all()
