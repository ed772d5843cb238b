"""Light of each image by itself, the structure being given."""

import numpy as np
from jaxtyping import Float

from harmface.stereo.abreast import fit_abreast
from harmface.stereo.light_models import LightModel

STEPS = 15
"""Steps of each image: points found roughly settle in about ten."""


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
    return fit_abreast(
        values,
        lambda light: model.predict(light, b),
        lambda light: model.by_light(light, b).swapaxes(1, 2),
        start,
        weights=weights,
        steps=STEPS,
    )
