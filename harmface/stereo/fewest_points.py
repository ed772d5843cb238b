"""Points that an image can do without, and whether it can do without a gradient.

More points than there are explain noise, and worse: with a few too many, light explains images as
well in a frame that is sheared by some percent, in which uniform light is not uniform. With no more
than needed it does not.
"""

import numpy as np
from jaxtyping import Float, Int

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

    Again and again each image puts out its weakest point, makes one of the two nearest to each
    other, or puts out the gradient of the light all around, whichever costs least, for as long as
    `sum_p w_p (M_p - f_p)^2` rises by less than the price.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model, light
        Points of each image, and light all around.
    b
        Scaled normals.
    weights
        Of the observations.
    price
        Of a point, or of a gradient.
    """
    light = light.copy()
    energy = (weights * (values - model.predict(light, b)) ** 2).sum(axis=1)
    some = np.arange(len(light))
    while True:
        image, tried = _simpler(model, light, some)
        if not len(image):
            return light
        tried, cost = fit_light(values[image], model, tried, b, weights[image])
        by_cost = np.lexsort((cost, image))
        best = by_cost[np.unique(image[by_cost], return_index=True)[1]]
        best = best[cost[best] - energy[image[best]] < price]
        some = image[best]
        light[some], energy[some] = tried[best], cost[best]


def _simpler(
    model: PointLights, light: Float[np.ndarray, "F q"], some: Int[np.ndarray, "n"]
) -> tuple[Int[np.ndarray, "m"], Float[np.ndarray, "m q"]]:
    """Return which image it is of, and light with one part less, in up to three ways an image."""
    ways = [put_out(model, light[some]) for put_out in (_weakest_out, _nearest_joined, _evened)]
    image, tried = np.tile(some, len(ways)), np.concatenate(ways)
    simpler = (tried != light[image]).any(axis=1)
    return image[simpler], tried[simpler]


def _weakest_out(model: PointLights, light: Float[np.ndarray, "F q"]) -> Float[np.ndarray, "F q"]:
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
    nearest = np.where(pairs, near, -np.inf).reshape(len(light), model.count**2).argmax(axis=1)
    one, other = np.divmod(nearest, model.count)
    each = np.flatnonzero(pairs.any(axis=(1, 2)))
    points[each, one[each]] += points[each, other[each]]
    points[each, other[each]] = 0
    return light


def _evened(model: PointLights, light: Float[np.ndarray, "F q"]) -> Float[np.ndarray, "F q"]:
    light = light.copy()
    model.gradient(light)[:] = 0
    return light
