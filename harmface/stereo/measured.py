"""Pixels of known normals, looked at one by one beside blocks of pixels.

Blocks are means over surfaces that may bend within them, hair and eyes most, while a normal was
measured at a point. So the pixels that were measured are kept as columns of their own. They are
averaged with their neighbours as far as that changes them by no more than noise does.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int

from harmface.stereo.cues import KnownNormals
from harmface.stereo.robust import robust_scale
from harmface.stereo.stack import ImageStack

REACHES = (1, 2, 4, 8)
"""Pixels that means are tried to reach. Their weights fall linearly, so what varies linearly keeps
its value."""

DEVIATIONS = 3.0
"""Standard deviations by which a change may exceed that expected of noise."""

SAMPLE = 4096
"""Places that tell the noise."""


def beside(
    blocks: ImageStack, stack: ImageStack, known: KnownNormals
) -> tuple[ImageStack, KnownNormals]:
    """Return blocks with a column more for each known normal, and the normals at these columns.

    Parameters
    ----------
    blocks
        Means over blocks of pixels.
    stack
        The pixels.
    known
        Normals at columns of the stack.
    """
    extended = replace(
        blocks,
        values=np.concatenate([blocks.values, _smoothed(stack, known.columns)], axis=1),
        seen=np.concatenate([blocks.seen, stack.seen[:, known.columns]], axis=1),
        usable=np.concatenate([blocks.usable, stack.usable[:, known.columns]], axis=1),
    )
    return extended, replace(known, columns=np.arange(blocks.values.shape[1], len(extended.seen.T)))


def _smoothed(stack: ImageStack, columns: Int[np.ndarray, "k"]) -> Float[np.ndarray, "F k"]:
    """Return the values of pixels, each the widest mean that is still that of its pixel."""
    here = stack.values[:, columns]
    noise = _noise_variance(stack)
    most = 1 + DEVIATIONS * np.sqrt(2 / len(here))
    found, even = here.copy(), np.ones(len(columns), dtype=bool)
    for reach in REACHES:
        tent = (1 + reach - np.abs(np.arange(-reach, reach + 1))) / (1 + reach) ** 2
        shares = np.outer(tent, tent)
        mean, whole = _mean(stack, columns, shares)
        # The pixel is in the mean, too.
        expected = noise * (1 - 2 * shares.max() + (shares**2).sum())
        even &= whole & (((here - mean) ** 2).mean(axis=0) <= most * expected)
        found[:, even] = mean[:, even]
    return found


def _mean(
    stack: ImageStack, columns: Int[np.ndarray, "k"], shares: Float[np.ndarray, "n n"]
) -> tuple[Float[np.ndarray, "F k"], Bool[np.ndarray, "k"]]:
    """Return means over windows about pixels, and whether all of a window is in the mask."""
    reach = len(shares) // 2
    index = np.pad(_index(stack), reach, constant_values=-1)
    rows, places = np.argwhere(stack.mask)[columns].T
    mean, whole = np.zeros((len(stack.values), len(columns))), np.ones(len(columns), dtype=bool)
    for (down, right), share in np.ndenumerate(shares):
        # The window's upper left corner has the pixel's own row and column in the padded index.
        near = index[rows + down, places + right]
        whole &= near >= 0
        mean += share * stack.values[:, near]
    return mean, whole


def _noise_variance(stack: ImageStack) -> float:
    """Return the variance of noise, by how pixels differ from the mean of both sides."""
    index = _index(stack)
    triples = np.stack([index[:, :-2], index[:, 1:-1], index[:, 2:]], axis=-1).reshape(-1, 3)
    triples = triples[(triples >= 0).all(axis=1)]
    left, here, right = triples[:: max(1, len(triples) // SAMPLE)].T
    apart = stack.values[:, here] - (stack.values[:, left] + stack.values[:, right]) / 2
    return robust_scale(apart) ** 2 / 1.5 if apart.size else 0.0


def _index(stack: ImageStack) -> Int[np.ndarray, "H W"]:
    """Return the column of each pixel, -1 outside the mask."""
    return stack.picture(np.arange(stack.values.shape[1]), -1)
