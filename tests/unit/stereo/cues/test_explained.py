from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from harmface.stereo.cues import Explained, structure_field
from harmface.stereo.homogeneous import scaled_normal_images


def seen(shape, mixing):
    structure = scaled_normal_images(shape.normals, 2).T @ mixing.T
    one = np.ones(len(structure))
    return structure_field(structure, shape.mask, one, one)


def test_harmonics_of_the_scaled_normals_span_the_structure(egg, rng):
    mixing = rng.standard_normal((9, 9))
    cue = Explained.of(seen(egg, mixing))
    # b is linear in its own nine images.
    harmonics = scaled_normal_images(egg.normals, 2).T
    truth = np.linalg.lstsq(harmonics @ mixing.T, egg.normals, rcond=None)[0].T
    condition = np.linalg.cond(mixing)
    assert np.abs(cue.residuals(truth)).max() < 1e-12 * condition
    # So do those of turned normals.
    turn = Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix()
    assert np.abs(cue.residuals(turn @ truth)).max() < 1e-12 * condition
    wrong = truth + np.abs(truth).mean() * rng.standard_normal(truth.shape)
    assert np.median(cue.residuals(wrong)) > cue.floor


def test_residuals_are_shares_of_the_structure(egg, rng):
    mixing = rng.standard_normal((9, 9))
    field = seen(egg, mixing)
    rows = rng.standard_normal((3, 9))
    found = Explained.of(field).residuals(rows)
    assert np.sqrt(np.mean(found**2)) < 1
    brighter = replace(field, structure=4 * field.structure)
    assert np.allclose(Explained.of(brighter).residuals(rows), found, atol=1e-9)


def test_dark_pixels_are_left_out(egg, rng):
    field = seen(egg, np.eye(9))
    structure = field.structure.copy()
    structure[::2] = 0
    cue = Explained.of(replace(field, structure=structure))
    assert np.allclose(np.linalg.norm(cue.v, axis=1), 1)
    assert np.isfinite(cue.residuals(rng.standard_normal((3, 9)))).all()
