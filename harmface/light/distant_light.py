"""Light from finitely many directions."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.layouts import LAYOUTS
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class DistantLight:
    """Directional lights.

    Parameters
    ----------
    directions
        Unit vectors from the surface to each of `J` lights.
    irradiances
        Irradiance that each causes on a surface that faces it, not negative, `(..., J)`: the
        leading axes are images or colour channels.

    Raises
    ------
    ArgumentError
        If the directions are not unit vectors, the irradiances negative, NaN or infinite, or
        their numbers differ.
    """

    directions: Float[np.ndarray, "J 3"]
    irradiances: Float[np.ndarray, "*channels J"]

    __repr__ = summary

    def __post_init__(self) -> None:
        directions = checks.unit_vectors("directions", self.directions)
        irradiances = checks.non_negative("irradiances", self.irradiances)
        if directions.ndim != 2 or irradiances.shape[-1:] != directions.shape[:1]:
            raise ArgumentError(
                "directions (J, 3) and irradiances (..., J) must agree in J, got shapes "
                f"{directions.shape} and {irradiances.shape}"
            )
        object.__setattr__(self, "directions", directions)
        object.__setattr__(self, "irradiances", irradiances)

    def __add__(self, other: "DistantLight") -> "DistantLight":
        """Return both sets of lights together; single-channel light joins as grey."""
        channels = np.broadcast_shapes(self.irradiances.shape[:-1], other.irradiances.shape[:-1])
        irradiances = [
            np.broadcast_to(light.irradiances, (*channels, len(light.directions)))
            for light in (self, other)
        ]
        return type(self)(
            np.concatenate([self.directions, other.directions]),
            np.concatenate(irradiances, axis=-1),
        )

    def total(self) -> Float[np.ndarray, "*channels"]:
        """Return the sum of all irradiances at normal incidence.

        Returns
        -------
        numpy.ndarray
            Irradiance, one number for each of the leading axes.
        """
        return np.asarray(self.irradiances.sum(axis=-1))

    def rotated(self, rotation: Float[np.ndarray, "3 3"]) -> "DistantLight":
        """Return the lights at `rotation @ direction`.

        Parameters
        ----------
        rotation
            Rotation matrix, shape (3, 3).

        Returns
        -------
        DistantLight
            With the same irradiances.

        Raises
        ------
        ArgumentError
            If `rotation` is no rotation matrix.
        """
        turned = self.directions @ checks.rotation("rotation", rotation).T
        return type(self)(turned.astype(self.directions.dtype), self.irradiances)

    def gathered(
        self, n_directions: int, solid_angles: Float[np.ndarray, "J"] | None = None
    ) -> "DistantLight":
        """Return fewer lights that hold the same power.

        Lights in one cell of a cube of at most `n_directions` cells become one, at the centroid of
        their power over all channels, or of `solid_angles` (by default all alike) in a dark cell.

        Parameters
        ----------
        n_directions
            Most lights to return; at least 6 cells are used.
        solid_angles
            Weights, steradians, of lights where all are dark.

        Returns
        -------
        DistantLight
            At most `n_directions` lights, or 6.
        """
        cube = LAYOUTS["cube"]
        side = max(1, math.isqrt(n_directions // 6))
        face, row, column = (
            np.minimum(position.astype(np.intp), limit - 1)
            for position, limit in zip(
                cube.positions_of(self.directions, side), (6, side, side), strict=True
            )
        )
        _, cells = np.unique((face * side + row) * side + column, return_inverse=True)
        count = cells.max() + 1

        def summed(values: Float[np.ndarray, "J"]) -> Float[np.ndarray, "cells"]:
            return np.bincount(cells, weights=values, minlength=count)

        weights = self.irradiances.reshape(-1, len(cells)).sum(axis=0, dtype=np.float64)
        fallback = np.ones(len(cells)) if solid_angles is None else solid_angles
        dark = summed(weights) == 0
        weights = np.where(dark[cells], fallback, weights)
        centroids = np.stack([summed(weights * axis) for axis in self.directions.T], axis=-1)
        centroids /= np.linalg.norm(centroids, axis=-1, keepdims=True)
        irradiances = np.apply_along_axis(summed, -1, self.irradiances)
        return type(self)(centroids, irradiances.astype(self.irradiances.dtype))
