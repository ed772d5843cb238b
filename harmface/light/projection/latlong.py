"""Projection of lat-long maps, by rows and columns.

About the map's own pole +y a harmonic is a function of the row times a sine or cosine along it.
Over all degrees up to `n` the functions of the row span only 2 n + 1 dimensions: polynomials in
the height `y` up to degree `n` where the order is even, and `sqrt(1 - y**2)` times polynomials up
to `n - 1` where it is odd. So the one pass over the pixels is a product with 2 n + 1 numbers a row;
what is left, the columns, the change to harmonics, the turn of the pole to +z, is small.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from harmface.conventions import degrees, orders
from harmface.sphere import real_harmonics, rotate

Rule = Literal["samples", "areas"]

BLOCK = 64
"""Rows summed at a time: so many terms are added in float32 where the map is float32, all others
in float64. The block also stays in the processor's cache."""

# Longitude runs from +z to +x, and latitude to +y: that frame's axes x, y, z are our z, x, y.
_FROM_POLE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


@dataclass(frozen=True, eq=False)
class Tables:
    """What projection needs to know of a map's height and a degree."""

    rows: dict[type, Float[np.ndarray, "functions H"]]
    """The functions of the row times the rows' weights, even orders first, in each precision."""
    columns: Float[np.ndarray, "W waves"]
    """The waves along a row, cosines 0 to n and then sines 1 to n, times the columns' weight."""
    wave: Int[np.ndarray, "K"]
    """Which wave each harmonic has."""
    mixing: Float[np.ndarray, "K functions"]
    """Each harmonic's function of the row as a sum of the functions above."""
    turn: Float[np.ndarray, "K K"]
    """The coefficients of each harmonic about the pole +y, in harmonics about +z."""


def project_latlong(
    radiance: Float[np.ndarray, "*channels H W"], max_degree: int, rule: Rule
) -> Float[np.ndarray, "*channels K"]:
    """Return a lat-long map's coefficients in its layout's frame, see `project`."""
    table = tables(radiance.shape[-2], max_degree, rule)
    sums = _row_sums(radiance, table.rows[radiance.dtype.type])
    moments = sums @ table.columns
    # Every harmonic takes its own wave from the row functions of its order's parity.
    about_pole = np.einsum("kj,...jk->...k", table.mixing, moments[..., table.wave])
    return about_pole @ table.turn


def _row_sums(
    radiance: Float[np.ndarray, "*channels H W"], rows: Float[np.ndarray, "functions H"]
) -> Float[np.ndarray, "*channels functions W"]:
    """Return `rows @ radiance` in float64 by blocks of rows, whichever way memory is ordered."""
    *channels, height, width = radiance.shape
    if radiance.strides[-1] == radiance.itemsize:
        total = np.zeros((*channels, len(rows), width))
        for block in _blocks(height):
            total += rows[:, block] @ radiance[..., block, :]
        return total
    # Channels last in memory: a row's pixels and channels are summed alike, as they lie.
    lying = np.moveaxis(radiance, (-2, -1), (0, 1))
    total = np.zeros((len(rows), math.prod(channels) * width))
    for block in _blocks(height):
        some = lying[block]
        total += rows[:, block] @ some.reshape(len(some), -1)
    return np.moveaxis(total.reshape(len(rows), width, *channels), (0, 1), (-2, -1))


def _blocks(height: int) -> list[slice]:
    return [slice(first, first + BLOCK) for first in range(0, height, BLOCK)]


