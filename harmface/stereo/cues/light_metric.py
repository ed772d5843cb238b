"""Cue: what light allows of the map, told by how far the map is from an isometry.

Uniform light shows `a |b|`, which only rotations keep, and harmonic light of degree 1 the null
vectors (|b|, b), which Lorentz transformations keep: `T G T'` is a multiple of the identity, G
being the identity or `diag(-1, 1, 1, 1)`.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows


@dataclass(frozen=True, eq=False)
class LightMetric:
    """Departure of `T G T'` from a multiple of the identity, relative to it.

    Parameters
    ----------
    metric
        G.
    floor
        Departure that light which is not quite uniform, or not quite of degree 1, may cause.
    votes
        More the more of such light there is.
    """

    metric: Float[np.ndarray, "d d"]
    floor: float = 0.1
    votes: float = VOTES
    name: str = "uniform light"
    believable: float = np.inf

    def residuals(self, rows: Rows) -> Float[np.ndarray, "6"]:
        """Return the six numbers of the symmetric matrix."""
        return anisotropy(rows @ self.metric @ rows.T)


def anisotropy(product: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "6"]:
    """Return how far a symmetric matrix is from a multiple of the identity, relative to it."""
    scale = max(abs(float(np.trace(product))) / 3, np.finfo(np.float64).tiny)
    return np.asarray((product / scale - np.eye(3))[np.triu_indices(3)])
