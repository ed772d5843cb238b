"""Scaled normals of each pixel by itself, the light being given.

References
----------
.. [M78] Moré, The Levenberg-Marquardt Algorithm: Implementation and Theory, 1978.
"""

import numpy as np
from jaxtyping import Float

from harmface.stereo.factorization import chunks
from harmface.stereo.light_models import LightModel
from harmface.stereo.robust import cauchy_weights, robust_scale

STEPS = 15
"""Steps of each pixel: three unknowns and a good start need about five."""


def fit_normals(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    start: Float[np.ndarray, "p 3"],
    *,
    weights: Float[np.ndarray, "F p"] | None = None,
    steps: int = STEPS,
) -> Float[np.ndarray, "p 3"]:
    """Return the scaled normals that minimise `sum_i w_i (M_i - f_i(b))^2` at each pixel.

    Damped Gauss-Newton ([M78]_), all pixels abreast, each with its own damping; a pixel moves
    only when that lowers its own energy.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model, light
        How light makes an image, and the light of each.
    start
        Scaled normals to start from.
    weights
        Of the observations; 1 if not given.
    steps
        Steps tried.
    """
    b = start.astype(np.float64)
    for some in chunks(len(b), 8 * len(values)):
        part = None if weights is None else weights[:, some]
        b[some] = _fit(values[:, some], model, light, b[some], part, steps)
    return b


def fit_robustly(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    start: Float[np.ndarray, "p 3"],
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals fitted with Cauchy weights about a first fit, and the weights.

    Arguments as in `fit_normals`.
    """
    b = fit_normals(values, model, light, start)
    residual = values - model.predict(light, b)
    weights = cauchy_weights(residual, robust_scale(residual))
    return fit_normals(values, model, light, b, weights=weights), weights


def pixel_energy(
    values: Float[np.ndarray, "F p"],
    predicted: Float[np.ndarray, "F p"],
    weights: Float[np.ndarray, "F p"] | None,
) -> Float[np.ndarray, "p"]:
    """Return `sum_i w_i r_i^2` of each pixel."""
    squares = (values - predicted) ** 2
    return np.asarray((squares if weights is None else weights * squares).sum(axis=0))


def _fit(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"] | None,
    steps: int,
) -> Float[np.ndarray, "p 3"]:
    damping = np.full(len(b), 1e-3)
    predicted = model.predict(light, b)
    energy = pixel_energy(values, predicted, weights)
    for _ in range(steps):
        slope = model.by_normal(light, b).swapaxes(0, 1)
        weighted = slope if weights is None else weights.T[..., None] * slope
        normal = weighted.swapaxes(1, 2) @ slope
        right = np.einsum("pfi,fp->pi", weighted, values - predicted)
        diagonal = np.einsum("pii->pi", normal)
        # A pixel that no light reaches has nothing to say; the floor keeps it where it is.
        floor = np.finfo(b.dtype).eps * diagonal.mean() + np.finfo(b.dtype).tiny
        diagonal += damping[:, None] * diagonal + floor
        trial = b + np.linalg.solve(normal, right[..., None])[..., 0]
        trial_predicted = model.predict(light, trial)
        trial_energy = pixel_energy(values, trial_predicted, weights)
        better = trial_energy < energy
        b = np.where(better[:, None], trial, b)
        predicted = np.where(better, trial_predicted, predicted)
        energy = np.where(better, trial_energy, energy)
        damping = np.where(better, damping / 5, damping * 8)
    return b
