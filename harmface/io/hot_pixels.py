"""Single pixels of a photograph that the sensor, not the object, made bright."""

import numpy as np
from jaxtyping import Float
from scipy.ndimage import maximum_filter, median_filter

ABOVE = 1.5
"""Times by which a hot pixel outshines its neighbours: a lens spreads what it sees over more than
one pixel, so that the brightest pixel of what is in focus does not."""

DIM = 0.1
"""Value, relative to the 99th percentile, below which noise makes the brightest among neighbours,
and a wrong observation matters little."""

_AROUND = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], dtype=bool)


def without_hot_pixels(
    images: Float[np.ndarray, "F H W"],
) -> tuple[Float[np.ndarray, "F H W"], int]:
    """Return photographs whose hot pixels have the median of their neighbours, and how many.

    Hot is what outshines all its neighbours as it does in no other photograph: a bright speck of
    the object does so in most. Robust fits leave a wrong observation out of many, but of three to
    five photographs it decides.

    Parameters
    ----------
    images
        Linear photographs of one view.
    """
    least = DIM * float(np.percentile(images[:, ::4, ::4], 99))
    least = max(least, float(np.finfo(np.float32).tiny))
    ratio = np.stack(
        [each / np.maximum(maximum_filter(each, footprint=_AROUND), least) for each in images]
    )
    hot = ratio > ABOVE * np.maximum(np.median(ratio, axis=0), 1)
    mended = images.copy()
    for here, image, each in zip(hot, images, mended, strict=True):
        if here.any():
            each[here] = median_filter(image, footprint=_AROUND)[here]
    return mended, int(hot.sum())
