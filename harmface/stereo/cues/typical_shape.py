"""Cue: how the normals of an object are spread, as of most objects.

A body seen whole has its outline at about one depth, so its slopes, and with them n_x and n_y, are
zero on average; that of n_z is 2/3 for a hemisphere over a disc, pi / 4 for half a cylinder. Where
the border of the mask is that of the picture, the steep rim is out of sight: over the square
inscribed in the disc the mean of n_z is 0.81. It is a weak prior that keeps the answer among
surfaces which objects have, where nothing else decides.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion

from harmface.stereo.cues.cue import Rows
from harmface.stereo.cues.field import StructureField
from harmface.stereo.homogeneous import directions_of

WHOLE, CROPPED = 0.667, 0.81
"""Mean n_z of a hemisphere over its disc, and over the square inscribed in it."""

SPREAD = np.array([0.1, 0.1, 0.07])
"""By which means of n differ between objects: six degrees of tilt, and the difference between a
hemisphere and half a cylinder."""

PIXELS = 600


@dataclass(frozen=True, eq=False)
class TypicalShape:
    """Mean normal less the typical one, in units of its spread.

    Parameters
    ----------
    v
        Structure of pixels spread over the object.
    towards
        Typical mean of n_z.
    """

    v: Float[np.ndarray, "p d"]
    towards: float
    name: str = "typical shape"
    floor: float = 1.0
    believable: float = np.inf
    votes: float = 3.0

    @classmethod
    def of(cls, seen: StructureField) -> "TypicalShape":
        """Return the cue for a field."""
        some = np.linspace(0, len(seen.structure) - 1, min(len(seen.structure), PIXELS))
        cropped = border_share(seen.mask)
        return cls(seen.structure[some.astype(int)], WHOLE + cropped * (CROPPED - WHOLE))

    def residuals(self, rows: Rows) -> Float[np.ndarray, "3"]:
        """Return the mean of n less (0, 0, towards), over the spread."""
        mean = directions_of(self.v @ rows.T).mean(axis=0)
        return np.asarray((mean - (0, 0, self.towards)) / SPREAD)


def border_share(mask: Bool[np.ndarray, "H W"]) -> float:
    """Return the share of a mask's rim that lies on the border of the picture."""
    rim = mask & ~binary_erosion(mask)
    border = np.ones_like(mask)
    border[1:-1, 1:-1] = False
    return float((rim & border).sum() / max(1, rim.sum()))
