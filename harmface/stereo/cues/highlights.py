"""Cue: a highlight lies where the normal halves the angle between the lamp and the viewer.

The brightest of what an image shows beyond its diffuse prediction is a mirror image of the lamp:
there n is along `l / |l| + (0, 0, 1)`. How strong lamps are does not matter. What interreflection
adds, or a bad prediction, is of no such place, so the cue holds only if most highlights agree.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion, gaussian_filter

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import RIM_WIDTH, SMOOTHING, StructureField
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.robust import robust_scale
from harmface.stereo.stack import index_of, picture

BRIGHT = 8.0
"""Deviations of the noise by which the top of a highlight exceeds the diffuse prediction."""

FEWEST = 6
"""Highlights below which they say nothing."""


@dataclass(frozen=True, eq=False)
class Highlights:
    """Chord between the normal at a highlight and the half vector.

    Parameters
    ----------
    v
        Structure at the brightest place of each highlight.
    lamps
        The lamp of its image, in coordinates of v.
    """

    v: Float[np.ndarray, "n 3"]
    lamps: Float[np.ndarray, "n 3"]
    name: str = "highlights"
    floor: float = 0.02
    # Wider apart, most of them are no highlights.
    believable: float = 0.08
    votes: float = VOTES

    @classmethod
    def of(
        cls,
        seen: StructureField,
        lamps: Float[np.ndarray, "F 3"],
        beyond: Float[np.ndarray, "F p"],
        shown: Bool[np.ndarray, "F p"],
    ) -> "Highlights | None":
        """Return the cue, or None if there are too few highlights.

        Parameters
        ----------
        seen, lamps
            Structure and lamps.
        beyond
            What each image shows beyond its diffuse prediction.
        shown
            Observations that a highlight may be among, the saturated ones too.
        """
        least = BRIGHT * robust_scale(beyond[shown])
        inner = binary_erosion(seen.mask, iterations=RIM_WIDTH)
        index = index_of(seen.mask)
        places, sources = [], []
        for lamp, image, allowed in zip(lamps, beyond, shown, strict=True):
            blurred = gaussian_filter(picture(image * allowed, seen.mask), SMOOTHING) * inner
            top = np.unravel_index(blurred.argmax(), blurred.shape)
            if blurred[top] > least:
                places.append(index[top])
                sources.append(lamp)
        if len(places) < FEWEST:
            return None
        return cls(seen.smoothed[np.array(places)], np.stack(sources))

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return |n - h|, h the unit half vector."""
        normals = directions_of(self.v @ rows.T)
        towards = directions_of(self.lamps @ np.linalg.inv(rows))
        half = directions_of(towards + np.array([0, 0, 1]))
        return np.asarray(np.linalg.norm(normals - half, axis=1))
