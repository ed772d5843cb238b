"""Moments of the light: against samples and quadrature, and what is refused."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca import (
    LightDistribution,
    cone_lights,
    directional_lights,
    environment_lights,
    isotropic_lights,
    uniform_lights,
)
from harmface.sphere import gauss_legendre, real_harmonics

DEGREE = 4
ROUNDING = 1e-14
"""Sums of numbers below 1 over 25 coefficients."""


def test_uniform_lights_have_the_identity_over_4_pi():
    light = uniform_lights(DEGREE)
    assert np.abs(light.second_moment - np.eye(25) / (4 * np.pi)).max() < ROUNDING
    assert light.max_degree == DEGREE
    around = gauss_legendre(2 * DEGREE)
    sampled = directional_lights(DEGREE, around.directions, around.weights)
    assert np.abs(light.covariance - sampled.covariance).max() < ROUNDING
    assert np.abs(light.mean - sampled.mean).max() < ROUNDING


def test_widest_cone_is_the_sphere():
    cone = cone_lights(DEGREE, 180.0, np.array([0.6, 0.0, -0.8]))
    assert np.abs(cone.covariance - uniform_lights(DEGREE).covariance).max() < ROUNDING


def test_narrow_cone_points_along_its_axis():
    axis = np.array([0.48, -0.6, 0.64])
    cone = cone_lights(DEGREE, 0.01, axis)
    # Harmonics of degree l turn by at most l half angles.
    assert np.abs(cone.mean - real_harmonics(axis, DEGREE)).max() < DEGREE * np.radians(0.01)
    # To first order x and y of the cap vary by half_angle^2 / 4, the other terms are its square.
    assert (
        abs(cone.covariance[3, 3] / (3 / (4 * np.pi)) / np.radians(0.01) ** 2 * 4 - (1 - 0.48**2))
        < 1e-6
    )


def test_weights_count_directions(rng):
    directions = rng.normal(size=(3, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    weighted = directional_lights(DEGREE, directions, np.array([2.0, 1.0, 3.0]))
    repeated = directional_lights(DEGREE, np.repeat(directions, [2, 1, 3], axis=0))
    assert np.abs(weighted.mean - repeated.mean).max() < ROUNDING
    assert np.abs(weighted.covariance - repeated.covariance).max() < ROUNDING


def test_environments_have_their_sample_moments(rng):
    # Fewer environments than coefficients: the covariance is singular, which is no error.
    coefficients = rng.normal(size=(6, 25))
    light = environment_lights(coefficients)
    assert np.abs(light.mean - coefficients.mean(axis=0)).max() < ROUNDING
    expected = np.cov(coefficients, rowvar=False, bias=True)
    assert np.abs(light.covariance - expected).max() < ROUNDING
    assert np.abs(light.second_moment - coefficients.T @ coefficients / 6).max() < ROUNDING


def test_single_precision_environments(rng):
    coefficients = rng.normal(size=(6, 25)).astype(np.float32)
    light = environment_lights(coefficients)
    assert np.abs(light.mean - coefficients.astype(float).mean(axis=0)).max() < ROUNDING


def test_isotropic_lights_follow_the_spectrum():
    light = isotropic_lights(np.array([3.0, 2.0, 1.0]))
    assert np.array_equal(light.covariance, np.diag([3.0, 2, 2, 2, 1, 1, 1, 1, 1]))
    assert not light.mean.any()


@pytest.mark.parametrize(
    ("mean", "covariance", "message"),
    [
        (np.zeros(4), np.diag([1.0, 1, -1, 1]), "positive semi-definite, got the eigenvalue -1"),
        (np.zeros(4), np.eye(4) + np.eye(4, k=1), "must be symmetric"),
        (np.zeros(4), np.full((4, 4), np.nan), "covariance must be finite"),
        (np.full(4, np.inf), np.eye(4), "mean must be finite"),
        (np.zeros(5), np.eye(5), "must be a square"),
        (np.zeros(4), np.eye(9), r"covariance must have shape \(4, 4\)"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_no_distribution(mean, covariance, message):
    with pytest.raises(ArgumentError, match=message):
        LightDistribution(mean, covariance)


def test_mean_takes_no_part_in_what_rounding_may_excuse():
    # Tiny against the mean's square, but far above the rounding of it.
    with pytest.raises(ArgumentError, match="semi-definite"):
        LightDistribution(np.array([1e3, 0, 0, 0]), np.diag([0, 1e-6, -1e-6, 0]))


@pytest.mark.parametrize("half_angle", [0.0, -1.0, 180.1, np.nan])
def test_no_cone(half_angle):
    with pytest.raises(ArgumentError, match="half_angle"):
        cone_lights(DEGREE, half_angle)


def test_cone_needs_a_unit_axis_and_a_degree():
    with pytest.raises(ArgumentError, match="axis must be unit"):
        cone_lights(DEGREE, 30.0, np.array([0.0, 0.0, 2.0]))
    with pytest.raises(ArgumentError, match="degree must be 0 or more"):
        cone_lights(-1, 30.0)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ([1.0, -1.0], "weights must not be negative"),
        ([0.0, 0.0], "weights must not be all zero"),
        ([1.0], "weights must have shape"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_no_weights(weights, message):
    directions = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    with pytest.raises(ArgumentError, match=message):
        directional_lights(DEGREE, directions, np.array(weights))


def test_directions_are_unit_vectors():
    with pytest.raises(ArgumentError, match="directions must be unit"):
        directional_lights(DEGREE, np.array([[0.0, 0.0, 2.0]]))


def test_nothing_to_take_moments_of():
    with pytest.raises(ArgumentError, match="at least one environment"):
        environment_lights(np.zeros((0, 9)))
    with pytest.raises(ArgumentError, match="coefficients must be finite"):
        environment_lights(np.full((2, 9), np.nan))
    with pytest.raises(ArgumentError, match="start with degree 0"):
        isotropic_lights(np.zeros(0))
    with pytest.raises(ArgumentError, match="power must not be negative"):
        isotropic_lights(np.array([1.0, -1.0]))
