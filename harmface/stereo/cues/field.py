"""The structure as cues look at it: smoothed, with its derivatives, and its noise."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion, gaussian_filter

from harmface.stereo.cues.cells import cells_of
from harmface.stereo.stack import picture

SMOOTHING = 1.5
"""Standard deviation, pixels, of the window that structure is averaged with: noise in raw
differences makes any surface look bent, which biases what they say of the map."""

CELLS = 600
"""Cells looked at: they fix a dozen numbers many times over."""

RIM_WIDTH = 3
"""Pixels along the border of the mask that are blurred with what is behind them."""


@dataclass(frozen=True, eq=False)
class StructureField:
    """Numbers v of each pixel, of which the scaled normals are an unknown linear map.

    Parameters
    ----------
    structure
        v.
    smoothed
        The same, averaged over neighbours.
    mask
        The pixels.
    lit
        Share of the images in which each pixel is lit.
    middle, along_x, along_y
        Smoothed structure at the middle of cells, and its derivatives there, per pixel.
    noise
        Standard deviation of these derivatives by noise, in whitened coordinates.
    inner
        Cells away from the border of the mask.
    """

    structure: Float[np.ndarray, "p d"]
    smoothed: Float[np.ndarray, "p d"]
    mask: Bool[np.ndarray, "H W"]
    lit: Float[np.ndarray, "p"]
    middle: Float[np.ndarray, "c d"]
    along_x: Float[np.ndarray, "c d"]
    along_y: Float[np.ndarray, "c d"]
    noise: Float[np.ndarray, "c"]
    inner: Bool[np.ndarray, "c"]


def structure_field(
    structure: Float[np.ndarray, "p d"],
    mask: Bool[np.ndarray, "H W"],
    lit: Float[np.ndarray, "p"],
    noise: Float[np.ndarray, "p"],
) -> StructureField:
    """Return the field of a structure.

    Parameters
    ----------
    structure, mask, lit
        See `StructureField`.
    noise
        Standard deviation of the structure's components at each pixel, in whitened coordinates.
    """
    smoothed = smooth(structure, mask)
    cells = cells_of(mask).thinned(CELLS)
    # White noise smoothed by a Gaussian of standard deviation s has derivatives of variance
    # 1 / (8 pi s^4) of its own.
    fall = 1 / np.sqrt(8 * np.pi) / SMOOTHING**2
    inner = binary_erosion(mask, iterations=RIM_WIDTH, border_value=1)[mask]
    return StructureField(
        structure,
        smoothed,
        mask,
        lit,
        cells.middle(smoothed),
        cells.along_x(smoothed),
        cells.along_y(smoothed),
        fall * cells.middle(noise[:, None])[:, 0],
        inner[cells.corners].all(axis=1),
    )


def smooth(
    values: Float[np.ndarray, "p d"], mask: Bool[np.ndarray, "H W"]
) -> Float[np.ndarray, "p d"]:
    """Return the mean about each pixel of those in the mask."""
    share = gaussian_filter(mask.astype(np.float64), SMOOTHING, mode="constant")[mask]
    each = [
        gaussian_filter(picture(channel, mask), SMOOTHING, mode="constant")[mask] / share
        for channel in values.T
    ]
    return np.stack(each, axis=1)
