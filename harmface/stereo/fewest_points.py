"""Points that an image can do without.

More points than there are explain noise, and worse: with a few too many, light explains images as
well in a frame that is sheared by some percent, in which uniform light is not uniform. With no more
than needed it does not.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.light_models import PointLights
from harmface.stereo.per_image import fit_light


def fewest_points(
    values: Float[np.ndarray, "F p"],
    model: PointLights,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
    price: float,
) -> Float[np.ndarray, "F q"]:
    """Return light of fewer points, each worth its price; those left out are zero.

    Again and again each image puts out its weakest point, or makes one of the two nearest to each
    other, whichever costs less, for as long as `sum_p w_p (M_p - f_p)^2` rises by less than the
    price.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model, light
        Points and uniform light of each image.
    b
        Scaled normals.
    weights
        Of the observations.
    price
        Of a point.
    """
    light = light.copy()
    energy = (weights * (values - model.predict(light, b)) ** 2).sum(axis=1)
    some = np.flatnonzero((model.points(light) != 0).any(axis=2).sum(axis=1) > 1)
    while len(some):
        tried = _weakest_put_out(model, light[some]), _nearest_joined(model, light[some])
        fits = [fit_light(values[some], model, each, b, weights[some]) for each in tried]
        cheaper = fits[1][1] < fits[0][1]
        fewer = np.where(cheaper[:, None], fits[1][0], fits[0][0])
        left = np.where(cheaper, fits[1][1], fits[0][1])
        taken = left - energy[some] < price
        fewer, left, some = fewer[taken], left[taken], some[taken]
        light[some], energy[some] = fewer, left
        some = some[_on(model, fewer).sum(axis=1) > 1]
    return light


def _on(model: PointLights, light: Float[np.ndarray, "F q"]) -> Bool[np.ndarray, "F n"]:
    return np.asarray((model.points(light) != 0).any(axis=2))


def _weakest_put_out(
    model: PointLights, light: Float[np.ndarray, "F q"]
) -> Float[np.ndarray, "F q"]:
    light = light.copy()
    points = model.points(light)
    size = np.linalg.norm(points, axis=2)
    weakest = np.where(size > 0, size, np.inf).argmin(axis=1)
    points[np.arange(len(light)), weakest] = 0
    return light


def _nearest_joined(
    model: PointLights, light: Float[np.ndarray, "F q"]
) -> Float[np.ndarray, "F q"]:
    light = light.copy()
    points = model.points(light)
    size = np.linalg.norm(points, axis=2, keepdims=True)
    unit = points / np.where(size > 0, size, 1.0)
    near = unit @ unit.swapaxes(1, 2)
    on = size[..., 0] > 0
    pairs = on[:, :, None] & on[:, None] & ~np.eye(model.count, dtype=bool)
    nearest = np.where(pairs, near, -np.inf).reshape(len(light), -1).argmax(axis=1)
    one, other = np.divmod(nearest, model.count)
    each = np.arange(len(light))
    points[each, one] += points[each, other]
    points[each, other] = 0
    return light
