"""Cue: on an occluding outline the normal is in the image plane, across the outline.

Photographs blur the rim with what lies behind it, and the steepest pixels are dark, so how far a
normal leans there is not to be relied on: asking for it steepens the surface. Which way it leans
is not affected by that. The residual is the angle, in the image plane, between the normal a little
inside the outline and the outline's own normal.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion, gaussian_filter

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.stack import index_of

FEWEST = 16
"""Pixels below which an outline says nothing."""

LEAN = 0.05
"""Part of a unit normal in the image plane below which it leans nowhere: three degrees."""

LIT = 0.6
"""Share of the images in which a pixel of the rim must be lit to be relied on."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Pixels along an occluding outline.

    Parameters
    ----------
    pixels
        Index among the masked pixels.
    outward
        Unit vectors in the image plane, x right and y up, away from the object.
    """

    pixels: Int[np.ndarray, "r"]
    outward: Float[np.ndarray, "r 2"]


def outline_of(mask: Bool[np.ndarray, "H W"]) -> Outline:
    """Return the pixels next to the rim of a mask, where it is not the border of the picture.

    They are one pixel inside, since the rim itself is blurred with what is behind it. The outward
    direction is the slope of the blurred mask, so that it does not follow the steps of the pixels.

    Parameters
    ----------
    mask
        The object.
    """
    shrunk = binary_erosion(mask, border_value=1)
    rim = shrunk & ~binary_erosion(shrunk, border_value=1)
    blurred = gaussian_filter(mask.astype(np.float64), max(2.0, np.sqrt(mask.sum()) / 20))
    down, right = np.gradient(blurred)
    slope = -np.stack([right[rim], -down[rim]], axis=1)
    length = np.linalg.norm(slope, axis=1)
    sure = length > 0.1 * length.max(initial=0)
    return Outline(index_of(mask)[rim][sure], slope[sure] / length[sure, None])


@dataclass(frozen=True, eq=False)
class Rim:
    """Sine of the angle between where normals lean and the outline's normal.

    Parameters
    ----------
    v
        Structure near the rim.
    outward
        Unit vectors in the image plane.
    """

    v: Float[np.ndarray, "r d"]
    outward: Float[np.ndarray, "r 2"]
    name: str = "rim"
    floor: float = 0.02
    # Sine of 30 degrees: an outline that normals do not follow is a border, not a rim.
    believable: float = 0.5
    votes: float = VOTES

    @classmethod
    def of(cls, seen: StructureField) -> "Rim | None":
        """Return the cue, or None if the object has no outline in the picture."""
        outline = outline_of(seen.mask)
        lit = seen.lit[outline.pixels] > LIT
        if lit.sum() < FEWEST:
            return None
        return cls(seen.smoothed[outline.pixels[lit]], outline.outward[lit])

    def residuals(self, rows: Rows) -> Float[np.ndarray, "r"]:
        """Return the sine, less where the normal hardly leans at all."""
        n = directions_of(self.v @ rows.T)
        along = n[:, 1] * self.outward[:, 0] - n[:, 0] * self.outward[:, 1]
        across = (n[:, :2] * self.outward).sum(axis=1)
        return np.asarray(along / np.sqrt(along**2 + across**2 + LEAN**2))
