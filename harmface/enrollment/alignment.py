"""Photographs of faces brought into one frame: by the eyes, and against a better-lit photograph.

Two points settle a similarity transform, so eyes bring faces of any size, turn and place into one
frame, and nothing is stretched. Under hard light eyes are hard to find to the pixel, or at all.
There a photograph is registered to another of the same sitting, in the strength of the gradient of
the logarithm against that around: features stay where they are, and what light does to a region as
a whole plays no part.
"""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.registration import Motion, register

EYES = np.array([[0.2, 0.27], [0.8, 0.27]])
"""Where the eyes come to lie, as fractions of the frame's width and height: the left one in the
picture first. It is the crop of the Extended Yale B photographs."""

FLOOR = 0.02
"""Added to intensities, as a fraction of the brightest, before the logarithm: noise in the dark."""

BLUR = 96
"""Deviations of the Gaussian before the gradient in the height of the frame."""

AROUND = 12
"""Deviations of the Gaussian that gradients are compared within, in the height of the frame."""

LARGEST = 2**15 - 1
"""Rows and columns that OpenCV warps."""

WEAK = 0.003
"""Gradient a pixel that counts half: what noise makes of even skin."""


def frame_to_photograph(
    eyes: Float[np.ndarray, "2 2"], size: tuple[int, int]
) -> Float[np.ndarray, "2 3"]:
    """Return the similarity that maps places (x, y) of the frame to those of a photograph.

    Places are in pixels from the top left corner: centres of pixels lie at half-integers.

    Parameters
    ----------
    eyes
        Where the eyes are in the photograph, the left one in the picture first.
    size
        Rows and columns of the frame.

    Returns
    -------
    numpy.ndarray
        Shape (2, 3): what (x, y, 1) of the frame is multiplied with.

    Raises
    ------
    ArgumentError
        If both are in one place, or the second lies to the left of the first.

    Examples
    --------
    >>> eyes = np.array([[20.0, 27.0], [80.0, 27.0]])
    >>> frame_to_photograph(eyes, (100, 100)).round(6) + 0.0
    array([[1., 0., 0.],
           [0., 1., 0.]])
    """
    eyes = checks.finite("eyes", eyes).astype(np.float64)
    (left, right), (own_left, own_right) = eyes, EYES * size[::-1]
    if right[0] <= left[0]:
        raise ArgumentError(
            "eyes must hold the left one in the picture first, and to the left of the other, "
            f"got x = {left[0]:g} and {right[0]:g}"
        )
    # As complex numbers a similarity is a product and a sum.
    turn = complex(*(right - left)) / complex(*(own_right - own_left))
    shift = complex(*left) - turn * complex(*own_left)
    return np.array([[turn.real, -turn.imag, shift.real], [turn.imag, turn.real, shift.imag]])


def in_frame(
    photograph: Float[np.ndarray, "H W *channels"],
    matrix: Float[np.ndarray, "2 3"],
    size: tuple[int, int],
) -> Float[np.ndarray, "h w *channels"]:
    """Return what a frame shows of a photograph, its edges repeated beyond them, in float32.

    Parameters
    ----------
    photograph
        Any values.
    matrix
        See `frame_to_photograph`.
    size
        Rows and columns of the frame.

    Returns
    -------
    numpy.ndarray
        Shape (h, w) or (h, w, 3), in the photograph's unit.

    Raises
    ------
    ArgumentError
        If the photograph or the frame has more than `LARGEST` rows or columns.
    """
    if max(*photograph.shape[:2], *size) > LARGEST:
        raise ArgumentError(
            f"photograph and size must have at most {LARGEST} rows and columns, got "
            f"{photograph.shape[:2]} and {size}"
        )
    # The photograph is smoothed first where the frame has fewer pixels, as area averages do.
    coarser = float(np.hypot(*matrix[:, 0]))
    photograph = photograph.astype(np.float32)
    if coarser > 1:
        photograph = cv2.GaussianBlur(
            photograph, (0, 0), 0.5 * np.sqrt(coarser**2 - 1), borderType=cv2.BORDER_REPLICATE
        )
    # OpenCV counts from the centres of pixels.
    centred = matrix.copy()
    centred[:, 2] += matrix[:, :2] @ [0.5, 0.5] - 0.5
    return cv2.warpAffine(
        photograph,
        centred,
        size[::-1],
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )


