"""Normals and light from tracked points."""

import numpy as np
import pytest

from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.moving import fit_tracks
from harmface.moving.shading import NOT_KNOWN, light_turns, shading_basis, turned_light
from harmface.reproduce.films import turns
from harmface.sphere import real_harmonics
from harmface.stereo import angular_errors

TWO_AXES = turns("yaw:-30:30,pitch:-10:10", 20)


def points(rng, count=30):
    normals = rng.standard_normal((count, 3))
    normals[:, 2] = np.abs(normals[:, 2]) + 0.3
    return rng.uniform(0.2, 1, count), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def shown(albedo, normals, lighting, rotations):
    """Brightness by the model's definition: harmonics of the turned normals, no rotated light."""
    from harmface.reflectance import lambert_per_coefficient

    degree = int(np.sqrt(len(lighting))) - 1
    turned = np.einsum("fij,pj->fpi", rotations, normals)
    weights = lighting * lambert_per_coefficient(degree)
    return albedo * np.tensordot(weights, real_harmonics(turned, degree), axes=1)


def errors(found, normals):
    length = np.linalg.norm(found.scaled_normals, axis=1, keepdims=True)
    return angular_errors(found.scaled_normals / length, normals)


@pytest.mark.parametrize("degree", [1, 2])
def test_light_that_is_turned_shows_what_turned_normals_show(degree):
    rng = np.random.default_rng(0)
    albedo, normals = points(rng)
    lighting = rng.standard_normal(harmonic_count(degree))
    model = turned_light(lighting, TWO_AXES) @ shading_basis(albedo[:, None] * normals, degree)[0]
    assert np.allclose(model, shown(albedo, normals, lighting, TWO_AXES), atol=1e-12)


def test_gradient_is_that_of_finite_differences():
    rng = np.random.default_rng(1)
    scaled = rng.standard_normal((20, 3))
    _, slopes = shading_basis(scaled, 2)
    for axis, step in enumerate(1e-6 * np.eye(3)):
        ahead, behind = (shading_basis(scaled + way * step, 2)[0] for way in (1, -1))
        assert np.allclose(slopes[..., axis], (ahead - behind) / 2e-6, atol=1e-7)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_exact_images_of_degree_1_give_exact_normals(seed):
    rng = np.random.default_rng(seed)
    albedo, normals = points(rng)
    lighting = np.array([2.0, *(0.4 * rng.standard_normal(3))])
    images = shown(albedo, normals, lighting, TWO_AXES)
    found = fit_tracks(images, TWO_AXES, max_degree=1, robust=False)
    assert errors(found, normals).max() < 1e-6
    assert found.condition < NOT_KNOWN
    assert not found.ambiguous
    # Albedo and light are known but for one factor.
    ratio = np.linalg.norm(found.scaled_normals, axis=1) / albedo
    assert np.allclose(ratio, ratio[0], rtol=1e-8)
    assert np.allclose(found.lighting * ratio[0], lighting, atol=1e-8)


def test_a_near_start_at_degree_2_gives_exact_normals():
    rng = np.random.default_rng(3)
    albedo, normals = points(rng)
    lighting = np.array([2.0, *(0.4 * rng.standard_normal(8))])
    images = shown(albedo, normals, lighting, TWO_AXES)
    scaled = albedo[:, None] * (normals + 0.02 * rng.standard_normal(normals.shape))
    start = (scaled, lighting + 0.02 * rng.standard_normal(9))
    found = fit_tracks(images, TWO_AXES, robust=False, start=start)
    assert errors(found, normals).max() < 1e-6


def test_normals_look_towards_the_camera():
    rng = np.random.default_rng(4)
    albedo, normals = points(rng)
    lighting = np.array([2.0, 0.3, 0.5, -0.2])
    images = shown(albedo, normals, lighting, TWO_AXES)
    mirrored = (-albedo[:, None] * normals, lighting * [1, -1, -1, -1])
    found = fit_tracks(images, TWO_AXES, max_degree=1, robust=False, start=mirrored)
    assert errors(found, normals).max() < 1e-6


def test_observations_of_no_weight_do_not_vote():
    rng = np.random.default_rng(5)
    albedo, normals = points(rng)
    lighting = np.array([2.0, 0.3, 0.5, -0.2])
    images = shown(albedo, normals, lighting, TWO_AXES)
    spoilt = rng.random(images.shape) < 0.05
    images[spoilt] *= 0.2
    start = (albedo[:, None] * (normals + 0.02 * rng.standard_normal(normals.shape)), lighting)
    found = fit_tracks(images, TWO_AXES, 1.0 * ~spoilt, max_degree=1, start=start)
    assert errors(found, normals).max() < 1e-6


def test_one_axis_leaves_the_condition_number_infinite_or_nearly():
    rng = np.random.default_rng(6)
    albedo, normals = points(rng)
    rotations = turns("yaw:-60:60", 20)
    images = shown(albedo, normals, np.array([2.0, 0.3, 0.5, -0.2]), rotations)
    found = fit_tracks(images, rotations, max_degree=1, robust=False)
    assert np.abs(found.residual).max() < 1e-6
    assert found.ambiguous


def test_matrices_of_turned_light_are_orthogonal():
    matrices = light_turns(TWO_AXES, 2)
    assert np.allclose(matrices @ np.swapaxes(matrices, 1, 2), np.eye(9), atol=1e-12)


def test_nonsense_is_refused():
    still = np.tile(np.eye(3), (10, 1, 1))
    with pytest.raises(ArgumentError, match="rotations must differ"):
        fit_tracks(np.ones((10, 5)), still)
    with pytest.raises(ArgumentError, match="brightness must have shape"):
        fit_tracks(np.ones((9, 5)), still)
    with pytest.raises(ArgumentError, match="weights must have shape"):
        fit_tracks(np.ones((10, 5)), still, np.ones((10, 4)))
    with pytest.raises(ArgumentError, match="at least four frames"):
        fit_tracks(np.ones((10, 5)), still, np.zeros((10, 5)))
    with pytest.raises(ArgumentError, match="max_degree must be 1 or 2"):
        fit_tracks(np.ones((10, 5)), TWO_AXES[:10], max_degree=3)
