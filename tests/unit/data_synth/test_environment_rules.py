"""Quadrature rules against integrals known in closed form."""

import numpy as np
import pytest

from data_synth.environments.rules import panels, sky_rule, sphere_rule, wall_rule

EPS = np.finfo(float).eps


def test_panels_integrate_piecewise_polynomials_exactly() -> None:
    x, w = panels(np.array([2.0, 0.0, 1.0, 1.0]), 3)
    assert len(x) == 6
    # Three nodes: degree 5, here of a function with a jump at 1.
    f = np.where(x < 1, x**5, 3.0)
    assert abs(w @ f - (1 / 6 + 3)) < 20 * EPS


def test_sphere_rule_is_exact_to_its_degree() -> None:
    directions, weights = sphere_rule(4)
    x, y, z = directions.T
    assert abs(weights.sum() - 4 * np.pi) < 50 * EPS
    # Degree 6 and, for the azimuths, order 7: moments of the sphere, odd ones vanish.
    assert abs(weights @ (x**2 * y**2 * z**2) - 4 * np.pi / 105) < 50 * EPS
    assert abs(weights @ (x**7)) < 50 * EPS
    assert abs(weights @ z**8 - 4 * np.pi / 9) > 1e-3


@pytest.mark.parametrize("altitude", [90.0, 60.0, 10.0, 0.5])
def test_sky_rule_integrates_across_the_horizon(altitude: float) -> None:
    a = np.radians(altitude)
    pole = np.array([0.6 * np.cos(a), np.sin(a), 0.8 * np.cos(a)])
    directions, weights = sky_rule(pole, (), 24)
    up = np.maximum(directions[:, 1], 0)
    assert (weights > 0).all()
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, atol=8 * EPS)
    np.testing.assert_allclose(weights.sum(), 4 * np.pi, rtol=1e-12)
    # Of a jump, a kink and a parabola at the horizon, over the upper hemisphere.
    np.testing.assert_allclose(
        [weights @ (up > 0), weights @ up, weights @ up**2],
        [2 * np.pi, np.pi, 2 * np.pi / 3],
        rtol=1e-8,
    )


def test_sky_rule_resolves_rings_around_its_pole() -> None:
    pole = np.array([0.0, np.sin(0.7), np.cos(0.7)])
    directions, weights = sky_rule(pole, (0.01,), 12)
    inside = np.linalg.norm(directions - pole, axis=1) < 2 * np.sin(0.005)
    np.testing.assert_allclose(weights[inside].sum(), 2 * np.pi * (1 - np.cos(0.01)), rtol=1e-10)


def test_wall_rule_gives_the_solid_angle_of_a_rectangle() -> None:
    # A rectangle with a corner over the foot point: arctan(s t / (d sqrt(d^2 + s^2 + t^2))).
    _, _, solid_angles = wall_rule(np.array([0.0, 0.5, 1.0]), np.array([0.0, 1.0, 2.0]), 1.5, 12)
    exact = np.arctan(2.0 / (1.5 * np.sqrt(1.5**2 + 1 + 4)))
    np.testing.assert_allclose(solid_angles.sum(), exact, rtol=1e-12)
