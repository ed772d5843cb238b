"""Light of each image by itself, the structure being given."""

import numpy as np
from jaxtyping import Float

from harmface.stereo.abreast import fit_abreast
from harmface.stereo.light_models import LightModel

STEPS = 15
"""Steps of each image: points found roughly settle in about ten."""

IMAGES = 24
"""Images fitted at a time."""


def fit_light(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    start: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> tuple[Float[np.ndarray, "F q"], Float[np.ndarray, "F"]]:
    """Return each image's light that minimises `sum_p w_p (M_p - f(l, b_p))^2`, and the minima.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model
        How light makes an image.
    start
        Light of each image to start from.
    b
        Scaled normals.
    weights
        Of the observations.
    """
    found, cost = start.copy(), np.empty(len(start))
    # A share of the images at a time: derivatives by light are larger than all else.
    for first in range(0, len(start), IMAGES):
        some = slice(first, first + IMAGES)
        found[some], cost[some] = fit_abreast(
            values[some],
            lambda light: model.predict(light, b),
            lambda light: model.by_light(light, b).swapaxes(1, 2),
            start[some],
            weights=weights[some],
            steps=STEPS,
        )
    return found, cost
