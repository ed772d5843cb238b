import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.rendering import harmonic_images
from harmface.stereo import (
    angular_errors,
    normals_from_coefficients,
    normals_from_directions,
    point_source_structure,
    without_rotation,
)


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def test_directions_without_shadow_are_exact(hills, single_lights):
    images = hills.images(single_lights, np.eye(len(single_lights)))
    b = normals_from_directions(images, single_lights, usable=images > 0)
    assert np.allclose(b, hills.b, atol=1e-12)


def test_robust_fit_withstands_highlights_and_cast_shadows(hills, single_lights, rng):
    images = hills.images(single_lights, np.eye(len(single_lights)))
    usable = images > 0
    images = np.abs(images + 0.005 * rng.standard_normal(images.shape))
    draw = rng.random(images.shape)
    images[draw < 0.05] += 1.0
    images[draw > 0.95] *= 0.1
    robust = normals_from_directions(images, single_lights, usable=usable, robust=True)
    plain = normals_from_directions(images, single_lights, usable=usable)
    error = angular_errors(unit(robust), hills.normals).mean()
    # 0.5 % of noise on albedo 0.6 over some 20 images: 0.0083 / sqrt(20 / 3) rad = 0.2 degrees.
    assert error < 0.6
    assert error < 0.1 * angular_errors(unit(plain), hills.normals).mean()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda light: light[:-1], "row for each of the 24 images"),
        (lambda light: light * (1, 1, 0), "span three dimensions"),
        (lambda light: light * np.nan, "finite"),
        (lambda light: light[:, :2], r"shape \(..., 3\)"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(hills, single_lights, change, message):
    images = hills.images(single_lights, np.eye(24))
    with pytest.raises(ArgumentError, match=message):
        normals_from_directions(images, change(single_lights))


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_harmonic_light_is_exact(hills, rng, degree):
    light = rng.standard_normal((30, (degree + 1) ** 2))
    light[:, 0] += 5
    light[:, 4:] *= 0.3
    images = light @ harmonic_images(hills.normals, hills.albedo, degree)
    b = normals_from_coefficients(images, light)
    assert angular_errors(unit(b), hills.normals).max() < 1e-4
    assert np.allclose(np.linalg.norm(b, axis=1), hills.albedo, rtol=1e-6)


@pytest.mark.usefixtures("unchecked")
def test_coefficients_must_match_the_images(hills):
    with pytest.raises(ArgumentError, match="row for each of the 5 images"):
        normals_from_coefficients(np.ones((5, 1600)), np.ones((4, 9)))


def test_equal_point_sources_leave_a_rotation(hills, single_lights):
    images = hills.images(single_lights, np.eye(24))
    b = point_source_structure(images, images > 0)
    turned = without_rotation(unit(b), hills.normals)
    # The robust loop ends at a relative change of 1e-4 in energy.
    assert angular_errors(turned, hills.normals).mean() < 0.1


def test_point_sources_need_six_images(hills, single_lights):
    images = hills.images(single_lights[:5], np.eye(5))
    with pytest.raises(ArgumentError, match="at least 6"):
        point_source_structure(images)


def test_sources_of_no_common_strength_are_refused(hills, rng):
    light = np.exp(rng.normal(0, 3, (24, 1))) * np.eye(3)[np.arange(24) % 3]
    light[:, 2] += 1e-3
    values = np.abs(light @ hills.b.T)
    with pytest.raises(ArgumentError, match="equal strength"):
        point_source_structure(values)
