import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from data_synth.faces.splines import cardinal_weights

KNOTS = np.array([0.0, 0.1, 0.35, 0.5, 0.8, 1.0])


@pytest.mark.parametrize(("even", "start"), [(True, (1, 0.0)), (False, (2, 0.0))])
def test_spline_is_scipys(even, start):
    values = np.random.default_rng(1).normal(size=len(KNOTS))
    at = np.linspace(0, 1, 57)
    expected = CubicSpline(KNOTS, values, bc_type=(start, (2, 0.0)))(at)
    # Both solve the same well-conditioned tridiagonal system in float64.
    np.testing.assert_allclose(
        cardinal_weights(KNOTS, at, even=even) @ values, expected, atol=1e-12
    )


def test_each_profile_is_one_at_its_own_knot():
    weights = cardinal_weights(KNOTS, KNOTS, even=True)
    np.testing.assert_allclose(weights, np.eye(len(KNOTS)), atol=1e-12)
