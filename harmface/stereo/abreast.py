"""Many small least-squares problems at once.

References
----------
.. [M78] Moré, The Levenberg-Marquardt Algorithm: Implementation and Theory, 1978.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float


def fit_abreast(
    observed: Float[np.ndarray, "n m"],
    predict: Callable[[Float[np.ndarray, "n k"]], Float[np.ndarray, "n m"]],
    slope: Callable[[Float[np.ndarray, "n k"]], Float[np.ndarray, "n m k"]],
    start: Float[np.ndarray, "n k"],
    *,
    weights: Float[np.ndarray, "n m"] | None,
    steps: int,
) -> tuple[Float[np.ndarray, "n k"], Float[np.ndarray, "n"]]:
    """Return what minimises `sum_j w_ij (y_ij - f_ij(x_i))^2` for each row i, and the minima.

    Damped Gauss-Newton ([M78]_), each row with its own damping; a row moves only when that
    lowers its own energy.

    Parameters
    ----------
    observed
        y.
    predict, slope
        f of all rows, and its derivatives by the unknowns.
    start
        x to start from.
    weights
        Of the observations; 1 if not given.
    steps
        Steps tried.
    """
    x, damping = start, np.full(len(start), 1e-3)
    residual = observed - predict(x)
    energy = _energy(residual, weights)
    diagonal = np.arange(start.shape[1])
    for _ in range(steps):
        by_unknown = slope(x)
        weighted = by_unknown if weights is None else weights[..., None] * by_unknown
        normal = weighted.swapaxes(1, 2) @ by_unknown
        right = (weighted.swapaxes(1, 2) @ residual[..., None])[..., 0]
        scale = normal[:, diagonal, diagonal]
        # What has no say on its row, as a light that is out, stays where it is.
        floor = np.finfo(x.dtype).eps * scale.mean() + np.finfo(x.dtype).tiny
        normal[:, diagonal, diagonal] += damping[:, None] * scale + floor
        trial = x + np.linalg.solve(normal, right[..., None])[..., 0]
        trial_residual = observed - predict(trial)
        trial_energy = _energy(trial_residual, weights)
        better = trial_energy < energy
        x = np.where(better[:, None], trial, x)
        residual = np.where(better[:, None], trial_residual, residual)
        energy = np.where(better, trial_energy, energy)
        damping = np.where(better, damping / 5, damping * 8)
    return x, energy


def _energy(
    residual: Float[np.ndarray, "n m"], weights: Float[np.ndarray, "n m"] | None
) -> Float[np.ndarray, "n"]:
    squares = residual**2
    return np.asarray((squares if weights is None else weights * squares).sum(axis=1))
