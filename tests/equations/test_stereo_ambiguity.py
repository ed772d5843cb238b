"""What images of a diffuse object leave open, whatever the method."""

import numpy as np
import pytest

from harmface.rendering import clamped_cosines
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.lorentz import lorentz_transformation

RNG = np.random.default_rng(6)
B = RNG.standard_normal((300, 3)) * RNG.uniform(0.3, 1, (300, 1))


def outside(images, space):
    """Return the share of images that lies outside a space."""
    basis = np.linalg.qr(space.T)[0]
    return np.linalg.norm(images - (images @ basis) @ basis.T) / np.linalg.norm(images)


def moved(degree):
    """Return b'' = (s'_0 / s_0)^(d - 1) s' and the same without its change of albedo."""
    null = np.concatenate([np.linalg.norm(B, axis=1)[None], B.T])
    image = lorentz_transformation(np.array([0.4, -0.3, 0.5, 1.0, 0.2, -0.7])) @ null
    ratio = image[0] / null[0]
    return (ratio ** (degree - 1) * image[1:]).T, (image[1:] / ratio).T


@pytest.mark.parametrize("degree", [1, 2])
def test_harmonic_images_allow_a_lorentz_transformation(degree):
    other, of_same_albedo = moved(degree)
    space = scaled_normal_images(B, degree)
    assert outside(scaled_normal_images(other, degree), space) < 1e-12
    assert outside(scaled_normal_images(of_same_albedo, degree), space) > 1e-2


def test_degree_four_forbids_it():
    # Lambert's law has no degree 3, which the products of four null vectors need.
    other, _ = moved(4)
    assert outside(scaled_normal_images(other, 4), scaled_normal_images(B, 4)) > 1e-2


def test_distant_light_allows_any_linear_map():
    directions = RNG.standard_normal((20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    matrix = RNG.standard_normal((3, 3))
    images = clamped_cosines(B, directions)
    moved = directions @ np.linalg.inv(matrix)
    strength = np.linalg.norm(moved, axis=1, keepdims=True)
    assert np.allclose(strength * clamped_cosines(B @ matrix.T, moved / strength), images)
