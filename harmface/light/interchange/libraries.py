"""Libraries of mathematics: scipy and healpy (complex), pyshtools (real, 4 pi normalised).

Their polar angle is measured from z and their azimuth from x to y, as ours; of any degree.

References
----------
.. [SCI] scipy/scipy, `scipy.special.sph_harm_y(l, m, theta, phi)`: Condon-Shortley phase,
   orthonormal.
.. [HEA] healpy/healpy, healpy/sphtfunc.py: `Alm.getidx`, m >= 0 only, ordered by m; the same
   harmonics.
.. [SHT] SHTOOLS/SHTOOLS, pyshtools/shclasses/shcoeffs.py: `coeffs[0, l, m]` of the cosine and
   `coeffs[1, l, m]` of the sine, by default "4pi" normalised without the phase.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from harmface import checks
from harmface.conventions import degrees, harmonic_count, max_degree_of, orders
from harmface.errors import ArgumentError
from harmface.sphere import complex_to_real, real_to_complex

GREATEST = 100
"""Highest degree that is looked for behind a number of values."""


@dataclass(frozen=True)
class Scipy:
    """Complex coefficients of `sph_harm_y`, flat index `l (l + 1) + m`: (channels, K)."""

    name: str = "scipy"
    stored: str = "radiance, complex, of sph_harm_y"
    source: str = "scipy/scipy scipy.special.sph_harm_y"

    def decode(self, values: Complex[np.ndarray, "..."]) -> Float[np.ndarray, "channels K"]:
        """Return lighting coefficients; the light must be real."""
        return complex_to_real(np.atleast_2d(np.asarray(values, np.complex128)))

    def encode(self, light: Float[np.ndarray, "channels K"]) -> Complex[np.ndarray, "channels K"]:
        """Return the inverse of `decode`."""
        return real_to_complex(np.atleast_2d(checks.finite("light", light)))


@dataclass(frozen=True)
class Healpy:
    """Complex `alm` of orders m >= 0, ordered by m: (channels, n)."""

    name: str = "healpy"
    stored: str = "radiance, complex, orders m >= 0 by order"
    source: str = "healpy/healpy healpy/sphtfunc.py"

    def decode(self, values: Complex[np.ndarray, "..."]) -> Float[np.ndarray, "channels K"]:
        """Return lighting coefficients.

        Raises
        ------
        ArgumentError
            If the number of values is that of no degree.
        """
        table = np.atleast_2d(np.asarray(values, np.complex128))
        sizes = [(n + 1) * (n + 2) // 2 for n in range(GREATEST + 1)]
        if table.ndim != 2 or table.shape[1] not in sizes:
            raise ArgumentError(
                "coefficients of healpy must number (n + 1) (n + 2) / 2 a channel, such as 6 for "
                f"degree 2, got shape {table.shape}"
            )
        degree = sizes.index(table.shape[1])
        l, m = degrees(degree), orders(degree)  # noqa: E741 - the field's name for it
        own = table[:, _index(degree, l, np.abs(m))]
        # Of a real function c(l, -m) = (-1)^m conj c(l, m).
        full = np.where(m < 0, (-1.0) ** (np.abs(m) % 2) * own.conj(), own)
        return complex_to_real(full)

    def encode(self, light: Float[np.ndarray, "channels K"]) -> Complex[np.ndarray, "channels n"]:
        """Return the inverse of `decode`."""
        full = real_to_complex(np.atleast_2d(checks.finite("light", light)))
        degree = max_degree_of(full.shape[-1])
        l, m = degrees(degree), orders(degree)  # noqa: E741
        kept = m >= 0
        table = np.empty((len(full), (degree + 1) * (degree + 2) // 2), np.complex128)
        table[:, _index(degree, l[kept], m[kept])] = full[:, kept]
        return table


def _index(degree: int, l: np.ndarray, m: np.ndarray) -> np.ndarray:  # noqa: E741
    return m * (2 * degree + 1 - m) // 2 + l


@dataclass(frozen=True)
class Pyshtools:
    """Real `coeffs` of pyshtools, (channels, 2, n + 1, n + 1): 4 pi normalised, no phase."""

    name: str = "pyshtools"
    stored: str = "radiance over sqrt(4 pi), cosines and sines"
    source: str = "SHTOOLS/SHTOOLS pyshtools/shclasses/shcoeffs.py"

    def decode(self, values: Float[np.ndarray, "..."]) -> Float[np.ndarray, "channels K"]:
        """Return lighting coefficients.

        Raises
        ------
        ArgumentError
            If the array has another shape.
        """
        table = checks.finite("values", values)
        table = table[None] if table.ndim == 3 else table
        if table.ndim != 4 or table.shape[1] != 2 or table.shape[2] != table.shape[3]:
            raise ArgumentError(
                "coefficients of pyshtools must have shape (2, n + 1, n + 1), or channels before "
                f"that, got {np.shape(values)}"
            )
        degree = table.shape[2] - 1
        l, m = degrees(degree), orders(degree)  # noqa: E741
        return np.sqrt(4 * np.pi) * table[:, (m < 0).astype(int), l, np.abs(m)]

    def encode(self, light: Float[np.ndarray, "channels K"]) -> Float[np.ndarray, "..."]:
        """Return the inverse of `decode`."""
        light = np.atleast_2d(checks.finite("light", light))
        degree = max_degree_of(light.shape[-1])
        l, m = degrees(degree), orders(degree)  # noqa: E741
        table = np.zeros((len(light), 2, degree + 1, degree + 1))
        table[:, (m < 0).astype(int), l, np.abs(m)] = light[:, : harmonic_count(degree)]
        return table / np.sqrt(4 * np.pi)


SCIPY, HEALPY, PYSHTOOLS = Scipy(), Healpy(), Pyshtools()
