"""What is done to photographs to make light matter less before they are compared.

References
----------
.. [WLW04] Wang, Li and Wang, Face Recognition under Varying Lighting Conditions Using Self
   Quotient Image, FG 2004.
.. [TT10] Tan and Triggs, Enhanced Local Texture Feature Sets for Face Recognition under
   Difficult Lighting Conditions, TIP 2010.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter
from skimage.exposure import equalize_hist

from harmface import checks
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import PHOTOGRAPHS, RELIT, Gallery, Photographs
from harmface.recognition.spanned import SubspaceDistance

QUOTIENT_SIGMA = 0.05
"""Width of the smoothing of the self-quotient image, as a fraction of the height."""


def equalized(images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "n H W"]:
    """Return the images with their histograms made uniform over [0, 1], each for itself."""
    images = checks.non_negative("images", images)
    return np.stack([equalize_hist(image) for image in images]).astype(images.dtype)


def self_quotient(images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "n H W"]:
    """Return each image over its own smoothed version, [WLW04]_ with a Gaussian of one width.

    Where the smoothed image is black the quotient is 1: nothing is known of it.
    """
    images = checks.non_negative("images", images)
    smooth = _smooth(images, QUOTIENT_SIGMA * images.shape[1])
    return np.divide(images, smooth, out=np.ones_like(images), where=smooth > 0)


def tan_triggs(images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "n H W"]:
    """Return the images after gamma, difference of Gaussians and contrast equalisation [TT10]_.

    Parameters are the published ones: gamma 0.2, widths of 1 and 2 pixels, `alpha` 0.1 and
    `tau` 10.
    """
    images = checks.non_negative("images", images)
    brightened = images**0.2
    contrast = _smooth(brightened, 1.0) - _smooth(brightened, 2.0)
    alpha, tau = 0.1, 10.0
    contrast = _scaled(contrast, np.abs(contrast), alpha)
    contrast = _scaled(contrast, np.minimum(np.abs(contrast), tau), alpha)
    return tau * np.tanh(contrast / tau)


def _smooth(images: Float[np.ndarray, "n H W"], sigma: float) -> Float[np.ndarray, "n H W"]:
    return gaussian_filter(images, (0, sigma, sigma), mode="nearest")


def _scaled(
    images: Float[np.ndarray, "n H W"], magnitudes: Float[np.ndarray, "n H W"], alpha: float
) -> Float[np.ndarray, "n H W"]:
    """Divide each image by the `1 / alpha` power of the mean of the magnitudes to `alpha`."""
    scale = (magnitudes**alpha).mean(axis=(1, 2), keepdims=True) ** (1 / alpha)
    return np.divide(images, scale, out=np.zeros_like(images), where=scale > 0)


NORMALIZERS = {"equalized": equalized, "self-quotient": self_quotient, "tan-triggs": tan_triggs}
"""What may stand before a method's name, with a plus: `tan-triggs+eigenfaces`."""


@dataclass(frozen=True)
class NormalizedDistance(Distance):
    """Another distance, of photographs that light matters less in.

    Parameters
    ----------
    normalizer
        One of `NORMALIZERS`.
    inner
        The distance of what comes out.
    """

    sources = (PHOTOGRAPHS, RELIT)
    normalizer: str = "tan-triggs"
    inner: Distance = field(default_factory=SubspaceDistance)

    def fit(self, gallery: Gallery) -> Model:
        """Return what the inner distance knows of the normalised photographs."""
        return self.inner.fit(
            replace(
                gallery,
                photographs=self._normalized(gallery.photographs, gallery.mask),
                relit=gallery.relit and self._normalized(gallery.relit, gallery.mask),
            )
        )

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the inner distance of the normalised probes."""
        return self.inner.distances(model, NORMALIZERS[self.normalizer](probes * mask), mask)

    def _normalized(self, given: Photographs, mask: Bool[np.ndarray, "H W"]) -> Photographs:
        return replace(given, images=NORMALIZERS[self.normalizer](given.images * mask))
