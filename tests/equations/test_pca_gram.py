"""Gram matrices in closed form against adaptive quadrature of harmonics from scipy."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.special import sph_harm_y

from harmface.conventions import angles_from_directions, degrees, directions_from_angles, orders
from harmface.pca import cone_gram, cone_lights, cylinder_gram, front_lights, sphere_gram

DEGREE = 8
EXACT = 1e-12
"""The quadrature's own error bound, far above the rounding of products of degree 16."""


def products(directions: np.ndarray) -> np.ndarray:
    """Y_k Y_k' of scipy's harmonics made real, summed over the directions, (K, K)."""
    polar, azimuth = angles_from_directions(directions)
    order = orders(DEGREE)[:, None]
    values = sph_harm_y(degrees(DEGREE)[:, None], np.abs(order), polar, azimuth)
    # No Condon-Shortley phase; two complex exponentials make one cosine or sine.
    values = values * (-1.0) ** order * np.where(order == 0, 1, np.sqrt(2))
    real = np.where(order < 0, values.imag, values.real)
    return real @ real.T


def integral(of: Callable[[float], np.ndarray], low: float, high: float) -> np.ndarray:
    return quad_vec(of, low, high, epsabs=EXACT / 10, epsrel=0, norm="max")[0]


def over_cap(lowest: float, weight: Callable[[float], float] = lambda z: 1.0) -> np.ndarray:
    """Integrate over the part of the sphere above a height, equal steps in azimuth."""
    azimuth = 2 * np.pi * np.arange(2 * DEGREE + 1) / (2 * DEGREE + 1)

    def ring(z: float) -> np.ndarray:
        around = directions_from_angles(np.arccos(z), azimuth)
        return weight(z) * products(around) * 2 * np.pi / len(azimuth)

    return integral(ring, lowest, 1.0)


@pytest.mark.parametrize(
    ("measure", "expected"),
    [
        ("all", lambda: over_cap(-1.0)),
        ("normals", lambda: over_cap(0.0)),
        ("pixels", lambda: over_cap(0.0, lambda z: z)),
    ],
)
def test_sphere(measure, expected):
    assert np.abs(sphere_gram(DEGREE, measure) - expected()).max() < EXACT


@pytest.mark.parametrize("elevation", [35.0, -70.0])
@pytest.mark.parametrize("measure", ["all", "normals", "pixels"])
def test_cone(measure, elevation):
    expected = over_circle(measure, elevation)
    assert np.abs(cone_gram(DEGREE, measure, elevation) - expected).max() < EXACT


@pytest.mark.parametrize("measure", ["all", "normals", "pixels"])
def test_cylinder(measure):
    assert np.abs(cylinder_gram(DEGREE, measure) - over_circle(measure, 0.0)).max() < EXACT


def over_circle(measure: str, elevation: float) -> np.ndarray:
    """Integrate over normals of one elevation."""
    reach = np.pi if measure == "all" else np.pi / 2
    up, out = np.sin(np.radians(elevation)), np.cos(np.radians(elevation))

    def point(a: float) -> np.ndarray:
        normal = np.array([[out * np.sin(a), up, out * np.cos(a)]])
        return products(normal) * (np.cos(a) if measure == "pixels" else 1.0)

    return integral(point, -reach, reach)


@pytest.mark.parametrize("half_angle", [0.5, 40.0, 130.0])
def test_cone_of_lights_is_the_mean_over_a_cap(half_angle):
    lowest = np.cos(np.radians(half_angle))
    expected = over_cap(lowest) / (2 * np.pi * (1 - lowest))
    light = cone_lights(DEGREE, half_angle)
    # A mean over a small cap divides the error of the integral by its solid angle.
    error = max(EXACT, 1e-15 / (1 - lowest) * len(expected))
    assert np.abs(light.second_moment - expected).max() < error
    # Y_00 is constant, so its column holds the mean.
    assert np.abs(light.mean - expected[:, 0] * np.sqrt(4 * np.pi)).max() < 4 * error


def test_front_lights_are_the_half_sphere():
    half = sphere_gram(DEGREE, "normals") / (2 * np.pi)
    assert np.abs(front_lights(DEGREE).second_moment - half).max() < EXACT
