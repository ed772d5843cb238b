"""The nine harmonics of degrees 0 to 2 as polynomials of the direction, [RH01]_ eq. 3."""

import math

import numpy as np
from jaxtyping import Float

Y0 = math.sqrt(1 / (4 * math.pi))
"""Y_00, printed as 0.282095."""
Y1 = math.sqrt(3 / (4 * math.pi))
"""Factor of y, z and x, printed as 0.488603."""
Y2 = math.sqrt(15 / (4 * math.pi))
"""Factor of xy, yz and xz, printed as 1.092548."""
Y20 = math.sqrt(5 / (16 * math.pi))
"""Factor of 3 z^2 - 1, printed as 0.315392."""
Y22 = math.sqrt(15 / (16 * math.pi))
"""Factor of x^2 - y^2, printed as 0.546274."""


def fill_closed_forms(
    xyz: Float[np.ndarray, "3 N"],
    out: Float[np.ndarray, "K N"],
    scratch: Float[np.ndarray, "3 N"],
) -> Float[np.ndarray, "N"]:
    """Write degrees 0 to 2 (as many as `out` has rows for) and return the squared lengths.

    The squares are needed for degree 2 in any case, so that checking the lengths costs nothing
    but a look at the least and the greatest. `scratch` holds the result.
    """
    x, _, z = xyz
    squares = np.multiply(xyz, xyz, out=scratch)
    out[0] = Y0
    if len(out) > 1:
        np.multiply(xyz[1:], Y1, out=out[1:3])
        np.multiply(x, Y1, out=out[3])
    if len(out) > 4:
        np.multiply(xyz[:2], xyz[1:], out=out[4:6])
        out[4:6] *= Y2
        np.multiply(squares[2], 3 * Y20, out=out[6])
        out[6] -= Y20
        np.multiply(x, z, out=out[7])
        out[7] *= Y2
        np.subtract(squares[0], squares[1], out=out[8])
        out[8] *= Y22
    squared_length = squares[0]
    squared_length += squares[1]
    squared_length += squares[2]
    return squared_length
