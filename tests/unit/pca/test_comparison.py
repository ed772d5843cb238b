"""Theory beside images: known angles, the bootstrap done the long way, what is refused."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca import (
    AnalyticPCA,
    EmpiricalPCA,
    analytic_pca,
    attached_shadow_pca,
    bootstrap_interval,
    compare,
    comparison,
    empirical_pca,
)
from harmface.sphere import fibonacci_directions


@pytest.fixture(scope="module")
def normals():
    directions = fibonacci_directions(300)
    return directions[directions[:, 2] > 0.1]


def components(modes: np.ndarray) -> EmpiricalPCA:
    count, pixels = modes.shape
    scores = np.random.default_rng(3).normal(size=(50, count))
    energies = (scores**2).sum(axis=1)
    variances = np.square(scores).mean(axis=0)
    return EmpiricalPCA(
        variances, modes, np.zeros(pixels), scores, energies, np.ones(pixels), False
    )


@pytest.mark.parametrize("least", [1.0, 0.01])
def test_angles_and_correlations_of_turned_modes(normals, least):
    """The second mode is turned by 30 degrees out of the span, the first changes its sign."""
    theory = analytic_pca(normals, weights=np.linspace(least, 1, len(normals)), max_degree=4)
    first, second, outside = theory.modes(3)
    turned = np.cos(np.pi / 6) * second + np.sin(np.pi / 6) * outside
    result = compare(theory, components(np.stack([-first, turned])), 2)
    assert np.abs(result.principal_angles - [30, 0]).max() < 1e-10
    assert np.abs(result.correlations - [-1, np.sqrt(3) / 2]).max() < 1e-12


def test_theory_is_what_images_show(normals):
    theory = analytic_pca(normals)
    images = attached_shadow_pca(normals, fibonacci_directions(1000))
    result = compare(theory, images)
    assert np.abs(result.analytic - result.empirical).max() < 1e-3
    assert result.principal_angles.shape == (5,)
    assert result.principal_angles[0] < 1
    assert (result.interval[0] < result.empirical).all()
    assert (result.interval[1] > result.empirical).all()


@pytest.mark.parametrize("subtract_mean", [True, False])
def test_bootstrap_is_the_decomposition_of_every_sample(monkeypatch, rng, subtract_mean):
    monkeypatch.setattr(comparison, "RESAMPLES", 8)
    images = 1 + rng.normal(size=(30, 4)) * [3, 2, 1, 0.5]
    pca = empirical_pca(images, count=4, subtract_mean=subtract_mean)
    draws = np.random.default_rng(5).multinomial(30, np.full(30, 1 / 30), 8)
    samples = [
        empirical_pca(np.repeat(images, times, axis=0), None, 4, subtract_mean).fractions
        for times in draws
    ]
    expected = np.quantile(samples, [0.25, 0.75], axis=0)
    assert np.abs(bootstrap_interval(pca, rng=5, level=0.5) - expected).max() < 1e-12


def test_same_seed_same_interval(normals):
    images = attached_shadow_pca(normals, fibonacci_directions(200), count=5)
    first, again, other = (bootstrap_interval(images, seed) for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_other_pixels(normals):
    theory = analytic_pca(normals[:-1], max_degree=2)
    with pytest.raises(ArgumentError, match="empirical must have the analytic pixels"):
        compare(theory, attached_shadow_pca(normals, fibonacci_directions(50)))


def test_fewer_modes_than_compared(normals):
    images = attached_shadow_pca(normals, fibonacci_directions(50), count=3)
    theory = analytic_pca(normals, max_degree=2)
    with pytest.raises(ArgumentError, match="empirical must have 4 modes, got 3"):
        compare(theory, images, 4)
    one = AnalyticPCA(
        theory.eigenvalues, theory.expansion[:1], normals, theory.albedo, theory.weights
    )
    with pytest.raises(ArgumentError, match="count must be at most 1"):
        compare(one, images, 2)
    with pytest.raises(ArgumentError, match="count must be 1 or more"):
        compare(theory, images, 0)


@pytest.mark.parametrize("level", [0.0, 1.0, np.nan])
def test_no_level(normals, level):
    images = attached_shadow_pca(normals, fibonacci_directions(50), count=2)
    with pytest.raises(ArgumentError, match="level must lie"):
        bootstrap_interval(images, level=level)
