"""Photographs of a still object as one matrix, images by pixels, checked at the door."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int, Num

from harmface import checks
from harmface.errors import ArgumentError

LEAST_VARIATION = 1e-2
"""Second over first singular value below which all images count as alike: the light moved too
little for its effect to stand out from noise of one percent."""

OFTEN = 0.75
"""Quantile of a pixel's values over the images above which highlights may be: a normal needs three
lit observations, a quarter of twelve."""

DARK = 0.01
"""Values below this fraction of the stack's 99th percentile count as dark by default."""


@dataclass(frozen=True, eq=False)
class ImageStack:
    """Linear images over the pixels of a mask.

    Parameters
    ----------
    values
        Images as rows, over the masked pixels in row-major order.
    mask
        Which pixels of the picture the columns are.
    seen
        Which observations are not saturated.
    usable
        Which of these are not dark either.
    """

    values: Float[np.ndarray, "F p"]
    mask: Bool[np.ndarray, "H W"]
    seen: Bool[np.ndarray, "F p"]
    usable: Bool[np.ndarray, "F p"]

    def picture(
        self, values: Num[np.ndarray, "p *channels"], background: float = 0.0
    ) -> Num[np.ndarray, "H W *channels"]:
        """Return values of the pixels as a picture, the background filled.

        Parameters
        ----------
        values
            A row for each pixel of the mask.
        background
            Value outside the mask.

        Returns
        -------
        numpy.ndarray
            Shape (H, W) or (H, W, channels), in the dtype of `values`.
        """
        return picture(values, self.mask, background)


def spread_images(stack: ImageStack, most: int) -> ImageStack:
    """Return at most so many images, spread over all."""
    if len(stack.values) <= most:
        return stack
    some = np.linspace(0, len(stack.values) - 1, most).astype(int)
    return replace(
        stack, values=stack.values[some], seen=stack.seen[some], usable=stack.usable[some]
    )


def picture(
    values: Num[np.ndarray, "p *channels"], mask: Bool[np.ndarray, "H W"], background: float = 0.0
) -> Num[np.ndarray, "H W *channels"]:
    """Return values of the masked pixels as a picture, the background filled."""
    image = np.full((*mask.shape, *values.shape[1:]), background, dtype=values.dtype)
    image[mask] = values
    return image


def index_of(mask: Bool[np.ndarray, "H W"]) -> Int[np.ndarray, "H W"]:
    """Return the number of each pixel among the masked ones, -1 outside."""
    index = np.full(mask.shape, -1)
    index[mask] = np.arange(mask.sum())
    return index


def image_stack(
    images: Float[np.ndarray, "F H W"],
    mask: Bool[np.ndarray, "H W"] | None = None,
    *,
    minimum: int = 4,
    dark: float | None = None,
    saturated: Bool[np.ndarray, "F H W"] | None = None,
) -> ImageStack:
    """Check linear photographs and lay their masked pixels out as a matrix.

    Parameters
    ----------
    images
        Linear images, not negative; at least `minimum` of them.
    mask
        The object; everything if not given.
    minimum
        Fewest images that the method at hand needs.
    dark
        Value up to which a pixel counts as dark; 1 % of the 99th percentile if not given.
    saturated
        Which observations the camera clipped; none if not given.

    Returns
    -------
    ImageStack
        Values (F, p) of the mask's p pixels, and which of them are seen and usable.

    Raises
    ------
    ArgumentError
        On too few images, a mask that is empty or of another size, NaN, negative values,
        images that are all alike up to exposure, highlights aside, or if everything is saturated.
    """
    images = checks.array_of("images", images)
    if images.ndim != 3:
        raise ArgumentError(
            f"images must have shape (F, H, W), one size for all, got {images.shape}; "
            "turn colour into one channel first"
        )
    if len(images) < minimum:
        raise ArgumentError(
            f"images must number at least {minimum}, got {len(images)}; take more photographs "
            "under other light, or use a method with fewer dimensions"
        )
    mask = checked_mask(mask, images.shape[1:])
    values = checks.non_negative("images", images[:, mask])
    _refuse_alike(values)
    if dark is None:
        dark = DARK * float(np.percentile(_some(values), 99))
    if saturated is None:
        seen = np.ones(values.shape, dtype=bool)
    else:
        seen = ~checked_saturation(saturated, images.shape)[:, mask]
    return ImageStack(values, mask, seen, seen & (values > dark))


def checked_saturation(
    saturated: Bool[np.ndarray, "F H W"], shape: tuple[int, ...]
) -> Bool[np.ndarray, "F H W"]:
    """Return which observations are saturated, of the images' shape, some of them not."""
    saturated = np.asarray(saturated)
    if saturated.shape != shape or saturated.dtype != bool:
        raise ArgumentError(
            f"saturated must tell True or False of every observation, shape {shape}, got "
            f"{saturated.dtype} of shape {saturated.shape}; compare the images with full scale"
        )
    if saturated.all():
        raise ArgumentError("saturated must leave observations, but is True of all; expose less")
    return saturated


def checked_mask(
    mask: Bool[np.ndarray, "H W"] | None, shape: tuple[int, ...]
) -> Bool[np.ndarray, "H W"]:
    """Return a mask that has pixels and the size of the images; all pixels if there is none."""
    if mask is None:
        return np.ones(shape, dtype=bool)
    mask = checks.mask("mask", mask, shape)
    if not mask.any():
        raise ArgumentError("mask must cover at least one pixel, got an empty one")
    return mask


def _refuse_alike(values: Float[np.ndarray, "F p"]) -> None:
    some = _some(values).astype(np.float64)
    # A highlight lights a pixel in few images: without the brightest of them, what does not shade,
    # as chrome or black glass, is alike in all.
    some = np.minimum(some, np.quantile(some, OFTEN, axis=0, method="lower"))
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(some @ some.T)[::-1], 0))
    if len(singular) > 1 and singular[1] <= LEAST_VARIATION * singular[0]:
        raise ArgumentError(
            "images must differ in their light, but highlights aside they are alike up to exposure "
            "(rank 1); move the light between photographs. Chrome or black objects show no "
            "shading: cover them with powder or matt spray"
        )


def _some(values: Float[np.ndarray, "F p"]) -> Float[np.ndarray, "F s"]:
    """Return a few thousand pixels, which tell as much of a stack's values as all."""
    return values[:, :: max(1, values.shape[1] // 4096)]
