"""Cue: the harmonic images of the scaled normals span the structure of nine dimensions.

If images are of degree 2, their structure is `v = A^-1 S` and the scaled normals b are linear in
it; the nine images S(b) then span v again.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField
from harmface.stereo.homogeneous import scaled_normal_images

PIXELS = 500


@dataclass(frozen=True, eq=False)
class Explained:
    """Part of a pixel's structure that lies outside the harmonic images, relative to it.

    Parameters
    ----------
    v
        Structure of unit length at pixels spread over the object.
    """

    v: Float[np.ndarray, "p 9"]
    name: str = "harmonic images"
    # Share of a pixel's values that light beyond degree 2 leaves, at most a third of the 9 % (root
    # of 0.8 % of the energy) that a single point does: images mix a few of them.
    floor: float = 0.03
    believable: float = np.inf
    votes: float = 3 * VOTES

    @classmethod
    def of(cls, seen: StructureField) -> "Explained":
        """Return the cue for a field of nine dimensions."""
        length = np.linalg.norm(seen.structure, axis=1)
        bright = np.flatnonzero(length > 0)
        some = bright[np.linspace(0, len(bright) - 1, min(len(bright), PIXELS)).astype(int)]
        return cls(seen.structure[some] / length[some, None])

    def residuals(self, rows: Rows) -> Float[np.ndarray, "p"]:
        """Return the lengths of what the images leave."""
        basis, _ = np.linalg.qr(scaled_normal_images(self.v @ rows.T, 2).T)
        return np.asarray(np.linalg.norm(self.v - basis @ (basis.T @ self.v), axis=1))
