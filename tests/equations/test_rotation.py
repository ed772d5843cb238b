"""Rotation of the complex harmonics, R05 eq. 15-18."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.conventions import orders
from harmface.sphere import (
    complex_harmonics,
    random_directions,
    real_to_complex,
    rotation_matrices,
)

EPS = np.finfo(float).eps
DEGREE = 5
ROWS = slice(DEGREE**2, (DEGREE + 1) ** 2)
ORDER = orders(DEGREE)[ROWS]
TOLERANCE = 64 * EPS * (2 * DEGREE + 1)


def euler(alpha: float, beta: float, gamma: float) -> np.ndarray:
    """Return Rz(beta) Ry(alpha) Rz(gamma), the rotation of R05 section 0.3.2."""
    return Rotation.from_euler("ZYZ", [beta, alpha, gamma]).as_matrix()


def complex_matrix(rotation: np.ndarray) -> np.ndarray:
    """Return D of R05 eq. 16, from that of the real harmonics: Y complex = C^H Y real."""
    conversion = real_to_complex(np.eye((DEGREE + 1) ** 2))[ROWS, ROWS]
    return conversion.conj().T @ rotation_matrices(rotation, DEGREE)[DEGREE] @ conversion


def test_eq_15_about_z_only_the_phase_turns():
    beta = 0.7
    directions = random_directions(20, 1)
    turned = complex_harmonics(directions @ euler(0, beta, 0).T, DEGREE)[ROWS]
    phase = np.exp(1j * ORDER * beta)[:, np.newaxis]
    assert np.abs(turned - phase * complex_harmonics(directions, DEGREE)[ROWS]).max() <= TOLERANCE


def test_eq_16_complex_harmonics_mix_within_their_degree():
    rotation = euler(1.1, 0.7, -2.0)
    directions = random_directions(20, 2)
    turned = complex_harmonics(directions @ rotation.T, DEGREE)[ROWS]
    mixed = complex_matrix(rotation) @ complex_harmonics(directions, DEGREE)[ROWS]
    assert np.abs(turned - mixed).max() <= TOLERANCE


@pytest.mark.parametrize(("alpha", "beta", "gamma"), [(1.1, 0.7, -2.0), (0.0, 1.0, 2.0), (3, 5, 1)])
def test_eq_17_the_outer_angles_are_phases(alpha, beta, gamma):
    phases = np.exp(1j * (ORDER[:, np.newaxis] * beta + ORDER * gamma))
    expected = complex_matrix(euler(alpha, 0, 0)) * phases
    assert np.abs(complex_matrix(euler(alpha, beta, gamma)) - expected).max() <= TOLERANCE


def test_eq_18_the_middle_column_is_a_harmonic():
    alpha, beta = 1.1, 0.7
    axis = np.array([np.sin(alpha) * np.cos(beta), np.sin(alpha) * np.sin(beta), np.cos(alpha)])
    expected = np.sqrt(4 * np.pi / (2 * DEGREE + 1)) * complex_harmonics(axis, DEGREE)[ROWS]
    column = complex_matrix(euler(alpha, beta, -2.0))[:, DEGREE]
    assert np.abs(column - expected).max() <= TOLERANCE
