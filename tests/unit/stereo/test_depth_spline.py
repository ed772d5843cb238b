"""The system of a depth against a direct solver; values and slopes: see test_surface."""

import numpy as np
from scipy.sparse import block_array, diags_array
from scipy.sparse.linalg import spsolve

from harmface.stereo.depth_spline import spline_over


def test_minimiser_agrees_with_a_direct_solution():
    rng = np.random.default_rng(0)
    rows, columns = np.mgrid[:40, :51]
    surface = spline_over(np.hypot(rows - 20, columns - 15) > 6)
    pixels = surface.depth.shape[0]
    factors = rng.standard_normal((pixels, 2, 2))
    # Pixels differ in what they know by a factor of a thousand, as rims and centres do.
    slope_weights = factors @ factors.swapaxes(1, 2) * 10 ** rng.uniform(-3, 0, (pixels, 1, 1))
    bend_weights = np.full(surface.bends.shape[0], 1e-3)
    right = surface.slopes.T @ rng.standard_normal(2 * pixels)
    found = surface.minimiser(slope_weights, bend_weights, right)

    blocks = [[diags_array(slope_weights[:, i, j]) for j in (0, 1)] for i in (0, 1)]
    system = surface.slopes.T @ block_array(blocks) @ surface.slopes
    system += surface.bends.T @ diags_array(bend_weights) @ surface.bends
    # The free height: the sum of all coefficients, which this right side does not push.
    anchored = system + 1e-6 * diags_array(np.ones(len(right)))
    exact = spsolve(anchored.tocsc(), right)
    left = found - exact
    # Conjugate gradients end at a residual of a thousandth.
    assert left @ (system @ left) < 1e-3**2 * 10 * (exact @ (system @ exact))


def test_coefficients_return_to_their_places():
    mask = np.zeros((5, 7), bool)
    mask[1, 2] = mask[4, 6] = True
    surface = spline_over(mask)
    grid = surface.picture(np.arange(1.0, 1 + len(surface.places[0])))
    expected = np.zeros((7, 9), bool)
    expected[1:4, 2:5] = expected[4:7, 6:9] = True
    np.testing.assert_array_equal(grid > 0, expected)
