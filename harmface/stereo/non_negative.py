"""Non-negative light for known structure: from many directions, or few points.

References
----------
.. [LH74] Lawson and Hanson, Solving Least Squares Problems, 1974, ch. 23.
"""

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls

from harmface.sphere import fibonacci_directions
from harmface.stereo.light_models import DenseLight

DIRECTIONS = 100
"""Directions on the sphere, about 20 degrees apart: a cosine lobe hardly tells them closer."""

MERGED = 30.0
"""Degrees within which directions stand for one point light between them."""

FAINT = 0.03
"""Share of an image's irradiance below which a point is left out."""


def dense_light() -> DenseLight:
    """Return light from evenly spread directions."""
    return DenseLight(fibonacci_directions(DIRECTIONS))


def fit_dense_light(
    values: Float[np.ndarray, "F p"],
    model: DenseLight,
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"] | None = None,
) -> Float[np.ndarray, "F q"]:
    """Return the non-negative light of each image that explains it best ([LH74]_).

    The normal equations of all images are made at once; the Cholesky factor of each is a square
    problem with the same solution.

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
    """
    columns = model.columns(b)
    light = np.empty((len(values), len(columns)))
    shared = None if weights is not None else _root(columns @ columns.T)
    for i, image in enumerate(values):
        weighted = columns if weights is None else columns * weights[i]
        root = _root(weighted @ columns.T) if shared is None else shared
        light[i] = nnls(root, np.linalg.solve(root.T, weighted @ image))[0]
    return light


def points_of(
    light: Float[np.ndarray, "F q"], model: DenseLight, count: int
) -> Float[np.ndarray, "F r"]:
    """Return the strongest points of dense light, as parameters of `PointLights(count, True)`.

    The strongest direction gathers those near it into one, again and again; what is left over
    becomes uniform light of the same flux.
    """
    near = model.directions @ model.directions.T > np.cos(np.radians(MERGED))
    points = np.zeros((len(light), 3 * count + 1))
    for i, each in enumerate(light):
        left = each[:-1].copy()
        total = left.sum() + each[-1]
        for k in range(count):
            around = near[left.argmax()]
            point = left[around] @ model.directions[around]
            if np.linalg.norm(point) < FAINT * total:
                break
            points[i, 3 * k : 3 * k + 3] = point
            left[around] = 0
        # Irradiance from all around is a quarter of the flux through the sphere.
        points[i, -1] = each[-1] + left.sum() / 4
    return points


def _root(gram: Float[np.ndarray, "q q"]) -> Float[np.ndarray, "q q"]:
    """Return R with R' R = gram, a hair of the diagonal added so that it exists."""
    ridge = 1e-9 * np.trace(gram) / len(gram) + np.finfo(np.float64).tiny
    return np.asarray(np.linalg.cholesky(gram + ridge * np.eye(len(gram))).T)
