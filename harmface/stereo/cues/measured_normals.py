"""Cue: normals that were measured at some pixels."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.homogeneous import directions_of


@dataclass(frozen=True, eq=False)
class MeasuredNormals:
    """Difference of the normals to those measured.

    Parameters
    ----------
    v
        Structure where they were measured.
    normals
        Unit normals.
    """

    v: Float[np.ndarray, "k d"]
    normals: Float[np.ndarray, "k 3"]
    name: str = "known normals"
    floor: float = 0.02
    believable: float = np.inf
    # What was measured comes before what is likely.
    votes: float = 10 * VOTES

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return n less the normal measured, component by component."""
        return np.asarray((directions_of(self.v @ rows.T) - self.normals).ravel())
