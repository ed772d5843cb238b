"""Radiance from every direction, as an image."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.distant_light import DistantLight
from harmface.light.layouts import Layout, layout_named
from harmface.summaries import summary

FRAME_TOLERANCE = 1e-6
"""Departure from orthogonality that float32 matrices may have."""


def check_frame(name: str, matrix: Float[np.ndarray, "..."]) -> Float[np.ndarray, "3 3"]:
    """Return `matrix` as float64 if it is orthogonal: a rotation, perhaps with a mirror."""
    matrix = np.asarray(checks.finite(name, matrix), dtype=np.float64)
    if matrix.shape != (3, 3) or np.abs(matrix @ matrix.T - np.eye(3)).max() > FRAME_TOLERANCE:
        raise ArgumentError(f"{name} must be an orthogonal 3 x 3 matrix, got {matrix.tolist()}")
    return matrix


@dataclass(frozen=True, eq=False)
class EnvironmentMap:
    """Distant radiance as a function of direction.

    Parameters
    ----------
    radiance
        Linear radiance, finite and not negative, `(*channels, *pixels)`: a grey lat-long map is
        `(H, 2 H)`, a cube in colour `(3, 6, N, N)`. Only the shape matters, not the order in
        memory, so `from_image` needs no copy.
    layout
        Where each pixel looks.
    frame
        Orthogonal matrix that carries the layout's directions into the world, the identity unless
        the map was made in another frame (see `harmface.conventions`) or was rotated.

    Raises
    ------
    ArgumentError
        If radiance is negative, NaN or infinite, its shape does not fit the layout, or the frame
        is not orthogonal.
    """

    radiance: Float[np.ndarray, "*channels_pixels"]
    layout: Layout
    frame: Float[np.ndarray, "3 3"] = field(default_factory=lambda: np.eye(3))

    __repr__ = summary

    def __post_init__(self) -> None:
        radiance = checks.floating("radiance", self.radiance)
        if radiance.size == 0:
            raise ArgumentError(f"radiance must hold some pixels, got shape {radiance.shape}")
        object.__setattr__(self, "radiance", radiance)
        object.__setattr__(self, "frame", check_frame("frame", self.frame))
        self.layout.height_of(self.pixels)
        # Least and largest value tell, and take no memory for a mask as large as the map.
        if not (radiance.min() >= 0 and radiance.max() < np.inf):
            checks.non_negative("radiance", radiance)

    @classmethod
    def from_image(
        cls,
        image: Float[np.ndarray, "..."],
        layout: str | Layout = "latlong",
        frame: Float[np.ndarray, "3 3"] | None = None,
    ) -> "EnvironmentMap":
        """Make a map from an image with its colour channels last, or with none.

        Parameters
        ----------
        image
            `(*pixels)` or `(*pixels, channels)`, for a cube `(6, N, N, channels)`.
        layout
            A layout or its name.
        frame
            As for the class.

        Raises
        ------
        ArgumentError
            If the image's shape is not one of the layout, or a value is negative or not finite.
        """
        layout = layout_named(layout)
        image = checks.floating("radiance", image)
        if image.ndim not in (layout.axes, layout.axes + 1):
            raise ArgumentError(
                f"image must have the {layout.axes} pixel axes of a {layout.name} map and at most "
                f"one axis of channels after them, got shape {image.shape}"
            )
        radiance = image if image.ndim == layout.axes else np.moveaxis(image, -1, 0)
        return cls(radiance, layout, np.eye(3) if frame is None else frame)

    @property
    def pixels(self) -> tuple[int, ...]:
        """The shape of the pixel axes."""
        return self.radiance.shape[-self.layout.axes :]

    @property
    def channels(self) -> tuple[int, ...]:
        """The shape of the axes before them."""
        return self.radiance.shape[: -self.layout.axes]

    @property
    def height(self) -> int:
        """Rows of the map, or of a cube's face."""
        return self.layout.height_of(self.pixels)

    @cached_property
    def directions(self) -> Float[np.ndarray, "*pixels 3"]:
        """The unit direction in the world that the centre of each pixel shows."""
        return self.layout.directions(self.height) @ self.frame.T

    @cached_property
    def solid_angles(self) -> Float[np.ndarray, "*pixels"]:
        """The exact solid angle of each pixel in steradians; they sum to 4 pi."""
        return self.layout.solid_angles(self.height)

    def as_image(self) -> Float[np.ndarray, "..."]:
        """Return the radiance with its channels last, `(*pixels, channels)`.

        Returns
        -------
        numpy.ndarray
            Shape `(*pixels,)` or `(*pixels, channels)`, a view where that is possible.

        Raises
        ------
        ArgumentError
            If the map has more than one axis of channels.
        """
        if len(self.channels) > 1:
            raise ArgumentError(f"an image has one axis of channels, got {self.channels}")
        return np.moveaxis(self.radiance, 0, -1) if self.channels else self.radiance

    def total(self) -> Float[np.ndarray, "*channels"]:
        """Return the integral of radiance over all directions, what RH01 calls total intensity.

        Returns
        -------
        numpy.ndarray
            Radiance times steradians, one number for each channel.
        """
        return np.tensordot(self.radiance, self.solid_angles, axes=self.layout.axes)

    def rotated(self, rotation: Float[np.ndarray, "3 3"]) -> "EnvironmentMap":
        """Return the map with its light turned: `d` now shows what `rotation.T @ d` did.

        Nothing is resampled; the frame turns.

        Parameters
        ----------
        rotation
            Rotation matrix, shape (3, 3).

        Returns
        -------
        EnvironmentMap
            With the same pixels and another frame.

        Raises
        ------
        ArgumentError
            If `rotation` is no rotation matrix.
        """
        return type(self)(
            self.radiance, self.layout, checks.rotation("rotation", rotation) @ self.frame
        )

    def as_distant_light(self, n_directions: int | None = None) -> DistantLight:
        """Return the map as a set of directional lights, for summing light without harmonics.

        Pixels are gathered in the cells of a coarse cube, whose angular sizes are nearly alike.
        Each cell becomes one light with all the power of its pixels, radiance times exact solid
        angle, at the centroid of that power: the total is kept exactly, and a small bright lamp
        stays where it is.

        Parameters
        ----------
        n_directions
            At most so many lights, at least 6; by default each pixel is its own.

        Returns
        -------
        DistantLight
            Irradiance at normal incidence of each direction: radiance times solid angle.

        Raises
        ------
        ArgumentError
            If fewer than six directions are asked for.
        """
        seen = self.solid_angles > 0
        directions, solid_angles = self.directions[seen], self.solid_angles[seen]
        irradiances = self.radiance[..., seen] * solid_angles
        if n_directions is None:
            return DistantLight(directions, irradiances)
        if checks.positive_integer("n_directions", n_directions) < 6:
            raise ArgumentError(f"n_directions must be 6 or more, got {n_directions}")
        return DistantLight(directions, irradiances).gathered(n_directions, solid_angles)
