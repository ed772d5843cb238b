import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import factorization as module
from harmface.stereo import factorize, factorize_robustly

RNG = np.random.default_rng(5)
LOW_RANK = RNG.standard_normal((20, 5)) @ RNG.standard_normal((5, 300))


def test_agrees_with_the_svd(monkeypatch):
    values = LOW_RANK + 0.1 * RNG.standard_normal(LOW_RANK.shape)
    monkeypatch.setattr(module, "CHUNK", 20 * 37)
    found = factorize(values, 5)
    u, s, vt = np.linalg.svd(values, full_matrices=False)
    # The Gram matrix squares the condition, 30 here.
    assert np.allclose(found.singular_values, s, rtol=1e-10)
    assert np.allclose(found.light @ found.structure, (u[:, :5] * s[:5]) @ vt[:5], atol=1e-10)
    assert np.allclose(found.light.T @ found.light, np.eye(5), atol=1e-12)
    assert np.allclose(found.energy, np.cumsum(s**2) / (s**2).sum(), rtol=1e-10)


def test_finds_rank_and_noise():
    found = factorize(LOW_RANK + 0.05 * RNG.standard_normal(LOW_RANK.shape), 5)
    assert found.rank == 5
    # 15 x 295 degrees of freedom: a relative standard deviation of 1 %.
    assert abs(found.noise / 0.05 - 1) < 0.04


def test_noise_free_rank_is_exact():
    assert factorize(LOW_RANK, 3).rank == 5


@pytest.mark.parametrize(
    ("values", "rank", "message"),
    [
        (LOW_RANK[:4], 5, "at least 5"),
        (LOW_RANK[:, :3], 5, "at least 5"),
        (LOW_RANK * np.nan, 5, "finite"),
        (LOW_RANK, 0, "rank"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(values, rank, message):
    with pytest.raises(ArgumentError, match=message):
        factorize(values, rank)


def test_robust_factors_ignore_outliers():
    values = LOW_RANK + 0.01 * RNG.standard_normal(LOW_RANK.shape)
    wrong = RNG.random(values.shape) < 0.05
    values[wrong] += 5.0
    robust = factorize_robustly(values, 5)
    plain = factorize(values, 5)
    error = np.sqrt(np.mean((robust.light @ robust.structure - LOW_RANK) ** 2))
    # A fit of 5 dimensions keeps about (5 / 20 + 5 / 300) of the noise's energy.
    assert error < 0.01
    assert error < 0.05 * np.sqrt(np.mean((plain.light @ plain.structure - LOW_RANK) ** 2))
    assert robust.weights[wrong].max() < 0.01 < 0.5 < np.median(robust.weights[~wrong])


def test_unusable_observations_do_not_count():
    values = LOW_RANK.copy()
    usable = RNG.random(values.shape) > 0.1
    values[~usable] = 50.0
    robust = factorize_robustly(values, 5, usable)
    assert (robust.weights[~usable] == 0).all()
    assert np.abs(robust.light @ robust.structure - LOW_RANK)[usable].max() < 0.05
