import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import fit_null_cone, lorentz_deviation
from harmface.stereo.lorentz import METRIC, lorentz_transformation

RNG = np.random.default_rng(2)


def test_transformations_keep_the_metric():
    for _ in range(5):
        matrix = lorentz_transformation(RNG.normal(0, 1, 6))
        assert np.allclose(matrix.T @ METRIC @ matrix, METRIC, atol=1e-12)
    assert np.array_equal(lorentz_transformation(np.zeros(6)), np.eye(4))


def test_deviation_tells_other_matrices():
    assert lorentz_deviation(2.5 * lorentz_transformation(RNG.normal(0, 1, 6))) < 1e-12
    assert lorentz_deviation(np.diag([1.0, 1, 1, 1.1])) > 0.01


@pytest.mark.parametrize("seed", range(4))
def test_exact_first_order_structure_comes_back_up_to_lorentz(hills, seed):
    mixing = np.random.default_rng(seed).standard_normal((4, 4))
    cone = fit_null_cone(mixing @ hills.null_vectors)
    recovered = cone.frame @ mixing @ hills.null_vectors
    transformation = hills.null_vectors @ np.linalg.pinv(recovered)
    assert cone.signature_held
    assert cone.residual < 1e-13
    assert lorentz_deviation(transformation) <= 1e-10
    assert (recovered[0] > 0).all()
    assert np.allclose(cone.form, cone.frame.T @ METRIC @ cone.frame)
    assert abs(np.linalg.norm(cone.form) - 1) < 1e-12


def test_a_lost_signature_is_repaired_and_said():
    # On v_0^2 + v_1^2 = v_2^2 + v_3^2 no direction is like a time.
    angles = RNG.uniform(0, 2 * np.pi, (2, 500))
    v = np.stack([np.cos(angles[0]), np.sin(angles[0]), np.cos(angles[1]), np.sin(angles[1])])
    cone = fit_null_cone(v + [[0.5], [0], [0], [0]] * (np.arange(500) < 0))
    assert not cone.signature_held
    assert np.isfinite(cone.frame).all()
    assert (np.linalg.eigvalsh(cone.form) > 0).sum() == 1


def test_rank_three_is_refused(hills):
    structure = hills.null_vectors.copy()
    structure[0] = structure[1] + structure[2]
    with pytest.raises(ArgumentError, match="rank 4"):
        fit_null_cone(structure)
