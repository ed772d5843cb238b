"""What is lost when Lambert's filter, or any lobe, is cut off at a degree.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, IEEE Transactions on
   Pattern Analysis and Machine Intelligence 25(2), 2003.
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import math

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance.lambert import central_binomial, clamped_cosine_coefficients
from harmface.reflectance.material import Material


def energy_by_degree(max_degree: int) -> Float[np.ndarray, "L"]:
    """Return the share of the clamped cosine's energy that each degree holds, [BJ03]_.

    The whole energy, the integral of max(cos, 0)^2 over the sphere, is 2 pi / 3.

    Parameters
    ----------
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Shares in [0, 1], shape (max_degree + 1,), float64.

    Examples
    --------
    >>> energy_by_degree(4).cumsum().round(4)
    array([0.375 , 0.875 , 0.9922, 0.9922, 0.998 ])
    """
    return np.square(clamped_cosine_coefficients(max_degree)) / (2 * math.pi / 3)


def truncation_error(max_degree: int) -> float:
    """Return the largest error, at any angle, of the clamped cosine cut off at a degree.

    By [RH01]_ section 3.1 this bounds the error of any pixel as a fraction of the light's whole
    intensity. From degree 2 on it is reached at the horizon, where the cosine has its kink and
    the truncated series the value `b_l^2 (l + 1) / (2 (l + 2))`, `b_l` being the bracket of
    [RH01]_ eq. 8 and `l` the greatest even degree kept: the terms telescope. Below, it is 3/4,
    facing the light, at degree 0, and 1/4, there and at the horizon, at degree 1.

    Parameters
    ----------
    max_degree
        Greatest degree kept, at least 0.

    Returns
    -------
    float
        In units of the clamped cosine, whose largest value is 1.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative or not whole.

    Examples
    --------
    >>> truncation_error(2)
    0.09375
    """
    even = checks.degree("max_degree", max_degree) // 2 * 2
    if max_degree == 0:
        return 0.75
    return central_binomial(even) ** 2 * (even + 1) / (2 * (even + 2))


def mean_accuracy_bound(max_degree: int) -> float:
    """Return a bound below the mean accuracy of irradiance cut off at a degree, [BJ03]_.

    Accuracy is 1 minus the squared error over the sphere of normals, relative to the squared
    irradiance. Light that is nowhere negative has at degree `l` at most `2l + 1` times the
    energy of its mean, as a single lamp has; at worst every degree that is lost is at this limit
    and every degree kept but the mean is dark. With the shares of `energy_by_degree` that leaves
    `e_0 / (e_0 + lost)`, 0.375 / 0.3828125 at degree 2.

    Parameters
    ----------
    max_degree
        Greatest degree kept, at least 0.

    Returns
    -------
    float
        A share of the energy, in [0, 1].

    Examples
    --------
    >>> round(mean_accuracy_bound(2), 4)
    0.9796
    """
    shares = energy_by_degree(max_degree)
    return float(shares[0] / (shares[0] + 1 - shares.sum()))


def lobe_degree(material: Material, accuracy: float, *, most: int) -> int:
    """Return the least degree at which a lobe may be cut off for a stated accuracy.

    Cut off are factors of at most `accuracy` of the greatest: the error is then, root mean square
    over all mirrored directions, at most this share of what a mirror would show (Parseval).

    Parameters
    ----------
    material
        Its `radial` factors are the lobe.
    accuracy
        Greatest factor that is cut off, as a share of the greatest of all, in (0, 1).
    most
        Greatest degree that is looked at.

    Returns
    -------
    int
        A degree, at most `most`.

    Raises
    ------
    ArgumentError
        If the accuracy is no such share, or `most` degrees are not enough.

    Examples
    --------
    >>> from harmface.reflectance import Phong
    >>> [lobe_degree(Phong(exponent), 0.1, most=99) for exponent in (5, 50, 500)]
    [4, 14, 47]
    """
    if not 0 < accuracy < 1:
        raise ArgumentError(f"accuracy must lie between 0 and 1, got {accuracy}")
    # The tail beyond `most` is not known; twice as far a lobe that is resolved has ended.
    factors = material.radial(2 * checks.positive_integer("most", most))
    size = np.abs(factors)
    later = np.maximum.accumulate(size[..., ::-1], axis=-1)[..., ::-1]
    enough = later[..., 1:] <= accuracy * later[..., :1]
    within = enough.reshape(-1, enough.shape[-1]).all(axis=0)
    degree = int(within.argmax())
    if not within.any() or degree > most:
        raise ArgumentError(
            f"{material} passes more than {accuracy:g} of the light beyond degree {most}; "
            "take a duller material, a finer map, or a mirror"
        )
    return degree
