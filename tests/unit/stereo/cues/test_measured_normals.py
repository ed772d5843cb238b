import numpy as np

from harmface.stereo.cues import MeasuredNormals
from tests.unit.stereo.conftest import bas_relief

FRAME = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])


def test_the_true_map_gives_the_normals_whatever_their_albedo(egg, rng):
    some = egg.normals[::100]
    v = some * rng.uniform(0.2, 2, (len(some), 1)) @ FRAME.T
    cue = MeasuredNormals(v, some)
    truth = np.linalg.inv(FRAME)
    assert np.abs(cue.residuals(truth)).max() < 1e-14
    assert np.abs(cue.residuals(9 * truth)).max() < 1e-14
    concave = np.diag([-1.0, -1.0, 1.0]) @ truth
    assert np.allclose(cue.residuals(concave).reshape(-1, 3), some * (-2, -2, 0))
    assert np.abs(cue.residuals(bas_relief(0.2, 0, 1) @ truth)).max() > 3 * cue.floor
