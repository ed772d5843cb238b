import numpy as np
import pytest

from data_synth.environments import ENVIRONMENTS, quadrature
from data_synth.shapes import ellipsoid
from harmface.conventions import luminance
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.reflectance import truncation_error
from harmface.rendering import harmonic_images, outgoing_radiance, relight, render
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import random_directions, real_harmonics

MESH = mesh_of(ellipsoid())
VIEW = gbuffer(MESH, frame_orthographic(MESH, 48))
ALBEDO = luminance(VIEW.albedo)


def coefficients(light, degree):
    return light.irradiances @ real_harmonics(light.directions, degree).T


def test_images_of_a_convex_body_stay_within_the_bound_and_improve_with_degree(rng):
    light = DistantLight(random_directions(5, rng), rng.random(5))
    truth = render(VIEW, light)
    total = light.irradiances.sum()
    errors = []
    for degree in (0, 1, 2, 4, 6, 8):
        images = harmonic_images(VIEW.normals, ALBEDO, degree)
        error = np.abs(relight(coefficients(light, degree), images) - truth).max()
        # Irradiance errs by at most the truncation error of each light, scaled by albedo.
        assert error <= truncation_error(degree) * total * ALBEDO.max() * (1 + 1e-9)
        errors.append(error)
    assert errors == sorted(errors, reverse=True)


def test_smooth_light_is_rendered_within_a_percent():
    environment = ENVIRONMENTS["overcast_sky"]()
    directions, solid_angles = quadrature(environment)
    radiance = environment.radiance(directions).T
    light = DistantLight(directions, radiance * solid_angles)
    images = harmonic_images(VIEW.normals, ALBEDO, 2)
    truth = render(VIEW, light, albedo=ALBEDO)
    error = np.abs(relight(coefficients(light, 2), images) - truth)
    assert error.mean() < 0.01 * truth.max()


def test_relighting_is_a_matrix_product(rng):
    images = harmonic_images(random_directions(6, rng).reshape(2, 3, 3), rng.random((2, 3)), 2)
    lighting = rng.random((4, 3, 9))
    expected = lighting.reshape(12, 9) @ images.reshape(9, 6)
    assert np.allclose(relight(lighting, images), expected.reshape(4, 3, 2, 3))


def test_precision_is_kept(rng):
    normals = random_directions(4, rng).astype(np.float32)
    assert harmonic_images(normals, np.ones(4, np.float32)).dtype == np.float32
    assert harmonic_images(normals.astype(float), np.ones(4)).dtype == np.float64


def test_the_background_needs_no_normal():
    images = harmonic_images(np.array([[0.0, 0, 0], [0, 0, 1]]), np.array([0.0, 1.0]))
    assert not images[:, 0].any()
    assert np.allclose(images[0, 1], np.pi * real_harmonics(np.array([0.0, 0, 1]), 0)[0])


@pytest.mark.parametrize(
    ("normals", "albedo", "degree", "message"),
    [
        (np.zeros((1, 3)), np.ones(1), 2, "unit vectors"),
        (np.array([[0, 0, np.nan]]), np.ones(1), 2, "unit vectors"),
        (np.array([[0, 0, 1.0]]), -np.ones(1), 2, "negative"),
        (np.array([[0, 0, 1.0]]), np.full(1, np.nan), 2, "finite"),
        (np.array([[0, 0, 1.0]]), np.ones(1), -1, "0 or more"),
    ],
)
def test_nonsense_is_refused(normals, albedo, degree, message):
    with pytest.raises(ArgumentError, match=message):
        harmonic_images(normals, albedo, degree)


@pytest.mark.usefixtures("unchecked")
def test_lighting_of_another_length_is_refused():
    with pytest.raises(ArgumentError, match="9 coefficients"):
        relight(np.ones(4), np.ones((9, 2)))


def test_outgoing_radiance_is_radiosity_over_pi():
    assert outgoing_radiance(np.array([np.pi]))[0] == 1
