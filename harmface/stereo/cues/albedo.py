"""Cue: albedo is of few values, so that between its edges it does not change.

With a wrong map the shading is not taken out of the albedo, which then changes wherever the normal
does. The residuals are the derivatives of log |b|; edges and texture are the tails.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField


@dataclass(frozen=True, eq=False)
class Albedo:
    """Change of log albedo from pixel to pixel.

    Parameters
    ----------
    v, along_x, along_y
        Structure and its derivatives, in each cell.
    """

    v: Float[np.ndarray, "c d"]
    along_x: Float[np.ndarray, "c d"]
    along_y: Float[np.ndarray, "c d"]
    name: str = "albedo"
    floor: float = 0.001
    # A texture that changes by more hides the shading.
    believable: float = 0.1
    votes: float = VOTES

    @classmethod
    def of(cls, seen: StructureField) -> "Albedo":
        """Return the cue for a field, its border left out."""
        inner = seen.inner if seen.inner.any() else ~seen.inner
        return cls(seen.middle[inner], seen.along_x[inner], seen.along_y[inner])

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return `b . db / |b|^2` along x and y."""
        b = self.v @ rows.T
        squared = np.maximum((b**2).sum(axis=1), np.finfo(np.float64).tiny)
        each = [
            (b * (derivative @ rows.T)).sum(axis=1) / squared
            for derivative in (self.along_x, self.along_y)
        ]
        return np.concatenate(each)
