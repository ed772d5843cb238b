"""The object in photographs that come without a mask: what stands out of a dark background."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_fill_holes, binary_opening, label
from skimage.filters import threshold_otsu

DARK_BORDER = 0.8
"""Share of the picture's border that must be background for it to be believed."""

LEAST, MOST = 0.02, 0.95
"""Shares of the picture that an object in front of a background takes."""

CONTRAST = 4.0
"""Times by which the object is brighter than the background, by medians."""


def object_mask(images: Float[np.ndarray, "F H W"]) -> Bool[np.ndarray, "H W"] | None:
    """Return the object in front of a dark background, or None if there is no such background.

    The object is lit by some lamp: its brightest values over the images stand out, by Otsu's
    threshold of their logarithms. The largest connected part counts, its holes filled, and only if
    nearly all of the picture's border is dark.

    Parameters
    ----------
    images
        Linear photographs.

    Returns
    -------
    numpy.ndarray or None
        True on the object.
    """
    brightest = np.asarray(images).max(axis=0).astype(np.float64)
    if not brightest.any():
        return None
    logarithm = np.log(brightest + 1e-3 * brightest.max())
    bright = logarithm > threshold_otsu(logarithm)
    parts, count = label(binary_opening(bright))
    if not count:
        return None
    largest = parts == 1 + np.bincount(parts[parts > 0] - 1).argmax()
    found = np.asarray(binary_fill_holes(largest))
    border = np.concatenate([found[0], found[-1], found[:, 0], found[:, -1]])
    if not LEAST < found.mean() < MOST or 1 - border.mean() < DARK_BORDER:
        return None
    apart = np.median(brightest[found]) / max(float(np.median(brightest[~found])), 1e-300)
    return found if apart > CONTRAST else None
