"""Non-negative light for known structure: from many directions, or few points.

References
----------
.. [LH74] Lawson and Hanson, Solving Least Squares Problems, 1974, ch. 23.
.. [DP17] Duval and Peyré, Sparse Spikes Super-resolution on Thin Grids I: the LASSO, Inverse
   Problems 2017.
"""

import numpy as np
from jaxtyping import Float
from scipy.linalg import solve_triangular
from scipy.optimize import nnls
from sklearn.cluster import KMeans

from harmface.sphere import fibonacci_directions
from harmface.stereo.light_models import DenseLight

UNSEEN = 1e-3
"""Norm of a direction's image, relative to the largest, below which it costs no less."""


def dense_light(directions: int) -> DenseLight:
    """Return light from so many evenly spread directions."""
    return DenseLight(fibonacci_directions(directions))


def fit_dense_light(
    values: Float[np.ndarray, "F p"],
    model: DenseLight,
    b: Float[np.ndarray, "p 3"],
    *,
    weights: Float[np.ndarray, "F p"] | None = None,
    price: float = 0.0,
    gradient: bool = False,
) -> Float[np.ndarray, "F q"]:
    """Return the non-negative light of each image that explains it best ([LH74]_).

    It minimises `sum_p w_p (M_p - f_p)^2 / 2 + price sum_j |c_j| l_j`, c_j being the image that
    direction j gives alone; uniform light costs nothing. A price of a few deviations of the noise
    leaves a direction or two beside each point that there is ([DP17]_). The Cholesky factor of
    the normal equations is a square problem with the same solution, and its trailing block the
    one in which the unknowns before were eliminated.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model
        The directions.
    b
        Scaled normals.
    weights
        Of the observations; 1 if not given.
    price
        Of light from directions.
    gradient
        Whether there may be an image `g . b` besides, whatever g. It is left out of the result.
    """
    columns = model.columns(b)
    size = _sizes(columns)
    light = np.empty((len(values), len(columns)))
    free = 3 if gradient else 0
    columns = np.concatenate([b.T[:free], columns / size[:, None]])
    prices = np.full(len(columns), price)
    prices[:free] = prices[-1] = 0
    shared = None if weights is not None else _root(columns @ columns.T)
    for i, image in enumerate(values):
        weighted = columns if weights is None else columns * weights[i]
        root = _root(weighted @ columns.T) if shared is None else shared
        right = solve_triangular(root, weighted @ image - prices, trans="T")
        light[i] = nnls(root[free:, free:], right[free:])[0]
    return light / size


def points_of(
    light: Float[np.ndarray, "F q"], model: DenseLight, b: Float[np.ndarray, "p 3"], count: int
) -> Float[np.ndarray, "F r"]:
    """Return points that stand for dense light, as parameters of `PointLights(count, True)`.

    The directions of an image are clustered, each counting by the norm of what it gives; what a
    cluster's directions send together comes from one point.

    Parameters
    ----------
    light, model
        Dense light of each image.
    b
        Scaled normals.
    count
        Points of an image.
    """
    power = light[:, :-1] * _sizes(model.columns(b))[:-1]
    points = np.zeros((len(light), 3 * count + 4))
    points[:, -1] = light[:, -1]
    for i, each in enumerate(light[:, :-1]):
        on = np.flatnonzero(each)
        if not len(on):
            continue
        clusters = KMeans(min(count, len(on)), n_init=1, random_state=0)
        of = clusters.fit_predict(model.directions[on], sample_weight=power[i, on])
        for k in range(clusters.n_clusters):
            some = on[of == k]
            points[i, 3 * k : 3 * k + 3] = each[some] @ model.directions[some]
    return points


def best_point(
    values: Float[np.ndarray, "F p"],
    model: DenseLight,
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "F 7"]:
    """Return the one direction of each image that explains it best beside uniform light.

    With c the image that a direction gives alone and u that of uniform light, the two irradiances
    have the closed form of two unknowns; directions of negative light are left out, and uniform
    light is zero where it would be negative. Parameters of `PointLights(1, ambient=True)`.

    Parameters
    ----------
    values
        Images as rows of pixels.
    model
        The directions.
    b
        Scaled normals.
    weights
        Of the observations.
    """
    columns = model.columns(b)
    c, u = columns[:-1], columns[-1]
    cc, cu, uu = weights @ (c * c).T, weights @ (c * u).T, (weights @ (u * u))[:, None]
    weighted = weights * values
    ci, ui = weighted @ c.T, (weighted @ u)[:, None]
    tiny = np.finfo(np.float64).tiny
    point = (ci * uu - cu * ui) / np.maximum(cc * uu - cu**2, tiny)
    uniform = (ui * cc - cu * ci) / np.maximum(cc * uu - cu**2, tiny)
    point = np.maximum(np.where(uniform < 0, ci / np.maximum(cc, tiny), point), 0)
    uniform = np.maximum((ui - point * cu) / np.maximum(uu, tiny), 0)
    gained = 2 * (point * ci + uniform * ui - point * uniform * cu) - point**2 * cc
    gained -= uniform**2 * uu
    best = np.arange(len(values)), gained.argmax(axis=1)
    light = np.zeros((len(values), 7))
    light[:, :3] = point[best][:, None] * model.directions[best[1]]
    light[:, -1] = uniform[best]
    return light


def _sizes(columns: Float[np.ndarray, "q p"]) -> Float[np.ndarray, "q"]:
    size = np.linalg.norm(columns, axis=1)
    return np.asarray(np.maximum(size, UNSEEN * size.max()))


def _root(gram: Float[np.ndarray, "q q"]) -> Float[np.ndarray, "q q"]:
    """Return R with R' R = gram, a hair of the diagonal added so that it exists."""
    ridge = 1e-9 * np.trace(gram) / len(gram) + np.finfo(np.float64).tiny
    return np.asarray(np.linalg.cholesky(gram + ridge * np.eye(len(gram))).T)
