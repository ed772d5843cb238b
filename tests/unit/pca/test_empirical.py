"""Empirical PCA against the singular value decomposition of the whole stack."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca import attached_shadow_pca, empirical_pca, snapshots
from harmface.rendering import clamped_cosines

ROUNDING = 1e-12
"""Products of some hundred values near 1, over eigenvalues near the first."""


@pytest.fixture(params=[(20, 6, 5), (60, 5, 8)], ids=["fewer images", "fewer pixels"])
def images(request, rng):
    """A stack about a mean, its directions of unlike strength."""
    strengths = np.linspace(3, 1, np.prod(request.param[1:])).reshape(request.param[1:])
    return 5 + rng.normal(size=request.param) * strengths


@pytest.fixture
def weights(rng):
    def of(images):
        values = rng.uniform(0.5, 2.0, images.shape[1:])
        values[0, :2] = 0
        return values

    return of


@pytest.mark.parametrize("subtract_mean", [True, False])
def test_is_the_svd_of_weighted_deviations(images, weights, subtract_mean):
    weights = weights(images)
    pca = empirical_pca(images, weights, 4, subtract_mean)
    origin = images.mean(axis=0) if subtract_mean else np.zeros(images.shape[1:])
    scaled = ((images - origin) * np.sqrt(weights)).reshape(len(images), -1)
    left, values, right = np.linalg.svd(scaled, full_matrices=False)
    variances = values**2 / len(images)
    assert np.abs(pca.eigenvalues - variances[:4]).max() < ROUNDING * variances[0]
    assert np.abs(pca.fractions - variances[:4] / variances.sum()).max() < ROUNDING
    assert abs(pca.cumulative[3] - variances[:4].sum() / variances.sum()) < ROUNDING
    modes = (pca.modes * np.sqrt(weights)).reshape(4, -1)
    assert np.abs(np.abs(modes @ right[:4].T) - np.eye(4)).max() < ROUNDING * 10
    assert np.abs(np.abs(pca.scores) - np.abs(left[:, :4] * values[:4])).max() < ROUNDING * 100
    assert np.abs(pca.scores - scaled @ modes.T).max() < ROUNDING * 100
    assert np.abs(pca.energies - (scaled**2).sum(axis=1)).max() < ROUNDING * 1000
    assert np.abs(pca.origin - origin)[weights > 0].max() < ROUNDING
    assert not pca.modes[:, weights == 0].any()


def test_sign_makes_the_largest_value_positive(images):
    modes = empirical_pca(images, count=4).modes.reshape(4, -1)
    assert (modes.max(axis=1) == np.abs(modes).max(axis=1)).all()


def test_blocks_do_not_matter(images, monkeypatch):
    whole = empirical_pca(images, count=4)
    monkeypatch.setattr(snapshots, "CHUNK", 101)
    parts = empirical_pca(images, count=4)
    assert np.abs(parts.eigenvalues - whole.eigenvalues).max() < ROUNDING * whole.eigenvalues[0]
    assert np.abs(parts.modes - whole.modes).max() < ROUNDING
    assert np.abs(parts.scores - whole.scores).max() < ROUNDING * 100


def test_matrix_has_the_shorter_side(images, monkeypatch):
    sides = []

    def spy(matrix, *rest):
        sides.append(len(matrix))
        return leading(matrix, *rest)

    leading = snapshots._leading
    monkeypatch.setattr(snapshots, "_leading", spy)
    empirical_pca(images, count=4)
    assert sides == [min(len(images), images[0].size)]


def test_stack_on_disk_is_read_and_left_alone(images, tmp_path):
    path = tmp_path / "stack.npy"
    np.save(path, images.astype(np.float32))
    stack = np.load(path, mmap_mode="r")
    pca = empirical_pca(stack, count=4)
    assert pca.modes.dtype == np.float32
    double = empirical_pca(images, count=4)
    # Single precision, on values five times their spread.
    assert np.abs(pca.fractions - double.fractions).max() < 100 * np.finfo(np.float32).eps
    before = images.copy()
    empirical_pca(images, count=4)
    assert np.array_equal(images, before)


def test_repeated_eigenvalues_of_a_large_matrix(monkeypatch):
    """Iteration finds every mode of one share, here the three axes."""
    monkeypatch.setattr(snapshots, "DIRECT", 10)
    strengths = np.where(np.arange(30) < 3, 1.0, 0.5)
    images = np.pad(np.diag(strengths), [(0, 0), (0, 40)])
    pca = empirical_pca(np.concatenate([images, -images]), count=3)
    assert np.abs(pca.eigenvalues - 2 / 60).max() < ROUNDING
    assert np.abs(np.abs(pca.modes[:, :3]).max(axis=1)).min() > 0.5
    assert np.abs(pca.modes[:, 3:]).max() < 1e-8


def test_attached_shadows_are_those_of_the_stack(rng):
    normals = rng.normal(size=(6, 7, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals[2] = 0
    directions = rng.normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    albedo, weights = rng.uniform(0.2, 1, (6, 7)), rng.uniform(0.5, 1, (6, 7))
    direct = attached_shadow_pca(normals, directions, albedo, weights, 5)
    weights[2] = 0
    stack = empirical_pca(albedo * clamped_cosines(normals, directions), weights, 5)
    assert np.abs(direct.eigenvalues - stack.eigenvalues).max() < ROUNDING
    assert np.abs(direct.modes - stack.modes).max() < ROUNDING
    assert np.abs(direct.scores - stack.scores).max() < ROUNDING
    assert np.array_equal(direct.weights, weights)


def test_attached_shadows_in_single_precision(rng):
    normals = np.tile(np.eye(3), (4, 1))
    directions = rng.normal(size=(30, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    pca = attached_shadow_pca(normals.astype(np.float32), directions, count=2)
    assert pca.modes.dtype == np.float32


def test_too_few_images_or_pixels(images):
    with pytest.raises(ArgumentError, match="count must be at most 3 with 4 images"):
        empirical_pca(images[:4], count=4)
    assert len(empirical_pca(images[:4], count=4, subtract_mean=False).modes) == 4
    with pytest.raises(ArgumentError, match="of 5 pixels"):
        empirical_pca(images[:, 0, :5], count=6)
    with pytest.raises(ArgumentError, match="count must be 1 or more"):
        empirical_pca(images, count=0)


def test_too_few_lights():
    normals = np.tile([0.0, 0.6, 0.8], (20, 1))
    with pytest.raises(ArgumentError, match="count must be at most 2 with 3 images"):
        attached_shadow_pca(normals, np.eye(3), count=5)


def test_images_of_fewer_dimensions(images):
    flat = images[:, :1, :1] * np.linspace(1, 2, 40).reshape(5, 8)
    with pytest.raises(ArgumentError, match="count must be at most 1, as many dimensions"):
        empirical_pca(flat, count=2)


@pytest.mark.parametrize("value", [0.1, 0.0])
@pytest.mark.parametrize("pixels", [3, 40])
def test_images_that_are_all_the_same(value, pixels):
    with pytest.raises(ArgumentError, match="images must differ"):
        empirical_pca(np.full((7, pixels), value), count=1)


def test_black_images_about_black():
    with pytest.raises(ArgumentError, match="images must differ"):
        empirical_pca(np.zeros((7, 9)), count=1, subtract_mean=False)


@pytest.mark.parametrize(
    ("weight", "message"),
    [(-1.0, "must not be negative"), (0.0, "must not be all zero"), (np.nan, "must be finite")],
)
def test_no_weights(images, weight, message):
    with pytest.raises(ArgumentError, match=f"weights {message}"):
        empirical_pca(images, np.full(images.shape[1:], weight))


def test_images_are_finite(images):
    images[3, 2, 1] = np.nan
    with pytest.raises(ArgumentError, match="images must be finite"):
        empirical_pca(images)


def test_directions_are_unit_vectors():
    with pytest.raises(ArgumentError, match="directions must be unit"):
        attached_shadow_pca(np.eye(3), 2 * np.eye(3), count=1)


def test_nothing_visible():
    with pytest.raises(ArgumentError, match="normals must show something"):
        attached_shadow_pca(np.zeros((4, 3)), np.eye(3), count=1)
