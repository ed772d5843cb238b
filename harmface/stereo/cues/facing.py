"""Cue: what the camera sees does not look away from it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField
from harmface.stereo.homogeneous import directions_of


@dataclass(frozen=True, eq=False)
class Facing:
    """The part of unit normals that leads away from the viewer.

    Parameters
    ----------
    v
        Structure in each cell.
    """

    v: Float[np.ndarray, "c d"]
    name: str = "facing the camera"
    # Three degrees: noise may turn a normal on the rim so far.
    floor: float = 0.05
    believable: float = np.inf
    votes: float = VOTES

    @classmethod
    def of(cls, seen: StructureField) -> "Facing":
        """Return the cue for a field."""
        return cls(seen.middle)

    def residuals(self, rows: Rows) -> Float[np.ndarray, "c"]:
        """Return `min(n_z, 0)`."""
        return np.minimum(directions_of(self.v @ rows.T)[:, 2], 0)
