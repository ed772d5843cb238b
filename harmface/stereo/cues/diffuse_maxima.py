"""Cue: where the diffuse prediction of an image has a maximum, the normal is along the lamp.

At a maximum of `b . l` within a region of one albedo, on a surface that bends both ways, n . l is
greatest, so n is parallel to l ([FP12]_). How strong the lamps are does not matter. Maxima that an
edge of the albedo or a dent makes are the tails.

References
----------
.. [FP12] Favaro and Papadhimitri, A Closed-Form Solution to Uncalibrated Photometric Stereo via
   Diffuse Maxima, CVPR 2012.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import binary_erosion, maximum_filter

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import RIM_WIDTH, StructureField
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.stack import index_of, picture

WINDOW = 9
"""Side of the window, pixels, in which a maximum is the greatest value."""

FEWEST = 6
"""Maxima below which they say nothing: twice the numbers of a bas-relief transformation."""


@dataclass(frozen=True, eq=False)
class DiffuseMaxima:
    """Chord between the normal at a maximum and the lamp.

    Parameters
    ----------
    v
        Structure at each maximum.
    lamps
        The lamp of its image, in coordinates of v.
    """

    v: Float[np.ndarray, "n 3"]
    lamps: Float[np.ndarray, "n 3"]
    name: str = "diffuse maxima"
    floor: float = 0.03
    # Half the chord of unrelated directions.
    believable: float = 0.7
    votes: float = VOTES

    @classmethod
    def of(cls, seen: StructureField, lamps: Float[np.ndarray, "F 3"]) -> "DiffuseMaxima | None":
        """Return the cue, or None if there are too few maxima."""
        inner = binary_erosion(seen.mask, iterations=RIM_WIDTH)
        index = index_of(seen.mask)
        places, sources = [], []
        for lamp in lamps:
            image = picture(seen.smoothed @ lamp, seen.mask, -np.inf)
            highest = (maximum_filter(image, WINDOW) == image) & inner & (image > 0)
            places.append(index[highest])
            sources.append(np.broadcast_to(lamp, (int(highest.sum()), 3)))
        found = np.concatenate(places)
        if len(found) < FEWEST:
            return None
        return cls(seen.smoothed[found], np.concatenate(sources))

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return |n - l / |l||."""
        normals = directions_of(self.v @ rows.T)
        towards = directions_of(self.lamps @ np.linalg.inv(rows))
        return np.asarray(np.linalg.norm(normals - towards, axis=1))
