import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import (
    DistantLight,
    add_lights,
    ambient,
    cone,
    directional_lights,
    disc,
    hemisphere,
)
from harmface.sphere import real_harmonics

EPS = np.finfo(float).eps
AXIS = np.array([0.6, 0.0, 0.8])
DEGREE = 6


def integrated_cap(half_angle, axis):
    """Return the integral of every harmonic over a cap, by Gauss-Legendre and uniform azimuth."""
    nodes, weights = np.polynomial.legendre.leggauss(DEGREE + 1)
    low = np.cos(half_angle)
    height = (1 + low) / 2 + nodes * (1 - low) / 2
    azimuth = 2 * np.pi * np.arange(2 * DEGREE + 1) / (2 * DEGREE + 1)
    side = np.array([axis[2], 0, -axis[0]])
    other = np.cross(axis, side)
    across = np.cos(azimuth)[:, None] * side + np.sin(azimuth)[:, None] * other
    root = np.sqrt((1 - height) * (1 + height))
    directions = height[:, None, None] * axis + root[:, None, None] * across
    weight = weights * (1 - low) / 2 * 2 * np.pi / len(azimuth)
    return np.einsum("khp,h->k", real_harmonics(directions, DEGREE), weight)


@pytest.mark.parametrize("half_angle", [0.01, 0.5, np.pi / 2, 2.5, np.pi])
def test_cones_integrate_harmonics_over_a_cap(half_angle):
    found = cone(AXIS, half_angle, np.array([1.0, 2.0]), DEGREE)
    expected = integrated_cap(half_angle, AXIS)
    # A direction is off by EPS, and harmonics, of at most about 1, change DEGREE times as much.
    atol = 2 * 4 * np.pi * (DEGREE + 1) * EPS
    np.testing.assert_allclose(found, [expected, 2 * expected], atol=atol)


def test_hemisphere_and_ambient_are_wide_cones():
    np.testing.assert_array_equal(hemisphere(AXIS, 3.0, 4), cone(AXIS, np.pi / 2, 3.0, 4))
    np.testing.assert_allclose(ambient(3.0, 4), cone(AXIS, np.pi, 3.0, 4), atol=32 * EPS)
    both = add_lights(hemisphere(AXIS, 1.0, 4), hemisphere(-AXIS, 1.0, 4))
    np.testing.assert_allclose(both, ambient(1.0, 4), atol=32 * EPS)


@pytest.mark.parametrize("radius", [1e-12, 1e-6, 1e-3])
def test_small_discs_keep_their_digits_and_become_directional(radius):
    sun = DistantLight(AXIS[None], np.array([[2.0], [5.0]]))
    found = disc(AXIS, radius, np.array([2.0, 5.0]), DEGREE)
    # Degree l loses l (l + 1) radius**2 / 8 of a point's coefficient.
    error = np.abs(found - directional_lights(sun, DEGREE)).max()
    assert error < 5 * (16 * EPS + DEGREE * (DEGREE + 1) * radius**2 / 4)


def test_discs_give_the_irradiance_asked_for():
    radius = 0.4
    # Radiance E / (pi sin**2) over the cap, summed as a cone.
    expected = cone(AXIS, radius, 7 / (np.pi * np.sin(radius) ** 2), DEGREE)
    np.testing.assert_allclose(disc(AXIS, radius, 7.0, DEGREE), expected, rtol=1e-12, atol=1e-14)


def test_directional_lights_sum_harmonics():
    light = DistantLight(np.stack([AXIS, -AXIS]), np.array([[1.0, 2.0]]))
    values = real_harmonics(light.directions, 3)
    np.testing.assert_allclose(
        directional_lights(light, 3), [values[:, 0] + 2 * values[:, 1]], atol=8 * EPS
    )


def test_lights_of_other_degrees_and_channels_add_up():
    colour = ambient(np.array([1.0, 2.0, 3.0]), 1)
    grey = directional_lights(DistantLight(AXIS[None], np.array([1.0])), 2)
    total = add_lights(colour, grey)
    assert total.shape == (3, 9)
    np.testing.assert_allclose(total[:, 4:], np.tile(grey[4:], (3, 1)))
    np.testing.assert_allclose(total[:, :4], colour + grey[:4])


@pytest.mark.parametrize(
    ("light", "said"),
    [
        (lambda: disc(AXIS, 0.0, 1.0, 2), "angular_radius"),
        (lambda: disc(AXIS, 1.6, 1.0, 2), "angular_radius"),
        (lambda: disc(AXIS, 0.1, -1.0, 2), "irradiance"),
        (lambda: cone(AXIS, np.nan, 1.0, 2), "half_angle"),
        (lambda: cone(AXIS, 3.2, 1.0, 2), "half_angle"),
        (lambda: cone(AXIS, 1.0, np.inf, 2), "radiance"),
        (lambda: cone(2 * AXIS, 1.0, 1.0, 2), "direction"),
        (lambda: cone(AXIS[None], 1.0, 1.0, 2), "direction"),
        (lambda: cone(AXIS, 1.0, 1.0, -1), "max_degree"),
        (lambda: ambient(-1.0, 2), "radiance"),
        (add_lights, "at least one"),
    ],
)
def test_lights_that_make_no_sense_are_refused(unchecked, light, said):
    with pytest.raises(ArgumentError, match=said):
        light()


@pytest.mark.parametrize("angle", [0.3, 1.2, np.pi / 2, 2.0])
def test_the_lowest_degrees_of_a_cone_are_its_closed_forms(angle):
    """Solid angle 2 pi (1 - cos a), and the mean height times it: pi sin(a)**2."""
    first = np.sqrt(1 / (4 * np.pi)) * 2 * np.pi * (1 - np.cos(angle))
    second = np.sqrt(3 / (4 * np.pi)) * np.pi * np.sin(angle) ** 2
    up = np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(cone(up, angle, 1.0, 0), [first], rtol=8 * EPS)
    np.testing.assert_allclose(
        cone(up, angle, 1.0, 1), [first, 0, second, 0], rtol=8 * EPS, atol=8 * EPS
    )
    if angle <= np.pi / 2:
        # A disc gives its irradiance to a surface that faces it: E = pi radiance sin(a)**2.
        radiance = 3.0 / (np.pi * np.sin(angle) ** 2)
        np.testing.assert_allclose(disc(up, angle, 3.0, 0), [radiance * first], rtol=8 * EPS)
        np.testing.assert_allclose(
            disc(up, angle, 3.0, 1), radiance * cone(up, angle, 1.0, 1), rtol=8 * EPS, atol=8 * EPS
        )


def test_a_disc_of_90_degrees_is_a_hemisphere():
    np.testing.assert_allclose(
        disc(AXIS, np.pi / 2, np.pi, DEGREE), hemisphere(AXIS, 1.0, DEGREE), atol=32 * EPS
    )
    with pytest.raises(ArgumentError, match="angular_radius"):
        disc(AXIS, np.nextafter(np.pi / 2, 2), 1.0, 2)
    with pytest.raises(ArgumentError, match="half_angle"):
        cone(AXIS, np.nextafter(np.pi, 4), 1.0, 2)