@lru_cache(maxsize=16)
def tables(height: int, max_degree: int, rule: Rule) -> Tables:
    """Return the tables, made once for each height, degree and rule."""
    signed = orders(max_degree)
    order = np.abs(signed)
    odd = order % 2 == 1
    nodes, weights = np.polynomial.legendre.leggauss(max_degree + 1)
    sine = np.sqrt(1 - nodes**2)
    # Harmonics at azimuth 0, where sines vanish: their rows are those of the cosines.
    meridian = np.stack([sine, np.zeros_like(nodes), nodes], axis=-1)
    degree = degrees(max_degree)
    profile = real_harmonics(meridian, max_degree)[degree * (degree + 1) + order]
    # What remains of a profile without its root is a polynomial.
    profile[odd] /= sine
    polynomials = (profile * weights) @ _polynomials(nodes, max_degree).T
    mixing = np.zeros((len(signed), 2 * max_degree + 1))
    mixing[~odd, : max_degree + 1] = polynomials[~odd]
    mixing[odd, max_degree + 1 :] = polynomials[odd, :max_degree]

    width = 2 * height
    longitude = np.pi * (1 - (np.arange(width) + 0.5) / height)
    cosines = np.cos(np.outer(longitude, np.arange(max_degree + 1)))
    sines = np.sin(np.outer(longitude, np.arange(1, max_degree + 1)))
    columns = np.concatenate([cosines, sines], axis=1) * (2 * np.pi / width)
    if rule == "areas":
        of_column = np.concatenate([np.arange(max_degree + 1), np.arange(1, max_degree + 1)])
        columns *= np.sinc(of_column / width)
        rows = _row_integrals(height, max_degree)
    else:
        polar = np.pi * (np.arange(height) + 0.5) / height
        rows = _row_functions(polar, max_degree) * fejer_weights(height)
    return Tables(
        rows={np.float64: rows, np.float32: rows.astype(np.float32)},
        columns=columns,
        wave=np.where(signed < 0, max_degree - signed, signed),
        mixing=mixing,
        turn=rotate(np.eye(len(mixing)), _FROM_POLE),
    )


def fejer_weights(count: int) -> Float[np.ndarray, "count"]:
    """Return Fejer's first weights, for the integral over y in [-1, 1] from midpoints in angle.

    With samples at `y_i = cos(pi (i + 1/2) / count)` they are positive and integrate polynomials
    of degree `count - 1` exactly (Waldvogel, Fast construction of the Fejer and Clenshaw-Curtis
    quadrature rules, BIT 2006).

    Examples
    --------
    >>> fejer_weights(2)
    array([1., 1.])
    """
    # The integrals 2 / (1 - 4 k**2) of the even Chebyshev polynomials, shifted by half a sample.
    even = np.arange((count + 1) // 2)
    spectrum = np.zeros(count + 1, complex)
    spectrum[: len(even)] = 2 * np.exp(1j * np.pi * even / count) / (1 - 4 * even**2)
    return np.fft.ifft(spectrum[:-1] + spectrum[:0:-1].conj()).real


def _row_functions(
    polar: Float[np.ndarray, "*points"], max_degree: int
) -> Float[np.ndarray, "functions *points"]:
    """Return the polynomials in `y = cos(polar)`, then `sqrt(1 - y**2)` times all but the last."""
    polynomials = _polynomials(np.cos(polar), max_degree)
    return np.concatenate([polynomials, np.sin(polar) * polynomials[:max_degree]])


def _polynomials(
    y: Float[np.ndarray, "*points"], max_degree: int
) -> Float[np.ndarray, "polynomials *points"]:
    """Return the Legendre polynomials, orthonormal on [-1, 1]."""
    values = np.moveaxis(np.polynomial.legendre.legvander(y, max_degree), -1, 0)
    norms = np.sqrt(np.arange(max_degree + 1) + 0.5)
    return values * norms.reshape(-1, *[1] * y.ndim)


def _row_integrals(height: int, max_degree: int) -> Float[np.ndarray, "functions H"]:
    """Return the integral of each row function over the solid angle of each row, over 2 pi."""
    # Waves of up to max_degree + 2 half turns over a row's pi / height: enough nodes for rounding.
    nodes, weights = np.polynomial.legendre.leggauss(8 + 2 * (max_degree + 2) // height)
    polar = np.pi / height * (np.arange(height)[:, None] + (nodes + 1) / 2)
    measure = np.pi / (2 * height) * weights * np.sin(polar)
    return np.einsum("frn,rn->fr", _row_functions(polar, max_degree), measure)
