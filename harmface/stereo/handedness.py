"""Whether known lights have their y axis the right way up."""

import numpy as np
from jaxtyping import Bool, Float

STEEPEST = 3.0
"""Largest slope compared: steeper ones are mostly noise."""

CLEAR = 0.6
"""Curl of the turned surface over that of the given one below which the axis must be wrong."""


def seems_upside_down(normals: Float[np.ndarray, "H W 3"], mask: Bool[np.ndarray, "H W"]) -> bool:
    """Return whether the normals would fit a surface much better with their y negated.

    A surface's slopes have no curl, `dp/dy = dq/dx`. Lights whose y points down give normals
    whose q has the wrong sign, and so a curl of `2 dp/dy`. Of a surface that is flat or straight
    one way nothing can be said.

    Parameters
    ----------
    normals
        Unit normals, y up.
    mask
        The surface.

    Returns
    -------
    bool
        False where nothing can be said.
    """
    flat = mask & (normals[..., 2] * STEEPEST > np.hypot(normals[..., 0], normals[..., 1]))
    towards = np.where(flat, normals[..., 2], 1.0)
    p, q = (-normals[..., axis] / towards for axis in (0, 1))
    # Rows run downwards, so a difference over rows is one of -y.
    p_y = p[:-1, :-1] - p[1:, :-1] + p[:-1, 1:] - p[1:, 1:]
    q_x = q[:-1, 1:] - q[:-1, :-1] + q[1:, 1:] - q[1:, :-1]
    whole = flat[:-1, :-1] & flat[1:, :-1] & flat[:-1, 1:] & flat[1:, 1:]
    given, turned = np.abs(p_y - q_x)[whole].sum(), np.abs(p_y + q_x)[whole].sum()
    return bool(turned < CLEAR * given)
