"""A smaller stack in which what all pixels share can be found quickly."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import distance_transform_edt

from harmface.stereo.stack import ImageStack, index_of

MOST_PIXELS = 6000
"""Pixels that settle a few dozen numbers; more only cost time."""


def coarse_factor(mask: Bool[np.ndarray, "H W"]) -> int:
    """Return the side of the blocks that leave at most `MOST_PIXELS` of a mask."""
    return max(1, int(np.ceil(np.sqrt(mask.sum() / MOST_PIXELS))))


def coarse_stack(stack: ImageStack, factor: int) -> ImageStack:
    """Return the stack averaged over blocks of pixels that lie whole in the mask.

    Averaging is linear in b, so a block's structure is that of its mean b, and the noise falls
    with the side of the block.

    Parameters
    ----------
    stack
        Images.
    factor
        Side of a block; 1 returns the stack itself.
    """
    if factor == 1:
        return stack
    rows, columns = (side // factor for side in stack.mask.shape)
    inner = stack.mask[: rows * factor, : columns * factor]
    whole = np.asarray(inner.reshape(rows, factor, columns, factor).all(axis=(1, 3)))
    block = np.full((rows, columns), -1)
    block[whole] = np.arange(whole.sum())
    spread = np.full(stack.mask.shape, -1)
    spread[: rows * factor, : columns * factor] = block.repeat(factor, 0).repeat(factor, 1)
    place = spread[stack.mask]
    inside = place >= 0
    # Sorted by block, every block is a run of equal length.
    order = np.flatnonzero(inside)[np.argsort(place[inside], kind="stable")]
    values = np.stack([image[order].reshape(-1, factor**2).mean(axis=1) for image in stack.values])

    def everywhere(flags: Bool[np.ndarray, "F p"]) -> Bool[np.ndarray, "F c"]:
        return np.stack([image[order].reshape(-1, factor**2).all(axis=1) for image in flags])

    return ImageStack(values, whole, everywhere(stack.seen), everywhere(stack.usable))


def spread_over(
    coarse: Float[np.ndarray, "c d"],
    coarse_structure: Float[np.ndarray, "K c"],
    structure: Float[np.ndarray, "K p"],
) -> Float[np.ndarray, "p d"]:
    """Return values of the fine pixels by the linear map that gives those of the blocks."""
    rows, *_ = np.linalg.lstsq(coarse_structure.T, coarse, rcond=None)
    return structure.T @ rows


def nearest_blocks(
    columns: Int[np.ndarray, "k"],
    mask: Bool[np.ndarray, "H W"],
    coarse_mask: Bool[np.ndarray, "h w"],
    factor: int,
) -> Int[np.ndarray, "k"]:
    """Return for pixels of a mask their block, or the nearest that is whole.

    Parameters
    ----------
    columns
        Index of the pixels among the masked ones.
    mask, coarse_mask
        Pixels, and blocks of them that are whole.
    factor
        Side of a block.
    """
    row, column = distance_transform_edt(~coarse_mask, return_distances=False, return_indices=True)
    # Beyond the last whole block there may be a strip of pixels.
    last = np.array(coarse_mask.shape) - 1
    block = tuple(np.minimum(np.argwhere(mask)[columns] // factor, last).T)
    index = index_of(coarse_mask)
    return np.asarray(index[row[block], column[block]])
