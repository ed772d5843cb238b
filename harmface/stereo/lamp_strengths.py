"""Strengths of lamps of which only the directions are known."""

import numpy as np
from jaxtyping import Float

from harmface.stereo.coarse import coarse_factor, coarse_stack
from harmface.stereo.cues import Cue, KnownDirections, Strengths
from harmface.stereo.factorization import leading_dimensions
from harmface.stereo.gauge import Belief, choose_map
from harmface.stereo.single_sources import single_sources
from harmface.stereo.stack import ImageStack

PIXELS = 600
"""Pixels by which the lamps are found: they outnumber all unknowns many times."""


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
