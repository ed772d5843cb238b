"""Cue: the object is symmetric about a vertical plane that the viewer looks along.

Unit normals are compared, since albedo need not be symmetric, and each component against its own
spread, so that none gains by vanishing everywhere.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.stack import index_of

PAIRS = 600


@dataclass(frozen=True, eq=False)
class Symmetry:
    """Difference of a normal to the mirror image of its counterpart's.

    Parameters
    ----------
    left, right
        Structure at pairs of pixels.
    """

    left: Float[np.ndarray, "n d"]
    right: Float[np.ndarray, "n d"]
    name: str = "symmetry"
    floor: float = 0.05
    believable: float = np.inf
    votes: float = 3 * VOTES

    @classmethod
    def of(cls, seen: StructureField) -> "Symmetry":
        """Return the cue for a field, mirrored about the middle column of its mask."""
        here, there = mirrored_pixels(seen.mask)
        some = slice(None, None, max(1, len(here) // PAIRS))
        return cls(seen.smoothed[here[some]], seen.smoothed[there[some]])

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return the differences over the spread of each component."""
        here, there = directions_of(self.left @ rows.T), directions_of(self.right @ rows.T)
        spread = here.std(axis=0) + np.finfo(np.float64).tiny
        return np.asarray(((here - there * (-1, 1, 1)) / spread).ravel())


def mirrored_pixels(mask: Bool[np.ndarray, "H W"]) -> tuple[np.ndarray, np.ndarray]:
    """Return the index of pixels, and of their mirror images, about a mask's middle column."""
    columns = np.flatnonzero(mask.any(axis=0))
    index = index_of(mask)
    rows, here = np.nonzero(mask)
    there = columns[0] + columns[-1] - here
    inside = (there >= 0) & (there < mask.shape[1])
    mirrored = np.where(inside, index[rows, there.clip(0, mask.shape[1] - 1)], -1)
    return np.flatnonzero(mirrored >= 0), mirrored[mirrored >= 0]
