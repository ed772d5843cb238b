"""Structure under one point source an image, where neither shadow nor highlight reaches.

What a source lights shows `b . l`, so those observations are of rank 3. Dark ones are in some
shadow, attached or cast, and say little more; noise about zero must not pass for light.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from harmface.stereo.joint import fit_jointly
from harmface.stereo.known_lights import normals_from_directions
from harmface.stereo.light_models import PointLights
from harmface.stereo.robust import point_source_weights, robust_scale
from harmface.stereo.robust_factorization import factorize_robustly

SHADOW = 3.0
"""Deviations of the noise up to which an observation may be of shadow."""

ROUNDS = 3
"""Times that observations are weighed anew."""

STEPS = 15
"""Steps of each joint fit."""

SINGLE = PointLights(1, ambient=False)


@dataclass(frozen=True, eq=False)
class SingleSources:
    """One source an image, and what it lights.

    Parameters
    ----------
    light
        Direction times irradiance of each image's source, up to a linear map.
    b
        Scaled normals, up to its inverse.
    lit
        Observations in no shadow, and usable.
    weights
        How much each observation counted, in [0, 1].
    energies, converged
        Of the last joint fit, see `JointFit`.
    """

    light: Float[np.ndarray, "F 3"]
    b: Float[np.ndarray, "p 3"]
    lit: Bool[np.ndarray, "F p"]
    weights: Float[np.ndarray, "F p"]
    energies: Float[np.ndarray, "n"]
    converged: bool


def single_sources(
    values: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"],
    start: Float[np.ndarray, "p 3"],
    some: Int[np.ndarray, "s"],
) -> SingleSources:
    """Return one source an image and the scaled normals that explain what is lit.

    A robust factorisation starts; alternating as it does, it crawls where many observations are
    missing, so the joint fit of some pixels goes on from there.

    Parameters
    ----------
    values
        Images as rows of pixels.
    usable
        Observations neither dark nor saturated.
    start
        Scaled normals up to a linear map, for pixels that are hardly ever lit.
    some
        Pixels by which light is found.
    """
    found = factorize_robustly(values, 3, usable)
    light, b, lit = found.light, found.structure.T, usable
    for _ in range(ROUNDS):
        lit = _lit(values, usable, light @ b.T)
        weights = point_source_weights(values, light @ b.T, lit)
        fit = fit_jointly(
            values[:, some], SINGLE, light, b[some], weights=weights[:, some], iterations=STEPS
        )
        light = fit.light
        b = normals_from_directions(values, light, usable=lit, robust=True)
    weights = point_source_weights(values, light @ b.T, lit)
    b = _where_seen(lit, b, start)
    return SingleSources(light, b, lit, weights, fit.energies, fit.converged)


def refitted(
    values: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"],
    light: Float[np.ndarray, "F 3"],
    start: Float[np.ndarray, "p 3"],
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return the scaled normals of every pixel for sources found, and the observations' weights.

    What is lit is judged by the start.

    Parameters
    ----------
    values, usable, start
        As in `single_sources`.
    light
        Source of each image.
    """
    lit = _lit(values, usable, light @ start.T)
    b = normals_from_directions(values, light, usable=lit, robust=True)
    return _where_seen(lit, b, start), point_source_weights(values, light @ b.T, lit)


def _lit(
    values: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"],
    predicted: Float[np.ndarray, "F p"],
) -> Bool[np.ndarray, "F p"]:
    noise = robust_scale((values - predicted)[usable])
    return np.asarray(usable & (values > SHADOW * noise))


def _where_seen(
    lit: Bool[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"], start: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return b where three observations or more are lit, elsewhere what the start says of it."""
    seen = lit.sum(axis=0) >= 3
    rows, *_ = np.linalg.lstsq(start[seen], b[seen], rcond=None)
    return np.where(seen[:, None], b, start @ rows)
