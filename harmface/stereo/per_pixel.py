"""Scaled normals of each pixel by itself, the light being given."""

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.abreast import fit_abreast
from harmface.stereo.factorization import chunks
from harmface.stereo.light_models import LightModel
from harmface.stereo.robust import seen_weights

STEPS = 15
"""Steps of each pixel from any start."""

STEPS_NEARBY = 8
STEPS_REWEIGHTED = 5
"""Steps from a start found under the same light, and once more with weights: beyond these normals
move by 0.002 degrees on average."""


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
    for some in chunks(len(b), 64 * len(values)):
        counted = np.ones(values[:, some].shape) if weights is None else weights[:, some]
        b[some], _ = fit_abreast(
            values[:, some].T,
            lambda b: model.predict(light, b).T,
            lambda b: model.by_normal(light, b).swapaxes(0, 1),
            b[some],
            weights=counted.T,
            steps=steps,
        )
    return b


def fit_robustly(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    start: Float[np.ndarray, "p 3"],
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals fitted with Cauchy weights about a first fit, and the weights.

    Parameters
    ----------
    values, model, light, start
        As in `fit_normals`.
    seen
        Observations that are not saturated.
    """
    b = fit_normals(
        values, model, light, start, weights=seen.astype(np.float64), steps=STEPS_NEARBY
    )
    weights = seen_weights(values - model.predict(light, b), seen)
    b = fit_normals(values, model, light, b, weights=weights, steps=STEPS_REWEIGHTED)
    return b, weights
