"""Editing light by its coefficients, RH01 3.3: brighter from above is more of (1, -1).

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import flat_index
from harmface.errors import ArgumentError


def set_coefficient(
    coefficients: Float[np.ndarray, "*channels K"],
    degree: int,
    order: int,
    value: Float[np.ndarray, "*channels"] | float,
) -> Float[np.ndarray, "*channels K"]:
    """Return light with one coefficient replaced, [RH01]_ 3.3 and figure 4.

    Parameters
    ----------
    coefficients
        Lighting coefficients; they are not changed.
    degree, order
        Which: (1, -1) is up against down, (1, 1) right against left, (1, 0) front against back.
    value
        The new value: one number or one a channel.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`.

    Raises
    ------
    ArgumentError
        If there is no such harmonic among the coefficients.
    """
    index = _index(coefficients, degree, order)
    edited = coefficients.copy()
    edited[..., index] = checks.finite("value", value)
    return edited


def scale_coefficient(
    coefficients: Float[np.ndarray, "*channels K"],
    degree: int,
    order: int,
    factor: Float[np.ndarray, "*channels"] | float,
) -> Float[np.ndarray, "*channels K"]:
    """Return light with one coefficient multiplied, see `set_coefficient`.

    Parameters
    ----------
    coefficients
        Lighting coefficients, shape `(*channels, K)`; they are not changed.
    degree
        Degree `l` of the coefficient.
    order
        Its order `m`.
    factor
        One number or one a channel.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`.

    Raises
    ------
    ArgumentError
        If there is no such harmonic among the coefficients, or a factor is not finite.

    Examples
    --------
    Light from below instead of above, as [RH01]_ suggests:

    >>> scale_coefficient(np.array([1.0, 0.5, 0.0, 0.0]), 1, -1, -1.0)
    array([ 1. , -0.5,  0. ,  0. ])
    """
    value = coefficients[..., _index(coefficients, degree, order)]
    return set_coefficient(coefficients, degree, order, value * checks.finite("factor", factor))


def animate_coefficient(
    coefficients: Float[np.ndarray, "*channels K"],
    degree: int,
    order: int,
    factors: Float[np.ndarray, "frames"],
) -> Float[np.ndarray, "frames *channels K"]:
    """Return one light a frame, with one coefficient multiplied by the frame's factor.

    Parameters
    ----------
    coefficients
        Lighting coefficients.
    degree, order
        Which, as in `set_coefficient`.
    factors
        One for every frame.

    Returns
    -------
    numpy.ndarray
        Shape `(frames, *channels, K)`.

    Raises
    ------
    ArgumentError
        If there is no such harmonic among the coefficients.
    """
    index = _index(coefficients, degree, order)
    factors = checks.finite("factors", factors)
    frames = np.repeat(coefficients[None], len(factors), axis=0)
    frames[..., index] *= factors.reshape(-1, *[1] * (coefficients.ndim - 1))
    return frames


def _index(coefficients: Float[np.ndarray, "*channels K"], degree: int, order: int) -> int:
    index = flat_index(degree, order)
    if index >= coefficients.shape[-1]:
        raise ArgumentError(
            f"coefficients must reach degree {degree}, got {coefficients.shape[-1]} of them"
        )
    return index
