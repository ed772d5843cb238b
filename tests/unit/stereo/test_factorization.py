import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import factorization as module
from harmface.stereo import factorize, factorize_robustly
from harmface.stereo.robust import point_source_weights

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


@pytest.mark.parametrize("many", [1, 2**60])
def test_single_precision_is_kept_and_leaves_no_more_than_it_must(monkeypatch, rng, many):
    monkeypatch.setattr(module, "MANY", many)
    rows = rng.standard_normal((40, 9)) * np.geomspace(1, 0.02, 9)
    values = rows @ rng.standard_normal((9, 20_000)) + 3e-3 * rng.standard_normal((40, 20_000))
    found = factorize(values.astype(np.float32), 9)
    assert found.light.dtype == found.structure.dtype == np.float32
    singular = np.linalg.svd(values, compute_uv=False)
    # Images in single precision are off by eps / 4 or so, each by itself; their products by what
    # `gram_matrix` says.
    error = np.abs(found.singular_values**2 - singular**2).max() / singular[0] ** 2
    assert error < (np.finfo(np.float32).eps / np.sqrt(20_000 / 1024) if many == 1 else 1e-10)
    assert found.rank == 9
    left = np.linalg.norm(values - found.light.astype(float) @ found.structure)
    assert left < 1.0001 * np.linalg.norm(singular[9:])


@pytest.mark.parametrize("many", [1, 2**60])
def test_rank_of_noise_free_images_is_not_that_of_rounding(monkeypatch, rng, many):
    monkeypatch.setattr(module, "MANY", many)
    values = rng.standard_normal((20, 5)) @ rng.standard_normal((5, 20_000))
    assert factorize(values.astype(np.float32), 5).rank == 5


def test_finds_rank_and_noise():
    found = factorize(LOW_RANK + 0.05 * RNG.standard_normal(LOW_RANK.shape), 5)
    assert found.rank == 5
    # 15 x 295 degrees of freedom: a relative standard deviation of 1 %.
    assert abs(found.noise / 0.05 - 1) < 0.04


def test_noise_free_rank_is_exact(monkeypatch, rng):
    # Also where single precision would be given up: a dimension 1e-5 of the others counts.
    monkeypatch.setattr(module, "MANY", 1)
    faint = 1e-5 * rng.standard_normal((20, 1)) * rng.standard_normal((1, 300))
    assert factorize(LOW_RANK, 3).rank == 5
    assert factorize(LOW_RANK + faint, 3).rank == 6


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


def test_brightness_beyond_the_prediction_counts_less_than_darkness():
    predicted = np.ones((4, 500))
    values = predicted + 0.01 * RNG.standard_normal(predicted.shape)
    values[0, :3] = 1 + np.array([0.05, -0.05, 0.0])
    lit = np.ones(values.shape, bool)
    lit[3] = False
    weights = point_source_weights(values, predicted, lit)
    assert weights[0, 2] == 1
    assert weights[0, 0] < weights[0, 1] / 3
    assert (weights[3] == 0).all()


def test_rounding_is_no_noise():
    predicted = RNG.random((4, 500))
    values = predicted * (1 + 1e-15 * RNG.standard_normal(predicted.shape))
    weights = point_source_weights(values, predicted, np.ones(values.shape, bool))
    assert weights.min() > 0.999
