"""Measured materials: a table over the angles of halfway and difference directions.

References
----------
.. [R98] Rusinkiewicz, A New Change of Variables for Efficient BRDF Representation, EGWR 1998.
.. [MPBM03] Matusik, Pfister, Brand and McMillan, A Data-Driven Reflectance Model, SIGGRAPH 2003.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance.material import Material, above, halfway
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class Tabulated(Material):
    """An isotropic reflectance given by a table, interpolated linearly between measured values.

    Parameters
    ----------
    values
        Reflectance per steradian, finite and at least 0, shape `(*channels, H, D, P)`: angle of
        the halfway direction to the normal, its square root uniform over [0, pi / 2]; angle of
        the light to the halfway direction, uniform over [0, pi / 2]; azimuth of the light about
        it, uniform over [0, pi] ([R98]_, as [MPBM03]_ store it).
    measured
        Where the table holds a measurement, shape `(H, D, P)`. What none of the neighbours of a
        pair of directions holds is 0.

    Raises
    ------
    ArgumentError
        If a value is negative or not finite, or the shapes disagree.
    """

    values: Float[np.ndarray, "*channels H D P"]
    measured: Bool[np.ndarray, "H D P"]

    __repr__ = summary

    def __post_init__(self) -> None:
        checks.non_negative("values", self.values)
        checks.mask("measured", self.measured, self.values.shape[-3:])
        if not self.measured.any():
            raise ArgumentError("a table must hold some measurement, got none")

    @property
    def missing(self) -> int:
        """Number of entries of the table, of each channel, without a measurement."""
        return int((~self.measured).sum())

    @cached_property
    def _padded(self) -> Float[np.ndarray, "tables H D P"]:
        """The measured values and where they are, closed in azimuth."""
        flat = self.values.reshape(-1, *self.measured.shape)
        tables = np.concatenate([flat * self.measured, self.measured[None].astype(flat.dtype)])
        return np.concatenate([tables[..., -1:], tables, tables[..., :1]], axis=-1)

    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Return the reflectance, see `Material`.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal.

        Returns
        -------
        numpy.ndarray
            Per steradian, shape `(*channels, *pairs)`.
        """
        from scipy.ndimage import map_coordinates

        half = halfway(incoming, outgoing)
        cosine = np.clip(half[..., 2], 0, 1)
        sine = np.hypot(half[..., 0], half[..., 1])
        along = np.clip((incoming * half).sum(axis=-1), -1, 1)
        # The frame of the halfway direction: y across the plane of normal and halfway direction.
        tilted = sine > 1e-9
        x = np.where(tilted, half[..., 0] / np.where(tilted, sine, 1), 1)
        y = np.where(tilted, half[..., 1] / np.where(tilted, sine, 1), 0)
        down = incoming[..., 0] * x + incoming[..., 1] * y
        first = down * cosine - incoming[..., 2] * sine
        second = incoming[..., 1] * x - incoming[..., 0] * y
        rows, columns, azimuths = self.measured.shape
        place = [
            np.sqrt(np.arctan2(sine, cosine) / (math.pi / 2)) * rows,
            np.arccos(along) / (math.pi / 2) * columns,
            np.arctan2(second, first) % math.pi / math.pi * azimuths + 1,
        ]
        # Entry k stands for the whole of its bin, hence for its middle.
        found = np.stack(
            [
                map_coordinates(table, [each - 0.5 for each in place], order=1, mode="nearest")
                for table in self._padded
            ]
        )
        known = found[-1]
        values = np.divide(found[:-1], known, out=np.zeros_like(found[:-1]), where=known > 1e-9)
        values *= above(incoming, outgoing)
        return values.reshape(*self.values.shape[:-3], *known.shape)
