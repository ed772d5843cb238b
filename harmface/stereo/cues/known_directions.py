"""Cue: the directions to the lamps were measured."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.homogeneous import directions_of


@dataclass(frozen=True, eq=False)
class KnownDirections:
    """Chord between the direction of a lamp and the one measured.

    Parameters
    ----------
    lamps
        In coordinates of v: the lamp of `b = T v` is `lamps T^-1`.
    directions
        Unit vectors that were measured.
    weights
        Share of the pixels that each lights, relative to the mean: a lamp that lights few pixels
        is known badly.
    """

    lamps: Float[np.ndarray, "F 3"]
    directions: Float[np.ndarray, "F 3"]
    weights: Float[np.ndarray, "F"]
    name: str = "known directions"
    # A third of a degree: a chrome ball is read no better.
    floor: float = 0.005
    believable: float = np.inf
    votes: float = 2 * VOTES

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return the differences of the unit vectors, component by component."""
        apart = directions_of(self.lamps @ np.linalg.inv(rows)) - self.directions
        return np.asarray((np.sqrt(self.weights)[:, None] * apart).ravel())

    def start(self) -> Rows:
        """Return the map whose lamps are along the directions in least squares.

        `d_i x (A^T l_i) = 0` is linear and homogeneous in A = T^-1.
        """
        # Row i of the matrix of a cross product with d.
        across = np.cross(self.directions[:, None], np.eye(3)[None]).swapaxes(1, 2)
        design = np.einsum("fim,fk->fikm", across, self.lamps) * self.weights[:, None, None, None]
        back = np.linalg.svd(design.reshape(-1, 9))[2][-1].reshape(3, 3)
        sign = np.sign(((self.lamps @ back) * self.directions).sum())
        return np.linalg.inv(back * sign)
