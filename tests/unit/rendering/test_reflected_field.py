"""Glossy maps and reflected fields against sums over directions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.light import EnvironmentMap, layout_named
from harmface.reflectance import GGX, Lambert, Mirror, Mixture, OrenNayar, Phong
from harmface.rendering import ReflectedField, clamped_cosines, reflection_map
from harmface.rendering.reference import shown_by
from harmface.sphere import (
    frames_facing,
    gauss_legendre,
    in_frames,
    mixed_functions,
    random_directions,
    synthesize,
)

RULE = gauss_legendre(200)
UP = np.array([0.0, 0.0, 1.0])


def band_limited(degree, rng):
    light = rng.standard_normal((degree + 1) ** 2) / (1 + degrees(degree))
    light[0] = 6
    return light


def summed(material, radiance, directions, weights, normals, towards):
    pairs = shown_by(material, normals, towards, directions, clamped_cosines(normals, directions))
    return (radiance * weights) @ pairs / np.pi


def seen_normals(count, rng):
    normals = random_directions(count, rng)
    normals = normals[normals[:, 2] > 0.05]
    return normals, np.broadcast_to(UP, normals.shape)


def sky(height, rng):
    """Return a smooth map that is above 0 everywhere."""
    light = band_limited(6, rng)
    values = synthesize(light, layout_named("latlong").directions(height))
    assert values.min() > 0
    return EnvironmentMap(values, layout_named("latlong"))


def test_functions_in_frames_are_those_of_turned_directions(rng):
    frames = Rotation.random(20, rng=rng).as_matrix()
    frames[0] = np.eye(3)
    frames[1] = np.diag([1.0, -1.0, -1.0])
    frames[2] = frames[1] @ Rotation.from_euler("z", 1.0).as_matrix()
    coefficients, directions = rng.standard_normal((2, 49)), random_directions(5, 1)
    found = synthesize(in_frames(coefficients, frames), directions)
    expected = synthesize(coefficients, np.einsum("pij,wj->pwi", frames, directions))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_frames_face_the_viewer():
    normals, towards = random_directions(50, 0), random_directions(50, 1)
    towards[0] = normals[0]
    frames = frames_facing(normals, towards)
    np.testing.assert_allclose(np.linalg.det(frames), 1)
    np.testing.assert_allclose(frames[..., 2], normals)
    local = np.einsum("pij,pi->pj", frames, towards)
    assert np.abs(local[:, 1]).max() < 1e-12
    assert local[:, 0].min() > -1e-12


def test_the_field_is_a_sum_of_mixed_functions(rng):
    normals, towards = seen_normals(40, rng)
    rho = Phong(5).coefficients(3, 4)
    light = band_limited(3, rng)
    field = ReflectedField(light, rho)
    frames = frames_facing(normals, towards)
    local = np.einsum("pij,pi->pj", frames, towards)
    functions = mixed_functions(frames, local, 3, 4)
    p, q = np.indices(rho.shape[1:])
    even = 2 * rho * ((p + q) % 2 == 0)
    expected = np.einsum("k,kpq,kpqn->n", light, even[degrees(3)], functions)
    np.testing.assert_allclose(field.radiance(normals, towards), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("material", "degree", "largest"),
    # Matte: one degree p is exact. The rest tells how fast the series in p converges.
    [(Lambert(), 2, 1e-3), (OrenNayar(0.5), 32, 1e-3), (Phong(20), 24, 5e-3), (GGX(0.4), 24, 2e-2)],
    ids=str,
)
def test_the_field_is_the_sum_over_directions(material, degree, largest, rng):
    normals, towards = seen_normals(150, rng)
    light = band_limited(6, rng)
    expected = summed(
        material,
        synthesize(light, RULE.directions),
        RULE.directions,
        RULE.weights,
        normals,
        towards,
    )
    field = ReflectedField(light, material.coefficients(6, degree, tolerance=3e-3))
    error = field.radiance(normals, towards) - expected
    assert np.abs(error).max() < largest * expected.max()


@pytest.mark.parametrize(
    ("material", "accuracy"), [(Phong(10), 0.02), (GGX(0.5), 0.02), (OrenNayar(0.5), 0.005)]
)
def test_a_field_has_the_accuracy_that_was_asked_for(material, accuracy, rng):
    environment = sky(64, rng)
    field = ReflectedField.of(environment, material, accuracy)
    normals, towards = random_directions(400, 2), random_directions(400, 3)
    seen = (normals * towards).sum(axis=1) > 0
    normals, towards = normals[seen], towards[seen]
    directions = environment.directions.reshape(-1, 3)
    expected = summed(
        material,
        environment.radiance.ravel(),
        directions,
        environment.solid_angles.ravel(),
        normals,
        towards,
    )
    error = field.radiance(normals, towards) - expected
    assert np.sqrt(np.mean(error**2)) < accuracy * np.sqrt(np.mean(expected**2))


def test_behind_the_surface_is_dark():
    field = ReflectedField(np.array([3.5]), Lambert().coefficients(0, 0))
    normals = np.array([UP, -UP])
    found = field.radiance(normals, np.array([UP, UP]))
    np.testing.assert_allclose(found, [3.5 / np.sqrt(4 * np.pi), 0], rtol=1e-6)


@pytest.mark.parametrize("exponent", [1, 20, 50])
def test_a_prefiltered_map_is_the_lobe_summed_over_the_map(exponent, rng):
    environment = sky(96, rng)
    found = reflection_map(environment, Phong(exponent), 8)
    mirrored = layout_named("latlong").directions(8)
    lobe = np.maximum(mirrored @ environment.directions.reshape(-1, 3).T, 0) ** exponent
    power = (environment.radiance * environment.solid_angles).ravel()
    expected = (exponent + 1) / (2 * np.pi) * lobe @ power
    assert np.abs(found - expected).max() < 1e-3 * expected.max()


def test_a_mirror_shows_the_map(rng):
    environment = sky(32, rng)
    found = reflection_map(environment, Mirror(0.5), 32)
    np.testing.assert_allclose(found, environment.radiance / 2, rtol=1e-12)


def test_colours_scale_channels(rng):
    grey = sky(32, rng)
    colour = EnvironmentMap(np.stack([grey.radiance] * 3), grey.layout)
    scales = np.array([1.0, 0.5, 0.1])
    found = reflection_map(colour, Mixture((Phong(5),), (scales,)), 8)
    alone = reflection_map(grey, Phong(5), 8)
    np.testing.assert_allclose(found, scales[:, None, None] * alone, atol=1e-12)
    with pytest.raises(ArgumentError, match="needs a map with as many"):
        reflection_map(grey, Mixture((Phong(5),), (scales,)), 8)


def test_fields_of_other_shapes_are_refused(rng):
    with pytest.raises(ArgumentError, match="L degrees as light"):
        ReflectedField(np.ones(9), np.ones((2, 2, 2)))
    with pytest.raises(ArgumentError, match="accuracy must lie"):
        ReflectedField.of(sky(32, rng), Lambert(), 0.0)
    with pytest.raises(ArgumentError, match="takes more than degree"):
        ReflectedField.of(sky(64, rng), Phong(200), 1e-3)
    with pytest.raises(ArgumentError, match="must be rotations"):
        in_frames(np.ones(4), -np.eye(3)[None])
