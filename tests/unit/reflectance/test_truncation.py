import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harmface.conventions import degrees
from harmface.reflectance import (
    clamped_cosine_coefficients,
    energy_by_degree,
    lambert_per_coefficient,
    mean_accuracy_bound,
    truncation_error,
)
from harmface.sphere import random_directions, real_harmonics


@pytest.mark.parametrize("max_degree", [*range(12), 25, 64])
def test_truncation_error_is_the_largest_over_all_angles(max_degree):
    cosine = np.linspace(-1, 1, 20001)
    degree = np.arange(max_degree + 1)
    series = clamped_cosine_coefficients(max_degree) * np.sqrt((2 * degree + 1) / (4 * np.pi))
    error = np.abs(np.polynomial.legendre.legval(cosine, series) - np.maximum(cosine, 0))
    # The horizon and the pole, where it is reached, are points of the grid.
    assert truncation_error(max_degree) == pytest.approx(error.max(), abs=1e-14)


def accuracy(light: np.ndarray, max_degree: int) -> float:
    """Return 1 minus the relative squared error of irradiance cut off at a degree."""
    energy = np.square(lambert_per_coefficient(40) * light)
    return energy[degrees(40) <= max_degree].sum() / energy.sum()


@given(st.integers(1, 30), st.integers(0, 6), st.integers(0, 1000))
def test_no_light_without_negative_radiance_falls_below_the_bound(lamps, max_degree, seed):
    rng = np.random.default_rng(seed)
    radiance = rng.random(lamps)
    light = real_harmonics(random_directions(lamps, rng), 40) @ radiance
    assert accuracy(light, max_degree) > mean_accuracy_bound(max_degree)


def test_light_that_may_be_negative_can_fall_below_the_bound():
    light = real_harmonics(np.array([0.0, 0.0, 1.0]), 40) * (degrees(40) != 1)
    light[0] = 0.5 * light[0]
    light[4:9] = 0
    assert accuracy(light, 2) < mean_accuracy_bound(2)


@pytest.mark.parametrize("max_degree", [0, 1, 2, 3, 4, 10])
def test_the_bound_leaves_only_the_mean_and_what_is_lost(max_degree):
    shares = energy_by_degree(3000)
    lost = shares[max_degree + 1 :].sum()
    # The shares beyond degree 3000 sum to less than 1e-10.
    expected = shares[0] / (shares[0] + lost)
    assert mean_accuracy_bound(max_degree) == pytest.approx(expected, abs=1e-9)
