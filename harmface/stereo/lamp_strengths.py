"""Strengths of lamps of which only the directions or the places are known."""

import numpy as np
from jaxtyping import Float
from scipy.linalg import eigh

from harmface.errors import ArgumentError
from harmface.stereo.coarse import coarse_factor, coarse_stack
from harmface.stereo.cues import Cue, KnownDirections, Strengths
from harmface.stereo.factorization import leading_dimensions
from harmface.stereo.gauge import Belief, choose_map
from harmface.stereo.known_lights import JUDGED
from harmface.stereo.single_sources import single_sources
from harmface.stereo.stack import ImageStack

PIXELS = 600
"""Pixels by which the lamps are found: they outnumber all unknowns many times."""

JUDGING = 3000
"""Pixels by which strengths are found where nothing else of the lamps is unknown."""


def strengths_of(
    stack: ImageStack, directions: Float[np.ndarray, "F 3"]
) -> tuple[Float[np.ndarray, "F"], tuple[Belief, ...]]:
    """Return the strengths of lamps of which only the directions were measured, of mean one.

    Images in which shadows and highlights play no part give the lamps up to a linear map, see
    `single_sources`; the map is the one under which they have the directions, are of about one
    strength if that holds, and light an integrable surface, see `gauge`. From the directions alone
    strengths follow too, but directions that are a few degrees off would make them up.

    Parameters
    ----------
    stack
        Photographs, in float64.
    directions
        Unit directions to the lamps.

    Returns
    -------
    tuple
        Strengths, and what became of the cues.
    """
    unit = float(stack.values.mean())
    small = coarse_stack(stack, coarse_factor(stack.mask))
    some = np.linspace(0, small.values.shape[1] - 1, min(PIXELS, small.values.shape[1]))
    values = small.values / unit
    found = single_sources(values, small.usable, leading_dimensions(values), some.astype(int))
    lit = found.lit.mean(axis=1)
    weights = lit / max(float(lit.mean()), np.finfo(np.float64).tiny)
    known = KnownDirections(found.light, directions, weights)
    cues: list[Cue] = [known, Strengths.of(found.light, lit)]
    equal = np.linalg.inv(np.linalg.lstsq(found.light, directions, rcond=None)[0])
    gauge = choose_map(cues, [[known.start()], [equal]])
    lamps = np.linalg.norm(found.light @ np.linalg.inv(gauge.rows), axis=1)
    return lamps / lamps.mean(), gauge.beliefs


def strengths_by_elimination(
    values: Float[np.ndarray, "F p"],
    vectors: Float[np.ndarray, "F p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "F"]:
    """Return the strengths, of mean one, under which lamps that each pixel sees explain it best.

    With t = 1 / e, `I_f t_f = g_f . b` is linear in t and b. Eliminating b of each pixel leaves
    `t' M t` with `M = sum_p diag(I) R diag(I)`, `R = W - W G (G' W G)^-1 G' W`, to be minimised
    relative to what noise alone gives, `t' N t` with `N = sum_p diag(R)`: t is the generalised
    eigenvector of the least eigenvalue. Three images tell nothing of them: all are 1.

    Parameters
    ----------
    values
        Images as rows of pixels.
    vectors
        g: the lamps as each pixel sees them, direction times irradiance, were all of strength one.
    weights
        Of the observations; pixels that have fewer than `JUDGED` are left out.

    Raises
    ------
    ArgumentError
        If an image has no weight, or no positive strengths fit.
    """
    judged = np.flatnonzero((weights > 0).sum(axis=0) >= JUDGED)
    if len(values) <= 3 or not len(judged):
        return np.ones(len(values))
    some = judged[:: max(1, len(judged) // JUDGING)]
    w, g = weights[:, some].T, vectors[:, some].swapaxes(0, 1)
    weighted = g * w[..., None]
    normal = weighted.swapaxes(1, 2) @ g
    normal += 1e-9 * np.einsum("pii->p", normal)[:, None, None] * np.eye(3)
    left = -weighted @ np.linalg.solve(normal, weighted.swapaxes(1, 2))
    diagonal = np.arange(len(values))
    left[:, diagonal, diagonal] += w
    seen = values[:, some].T
    m = np.einsum("pf,pfg,pg->fg", seen, left, seen)
    noise = left[:, diagonal, diagonal].sum(axis=0)
    if not (noise > 0).all():
        raise ArgumentError(
            "images must each light some of the object, but one is dark or saturated wherever "
            "others tell its lamp's strength; leave it out"
        )
    inverse = eigh(m, np.diag(noise), subset_by_index=[0, 0])[1][:, 0]
    inverse = inverse * np.sign(inverse.sum())
    if not (inverse > 0).all():
        raise ArgumentError(
            "the lamps' places do not fit the photographs: no positive strengths make them; are "
            "they in the photographs' order?"
        )
    return (1 / inverse) / (1 / inverse).mean()
