"""Many small least-squares problems at once.

References
----------
.. [M78] Moré, The Levenberg-Marquardt Algorithm: Implementation and Theory, 1978.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

SETTLED = 1e-8
"""Relative change of its energy by a step after which a row rests."""


def fit_abreast(
    observed: Float[np.ndarray, "n m"],
    predict: Callable[[Float[np.ndarray, "n k"]], Float[np.ndarray, "n m"]],
    slope: Callable[[Float[np.ndarray, "n k"]], Float[np.ndarray, "n m k"]],
    start: Float[np.ndarray, "n k"],
    *,
    weights: Float[np.ndarray, "n m"],
    steps: int,
) -> tuple[Float[np.ndarray, "n k"], Float[np.ndarray, "n"]]:
    """Return what minimises `sum_j w_ij (y_ij - f_ij(x_i))^2` for each row i, and the minima.

    Damped Gauss-Newton ([M78]_), each row with its own damping; a row moves only when that
    lowers its own energy, and rests once that hardly falls any more.

    Parameters
    ----------
    observed
        y.
    predict, slope
        f of some rows, whose x are given, and its derivatives by the unknowns.
    start
        x to start from.
    weights
        Of the observations.
    steps
        Steps tried.
    """
    x, damping = start.copy(), np.full(len(start), 1e-3)
    residual = observed - predict(x)
    energy = (weights * residual**2).sum(axis=1)
    diagonal = np.arange(start.shape[1])
    some = np.arange(len(start))
    for _ in range(steps):
        by_unknown = slope(x[some])
        weighted = weights[some, :, None] * by_unknown
        normal = weighted.swapaxes(1, 2) @ by_unknown
        right = (weighted.swapaxes(1, 2) @ residual[some, :, None])[..., 0]
        scale = normal[:, diagonal, diagonal]
        # What has no say on its row, as a light that is out, stays where it is.
        floor = np.finfo(x.dtype).eps * scale.mean() + np.finfo(x.dtype).tiny
        normal[:, diagonal, diagonal] += damping[some, None] * scale + floor
        trial = x[some] + np.linalg.solve(normal, right[..., None])[..., 0]
        trial_residual = observed[some] - predict(trial)
        trial_energy = (weights[some] * trial_residual**2).sum(axis=1)
        fall = energy[some] - trial_energy
        better, settled = fall > 0, np.abs(fall) <= SETTLED * energy[some]
        moved = some[better]
        x[moved], residual[moved] = trial[better], trial_residual[better]
        energy[moved] = trial_energy[better]
        damping[some] *= np.where(better, 1 / 5, 8)
        some = some[~settled]
        if not len(some):
            break
    return x, energy
