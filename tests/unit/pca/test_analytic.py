"""Analytic PCA of an image: pixels, weights, memory, precision, and what is refused."""

import tracemalloc

import numpy as np
import pytest

from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.pca import analytic, analytic_pca, environment_lights, gram, uniform_lights
from harmface.sphere import real_harmonics

DEGREE = 4
ROUNDING = 1e-12
"""Sums over some hundred pixels, divided by eigenvalues a thousandth of the first."""


@pytest.fixture
def normals(rng):
    """A 12 x 9 image whose first row is background."""
    vectors = rng.normal(size=(12, 9, 3))
    vectors[..., 2] = np.abs(vectors[..., 2])
    vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
    vectors[0] = 0
    return vectors


@pytest.fixture
def albedo(rng):
    return rng.uniform(0.1, 0.9, (12, 9))


def test_background_leaves_no_trace(normals, albedo):
    image = analytic_pca(normals, albedo, max_degree=DEGREE)
    rows = analytic_pca(normals[1:], albedo[1:], max_degree=DEGREE)
    assert np.array_equal(image.eigenvalues, rows.eigenvalues)
    assert image.modes(5).shape == (5, 12, 9)
    assert not image.modes(5)[:, 0].any()
    assert not image.weights[0].any()
    assert np.array_equal(image.modes(5)[:, 1:], rows.modes(5))


def test_weight_is_a_number_of_pixels(normals):
    weights = np.zeros((12, 9))
    weights[3], weights[5] = 2.0, 1.0
    weighted = analytic_pca(normals, weights=weights, max_degree=DEGREE)
    repeated = analytic_pca(normals[[3, 3, 5]], max_degree=DEGREE)
    assert np.abs(weighted.eigenvalues - repeated.eigenvalues).max() < ROUNDING


def test_albedo_scales_images(normals):
    full = analytic_pca(normals, max_degree=DEGREE)
    half = analytic_pca(normals, np.full((12, 9), 0.5), max_degree=DEGREE)
    assert np.abs(half.eigenvalues - full.eigenvalues / 4).max() < ROUNDING
    assert np.abs(half.modes(5) - full.modes(5)).max() < ROUNDING


def test_modes_are_orthonormal_and_what_the_expansion_says(normals, albedo):
    pca = analytic_pca(normals, albedo, np.full((12, 9), 0.3), max_degree=DEGREE)
    modes = pca.modes(6)
    products = np.einsum("jhw,khw,hw->jk", modes, modes, pca.weights)
    assert np.abs(products - np.eye(6)).max() < ROUNDING
    harmonics = real_harmonics(normals[1:], DEGREE)
    expected = albedo[1:] * np.tensordot(pca.expansion[:6], harmonics, axes=1)
    assert np.abs(modes[:, 1:] - expected).max() < ROUNDING


def test_chunks_do_not_matter(normals, albedo, monkeypatch):
    whole = analytic_pca(normals, albedo, max_degree=DEGREE)
    modes = whole.modes(5)
    for module in (gram, analytic):
        monkeypatch.setattr(module, "CHUNK", 7)
    parts = analytic_pca(normals, albedo, max_degree=DEGREE)
    assert np.abs(parts.eigenvalues - whole.eigenvalues).max() < ROUNDING
    assert np.abs(np.abs(parts.modes(5)) - np.abs(modes)).max() < ROUNDING


def test_memory_is_a_fraction_of_all_harmonics(rng):
    """The harmonics of all pixels together are never held."""
    pixels, degree = 100_000, 8
    normals = rng.normal(size=(pixels, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tracemalloc.start()
    analytic_pca(normals, max_degree=degree)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < harmonic_count(degree) * normals[:, 0].nbytes / 3


def test_single_precision(normals, albedo):
    double = analytic_pca(normals, albedo, max_degree=DEGREE)
    single = analytic_pca(normals.astype(np.float32), albedo.astype(np.float32), max_degree=DEGREE)
    assert single.modes(5).dtype == np.float32
    assert single.eigenvalues.dtype == np.float64
    # About a hundred products in single precision.
    assert np.abs(single.fractions - double.fractions).max() < 100 * np.finfo(np.float32).eps


@pytest.mark.parametrize(
    ("normal", "albedo", "weight"), [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (0.0, 0.0, 1.0)]
)
def test_nothing_visible(normal, albedo, weight):
    towards = np.tile([0.0, 0.0, normal], (5, 1))
    with pytest.raises(ArgumentError, match="normals must show something"):
        analytic_pca(towards, np.full(5, albedo), np.full(5, weight))


def test_weights_where_nothing_is_seen(normals):
    weights = np.zeros((12, 9))
    weights[0] = 1
    with pytest.raises(ArgumentError, match="normals must show something"):
        analytic_pca(normals, weights=weights)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("weights", np.full((12, 9), -1.0), "weights must not be negative"),
        ("weights", np.zeros((12, 9)), "weights must not be all zero"),
        ("weights", np.full((12, 9), np.nan), "weights must be finite"),
        ("albedo", np.full((12, 9), -0.1), "albedo must not be negative"),
        ("albedo", np.full((12, 9), np.inf), "albedo must be finite"),
        ("light", uniform_lights(2), "degree 4"),
        ("light", environment_lights(np.ones((1, 25))), "none varies"),
        ("max_degree", -1, "must be 0 or more"),
    ],
)
def test_refused(normals, name, value, message):
    with pytest.raises(ArgumentError, match=message):
        analytic_pca(normals, **{"max_degree": DEGREE, name: value})


@pytest.mark.parametrize("bad", [np.nan, 2.0])
def test_normals_are_zero_or_of_unit_length(normals, bad):
    normals[3, 4] = bad
    with pytest.raises(ArgumentError, match="normals must be unit vectors, got 1 of"):
        analytic_pca(normals)


def test_more_modes_than_there_are(normals):
    few = environment_lights(np.eye(25)[:3])
    pca = analytic_pca(normals, light=few, max_degree=DEGREE)
    assert len(pca.modes(2)) == 2
    with pytest.raises(ArgumentError, match="count must be at most 2"):
        pca.modes(3)
    with pytest.raises(ArgumentError, match="count must be 1 or more"):
        pca.modes(0)