def registered(
    photograph: Float[np.ndarray, "H W"],
    start: Float[np.ndarray, "2 3"],
    reference: Float[np.ndarray, "h w"],
) -> Float[np.ndarray, "2 3"]:
    """Return the similarity under which a photograph lies as another of the same face does.

    Parameters
    ----------
    photograph
        Luminance, in any light.
    start
        Map from the frame to the photograph, right to a tenth of the frame's height; it is returned
        if the two cannot be brought to correlate.
    reference
        The frame of the other photograph.

    Returns
    -------
    numpy.ndarray
        Shape (2, 3), see `frame_to_photograph`.
    """
    template = edges(reference)
    everywhere = np.ones(template.shape, bool)
    basis = template.reshape(1, -1) / np.linalg.norm(template)
    own = edges(in_frame(photograph, start, template.shape))
    motion = register(own, basis, everywhere)
    return composed(start, motion, template.shape)


def composed(
    matrix: Float[np.ndarray, "2 3"], motion: Motion, size: tuple[int, int]
) -> Float[np.ndarray, "2 3"]:
    """Return the map from the frame to the photograph, after a motion within the frame.

    Parameters
    ----------
    matrix
        See `frame_to_photograph`.
    motion
        Within the frame, in its pixels.
    size
        Rows and columns of the frame.

    Returns
    -------
    numpy.ndarray
        Shape (2, 3), see `frame_to_photograph`.
    """
    inner = motion.matrix(size).astype(np.float64)
    inner[:, 2] += 0.5 - inner[:, :2] @ [0.5, 0.5]
    return matrix @ np.vstack([inner, [0, 0, 1]])


def edges(image: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Return the strength of the gradient of the logarithm, against that around, less its mean.

    Parameters
    ----------
    image
        Luminance, (h, w); below 0 counts as 0.

    Returns
    -------
    numpy.ndarray
        Shape (h, w), of mean 0, in float32.
    """
    bright = max(float(np.percentile(image, 99)), np.finfo(np.float32).tiny)
    logarithm = np.log(np.maximum(image, 0).astype(np.float32) / bright + FLOOR)
    smooth = cv2.GaussianBlur(logarithm, (0, 0), max(1.0, image.shape[0] / BLUR))
    down, right = np.gradient(smooth)
    strength = np.hypot(down, right)
    around = cv2.GaussianBlur(strength, (0, 0), image.shape[0] / AROUND)
    relative = strength / (around + WEAK)
    return (relative - relative.mean()).astype(np.float32)


def place_sitting(
    photographs: Sequence[Float[np.ndarray, "_ _"]],
    eyes: Sequence[Float[np.ndarray, "2 2"] | None],
    size: tuple[int, int],
    certain: Sequence[bool] = (),
) -> list[Float[np.ndarray, "2 3"] | None]:
    """Return the map from the frame to each photograph of one face, taken in one sitting.

    Of those whose eyes are known the best-lit, in which least is dark, is the reference; all others
    are registered to it, but for those whose eyes are certain. They start from their own eyes, or
    if these are not known, from where the reference's are, as a camera that stands still has them.

    Parameters
    ----------
    photographs
        Luminance of each.
    eyes
        See `frame_to_photograph`; None where they are not known.
    size
        Rows and columns of the frame.
    certain
        Whether the eyes of each are to be believed as they are; by default none are.

    Returns
    -------
    list of numpy.ndarray
        Shape (2, 3) each, see `frame_to_photograph`; None for a photograph that cannot be placed:
        its eyes are not known, and it has another size than the reference.

    Raises
    ------
    ArgumentError
        As `frame_to_photograph` and `in_frame`.
    """
    found = [None if own is None else frame_to_photograph(own, size) for own in eyes]
    placed = [n for n, own in enumerate(found) if own is not None]
    if not placed:
        return found
    best = max(placed, key=lambda n: _light(photographs[n]))
    at_best = found[best]
    assert at_best is not None
    reference = in_frame(photographs[best], at_best, size)
    for n, own in enumerate(found):
        if n == best or (certain and certain[n]):
            continue
        if own is None and photographs[n].shape != photographs[best].shape:
            continue
        start = at_best if own is None else own
        found[n] = registered(photographs[n], start, reference)
    return found


def _light(image: Float[np.ndarray, "H W"]) -> float:
    """Return how little of a photograph is dark: its mean logarithm against its bright pixels."""
    bright = max(float(np.percentile(image, 99)), np.finfo(np.float32).tiny)
    return float(np.log(np.clip(image / bright, 0, 1) + FLOOR).mean())
