"""Photographs of other people brought into the frame of a gallery."""

import cv2
import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.normalizers import tan_triggs

FRACTIONS = np.geomspace(0.3, 1.0, 25)
"""Heights of a gallery's frame that are tried, as fractions of the others' height: 5 % apart."""


def in_frame_of(gallery: Gallery, others: Photographs) -> Photographs:
    """Return the part of other people's photographs that a gallery's frame shows.

    The frame is where the mean face of the gallery correlates best with that of the others, over
    places and sizes, after `tan_triggs`, which leaves features and takes off light.

    Parameters
    ----------
    gallery
        Photographs of faces, cropped alike.
    others
        Photographs that show at least as much of the head, alike framed.

    Returns
    -------
    Photographs
        Of the size of the gallery's.

    Raises
    ------
    ArgumentError
        If the gallery's frame is larger than the others' at any size.
    """
    rows, columns = gallery.mask.shape
    wanted = _mean_face(gallery.photographs.images)
    seen = others.images.mean(axis=0)
    best, chosen = -np.inf, None
    for fraction in FRACTIONS:
        scale = rows / (fraction * seen.shape[0])
        size = (round(seen.shape[1] * scale), round(seen.shape[0] * scale))
        if size[0] < columns or size[1] < rows:
            continue
        resized = cv2.resize(seen, size, interpolation=cv2.INTER_AREA)
        map_ = cv2.matchTemplate(_mean_face(resized[None]), wanted, cv2.TM_CCOEFF_NORMED)
        if map_.max() > best:
            best = float(map_.max())
            chosen = (size, np.unravel_index(map_.argmax(), map_.shape))
    if chosen is None:
        raise ArgumentError(
            f"the gallery's frame of {rows} x {columns} pixels must fit into that of the other "
            f"people, {seen.shape[0]} x {seen.shape[1]}; crop to the face"
        )
    size, (top, left) = chosen
    cut = [
        cv2.resize(image, size, interpolation=cv2.INTER_AREA)[
            top : top + rows, left : left + columns
        ]
        for image in others.images
    ]
    return Photographs(others.subjects, np.stack(cut))


def _mean_face(images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "H W"]:
    return tan_triggs(images).mean(axis=0).astype(np.float32)
