"""Light that changes from place to place: coefficients at points of space, interpolated.

Coefficients interpolate as light itself would: each point between sees a mixture of its
neighbours' environments.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.summaries import summary

if TYPE_CHECKING:
    from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator


@dataclass(frozen=True, eq=False)
class ProbeGrid:
    """Probes at the points of a regular grid.

    Parameters
    ----------
    origin
        Where the first probe stands.
    spacing
        Distance to the next along x, y and z, positive.
    coefficients
        Lighting coefficients of every probe, `(X, Y, Z, *channels, K)`.
    gradients
        Their derivatives by x, y and z, if they are known: far better than values alone between
        the probes.

    Raises
    ------
    ArgumentError
        If a shape or range is another.
    """

    origin: Float[np.ndarray, "3"]
    spacing: Float[np.ndarray, "3"]
    coefficients: Float[np.ndarray, "X Y Z *channels_K"]
    gradients: Float[np.ndarray, "X Y Z *channels_K_3"] | None = None

    __repr__ = summary

    def __post_init__(self) -> None:
        origin = checks.finite("origin", self.origin)
        spacing = checks.finite("spacing", self.spacing)
        coefficients = checks.finite("coefficients", self.coefficients)
        if origin.shape != (3,) or spacing.shape != (3,) or not (spacing > 0).all():
            raise ArgumentError("origin and spacing must have shape (3,), spacing be positive")
        if coefficients.ndim < 4 or coefficients.size == 0:
            raise ArgumentError(
                f"coefficients must have shape (X, Y, Z, ..., K), got {coefficients.shape}"
            )
        max_degree_of(coefficients.shape[-1])
        if self.gradients is not None:
            gradients = checks.finite("gradients", self.gradients)
            if gradients.shape != (*coefficients.shape, 3):
                raise ArgumentError(
                    f"gradients must have shape (X, Y, Z, ..., K, 3) as the coefficients "
                    f"{coefficients.shape}, got {gradients.shape}"
                )
            object.__setattr__(self, "gradients", gradients)
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "spacing", spacing)
        object.__setattr__(self, "coefficients", coefficients)

    def at(self, points: Float[np.ndarray, "*points 3"]) -> Float[np.ndarray, "..."]:
        """Return the coefficients at points, from the eight probes around each.

        They are trilinear; with gradients, cubic along each axis (Hermite), so that values and
        gradients at the probes are theirs. A point outside the grid has the light of the nearest
        point on its surface.

        Parameters
        ----------
        points
            Positions in the unit of `spacing`, shape (..., 3).

        Returns
        -------
        numpy.ndarray
            `(*points, *channels, K)`.

        Raises
        ------
        ArgumentError
            If a position is not finite or the last axis is not of three.
        """
        points = checks.finite("points", checks.vectors("points", points))
        limits = np.array(self.coefficients.shape[:3]) - 1
        position = np.clip((points - self.origin) / self.spacing, 0, limits)
        low = np.minimum(position.astype(np.intp), np.maximum(limits - 1, 0))
        high = np.minimum(low + 1, limits)
        fraction = position - low
        if self.gradients is None:
            values = np.stack([1 - fraction, fraction])
        else:
            rise = fraction**2 * (3 - 2 * fraction)
            values = np.stack([1 - rise, rise])
            slopes = np.stack([fraction * (1 - fraction) ** 2, -(fraction**2) * (1 - fraction)])
            slopes *= self.spacing
        trailing = (1,) * (self.coefficients.ndim - 3)
        total = np.zeros((*points.shape[:-1], *self.coefficients.shape[3:]))
        for corner in np.ndindex(2, 2, 2):
            index = np.where(np.array(corner) == 1, high, low)
            probe = tuple(np.moveaxis(index, -1, 0))
            weights = [values[side, ..., axis] for axis, side in enumerate(corner)]
            weight = np.prod(weights, axis=0)
            total += weight.reshape(*weight.shape, *trailing) * self.coefficients[probe]
            if self.gradients is None:
                continue
            for axis, side in enumerate(corner):
                others = [slopes[side, ..., axis], *weights[:axis], *weights[axis + 1 :]]
                weight = np.prod(others, axis=0)
                total += weight.reshape(*weight.shape, *trailing) * self.gradients[probe][..., axis]
        return total.astype(self.coefficients.dtype)


@dataclass(frozen=True, eq=False)
class ScatteredProbes:
    """Probes anywhere in space.

    Parameters
    ----------
    positions
        Where each of `P` probes stands: four or more, not all in one plane.
    coefficients
        Lighting coefficients of each, `(P, *channels, K)`.

    Raises
    ------
    ArgumentError
        If a shape is another, or the probes lie in one plane.
    """

    positions: Float[np.ndarray, "P 3"]
    coefficients: Float[np.ndarray, "P *channels_K"]

    __repr__ = summary

    def __post_init__(self) -> None:
        positions = checks.finite("positions", checks.vectors("positions", self.positions))
        coefficients = checks.finite("coefficients", self.coefficients)
        if positions.ndim != 2 or coefficients.ndim < 2 or len(positions) != len(coefficients):
            raise ArgumentError(
                "positions (P, 3) and coefficients (P, ..., K) must agree in P, got shapes "
                f"{positions.shape} and {coefficients.shape}"
            )
        max_degree_of(coefficients.shape[-1])
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "coefficients", coefficients)
        self._inside  # noqa: B018 - refuses probes that span no volume

    def at(self, points: Float[np.ndarray, "*points 3"]) -> Float[np.ndarray, "..."]:
        """Return the coefficients at points, linear in the tetrahedra that the probes span.

        A point outside all of them has the light of the nearest probe.

        Parameters
        ----------
        points
            Positions in the unit of `positions`, shape (..., 3).

        Returns
        -------
        numpy.ndarray
            `(*points, *channels, K)`.

        Raises
        ------
        ArgumentError
            If a position is not finite or the last axis is not of three.
        """
        points = checks.finite("points", checks.vectors("points", points))
        flat = points.reshape(-1, 3)
        light = self._inside(flat)
        outside = np.isnan(light).reshape(len(flat), -1).any(axis=-1)
        light[outside] = self._nearest(flat[outside])
        light = light.reshape(*points.shape[:-1], *self.coefficients.shape[1:])
        return light.astype(self.coefficients.dtype)

    @cached_property
    def _inside(self) -> "LinearNDInterpolator":
        from scipy.interpolate import LinearNDInterpolator  # takes half a second to load
        from scipy.spatial import QhullError

        try:
            return LinearNDInterpolator(self.positions, self.coefficients)
        except (QhullError, ValueError):
            raise ArgumentError(
                "positions must be four or more points, not all in one plane; a single layer of "
                "probes needs a second one above it"
            ) from None

    @cached_property
    def _nearest(self) -> "NearestNDInterpolator":
        from scipy.interpolate import NearestNDInterpolator

        return NearestNDInterpolator(self.positions, self.coefficients)
