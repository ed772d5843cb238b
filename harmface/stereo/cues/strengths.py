"""Cue: lamps are of about one strength.

Where one lamp is moved about, or several are alike, a map under which some seem far stronger is
wrong. The learned scale lets lamps be equal, alike or free; whether the cue holds at all is tested,
since the strengths of lamps that differ say nothing.

A lamp that lights few pixels is known badly and weighs by the share that it lights.

References
----------
.. [H94] Hayakawa, Photometric Stereo under a Light Source with Arbitrary Motion, JOSA A 1994.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows


@dataclass(frozen=True, eq=False)
class Strengths:
    """Logarithms of the lamps' strengths about their mean.

    Parameters
    ----------
    lamps
        In coordinates of v: the lamp of `b = T v` is `lamps T^-1`.
    weights
        Share of the pixels that each lights, relative to the mean.
    votes
        One a lamp, as far as they are not many: those side by side err together.
    """

    lamps: Float[np.ndarray, "F 3"]
    weights: Float[np.ndarray, "F"]
    votes: float
    name: str = "equal lamps"
    floor: float = 0.02
    # One lamp keeps its strength, and lamps of a kind are alike, to a tenth.
    believable: float = 0.1

    @classmethod
    def of(cls, lamps: Float[np.ndarray, "F 3"], lit: Float[np.ndarray, "F"]) -> "Strengths":
        """Return the cue for lamps and the share of the pixels that each lights."""
        return cls(lamps, lit / max(float(lit.mean()), 1e-12), min(len(lamps), VOTES))

    def residuals(self, rows: Rows) -> Float[np.ndarray, "F"]:
        """Return `sqrt(w) (log |l| - mean)`."""
        strength = np.linalg.norm(self.lamps @ np.linalg.inv(rows), axis=1)
        log = np.log(np.maximum(strength, np.finfo(np.float64).tiny))
        mean = (self.weights * log).sum() / self.weights.sum()
        return np.sqrt(self.weights) * (log - mean)
