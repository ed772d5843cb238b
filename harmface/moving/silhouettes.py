"""Masks of an object that moves before a background of other colours."""

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_fill_holes, gaussian_filter
from skimage.filters import apply_hysteresis_threshold, threshold_otsu
from skimage.measure import label

from harmface.errors import ArgumentError
from harmface.stereo import object_mask

BORDER = 4
"""Width of the rim of the picture that is taken to show background, in pixels."""

COLOURS = 8
"""Colours of the background at most."""

DARK = 0.02
"""Brightness below which a pixel has hardly a hue, as a fraction of white."""


def silhouettes(frames: Float[np.ndarray, "F H W *channels"]) -> Bool[np.ndarray, "F H W"]:
    """Return masks of what stands out of the background, frame by frame.

    Before a dark background that is what is bright; else, in colour, the largest part whose hue
    is far from all hues at the rim of the frames, holes filled.

    Parameters
    ----------
    frames
        Linear; in colour with the channels last.

    Returns
    -------
    numpy.ndarray
        A mask a frame.

    Raises
    ------
    ArgumentError
        If nothing stands out.
    """
    grey = frames.mean(axis=-1) if frames.ndim == 4 else frames
    dark = [object_mask(frame[None]) for frame in grey]
    found = [mask for mask in dark if mask is not None]
    if len(found) < len(frames):
        if frames.ndim != 4:
            raise ArgumentError(
                "frames show no dark background that an object stands out of; give --mask"
            )
        found = _by_hue(frames)
    return np.stack(found)


def _by_hue(frames: Float[np.ndarray, "F H W 3"]) -> list[Bool[np.ndarray, "H W"]]:
    hue = (frames / (frames.sum(axis=-1, keepdims=True) + DARK)).astype(np.float32)
    rim = np.ones(hue.shape[1:3], bool)
    rim[BORDER:-BORDER, BORDER:-BORDER] = False
    samples = hue[:, rim].reshape(-1, 3)[::7]
    criteria = (cv2.TERM_CRITERIA_MAX_ITER, 20, 0.0)
    cv2.setRNGSeed(0)
    _, _, centers = cv2.kmeans(samples, COLOURS, None, criteria, 1, cv2.KMEANS_PP_CENTERS)
    far = np.stack([np.linalg.norm(hue - center, axis=-1) for center in np.asarray(centers)]).min(
        axis=0
    )
    far = np.stack([gaussian_filter(each, 0.7) for each in far])
    high = threshold_otsu(far)
    masks = []
    for each in far:
        # What is pale counts where it touches what is not.
        standing = apply_hysteresis_threshold(each, high / 2, high)
        parts = label(binary_fill_holes(standing))
        sizes = np.bincount(parts.ravel())[1:]
        if len(sizes) == 0:
            raise ArgumentError("frames show nothing that stands out of their rim; give --mask")
        masks.append(parts == 1 + int(sizes.argmax()))
    return masks
