"""Figures that RH01, R05 and BJ03 print about Lambert's law."""

import numpy as np
import pytest

from harmface.reflectance import (
    energy_by_degree,
    lambert_coefficients,
    mean_accuracy_bound,
    truncation_error,
)


def test_rh01_eq_9():
    printed = [3.141593, 2.094395, 0.785398, 0, -0.130900, 0, 0.049087]
    np.testing.assert_allclose(lambert_coefficients(6), printed, atol=5e-7)


def test_r05_eq_29():
    written = [np.pi, 2 * np.pi / 3, np.pi / 4, 0, -np.pi / 24, 0, np.pi / 64]
    np.testing.assert_allclose(lambert_coefficients(6), written, rtol=4 * np.finfo(float).eps)


def test_rh01_section_2_coefficients_fall_as_the_power_minus_five_halves():
    degree = np.arange(20, 201, 2)
    slope, _ = np.polyfit(np.log(degree), np.log(np.abs(lambert_coefficients(200)[degree])), 1)
    assert slope == pytest.approx(-2.5, abs=0.02)


def test_r05_section_0_3_2_energy_in_low_degrees():
    cumulative = energy_by_degree(4).cumsum()[[0, 1, 2, 4]]
    np.testing.assert_allclose(cumulative, [0.375, 0.875, 0.9922, 0.9980], atol=1e-4)


def test_rh01_section_3_1_no_pixel_is_off_by_more_than_nine_percent():
    assert truncation_error(2) == pytest.approx(0.09375, abs=1e-15)
    assert int(100 * truncation_error(2)) == 9


def test_bj03_mean_accuracy_is_at_least_98_percent_rounded():
    assert mean_accuracy_bound(2) == pytest.approx(0.375 / 0.3828125, rel=4 * np.finfo(float).eps)
    assert mean_accuracy_bound(2) == pytest.approx(0.9796, abs=5e-5)
