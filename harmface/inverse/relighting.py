"""A photograph in other light: its texture kept, its shading exchanged.

References
----------
.. [MG97] Marschner and Greenberg, Inverse Lighting for Photography, CIC 1997.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError

FLOOR = 0.1
"""Share of the mean irradiance that is divided by at least: in deep shadow a photograph holds
little but noise, and the estimate little but its error."""


def relight_photograph(
    photo: Float[np.ndarray, "H W *channels"],
    before: Float[np.ndarray, "..."],
    after: Float[np.ndarray, "..."],
    mask: Bool[np.ndarray, "H W"],
    *,
    floor: float = FLOOR,
    exposure: float | None = None,
) -> Float[np.ndarray, "H W *channels"]:
    """Return `photo * after / before` where the mask is true, and the photograph elsewhere.

    The ratio of irradiances of a matte surface is the ratio of its photographs, whatever its albedo
    ([MG97]_). It is divided by `floor` times the mean at least, so that what was dark does not
    become noise.

    Parameters
    ----------
    photo
        Linear photograph.
    before, after
        Irradiance of every pixel in the light it was taken in and in the new one, `(H, W)`, or with
        channels first, as many as the photograph has.
    mask
        The surface; hair and background are left alone.
    floor
        Share of the mean irradiance, at least 0.
    exposure
        Factor on the new light; by default the mean luminance of the surface stays.

    Returns
    -------
    numpy.ndarray
        Linear, not clipped.

    Raises
    ------
    ArgumentError
        If shapes differ, something is not finite, or a light leaves the surface dark.
    """
    photo = checks.picture("photo", checks.intensities("photo", photo))
    mask = checks.mask("mask", mask, photo.shape[:2])
    if not mask.any():
        raise ArgumentError("mask must show the surface, got none")
    both = []
    for name, each in (("before", before), ("after", after)):
        each = np.maximum(checks.finite(name, each), 0)
        if each.shape[-2:] != mask.shape or each.ndim not in (2, 3):
            raise ArgumentError(f"{name} must be of {mask.shape} pixels, got {each.shape}")
        seen = each[..., mask]
        mean = seen.mean(axis=-1)
        if not (mean > 0).all():
            raise ArgumentError(f"{name} must not leave the surface dark")
        # One floor for all channels of a light, so that its colour stays.
        both.append((seen, float(mean.mean())))
    (old, mean_before), (new, _) = both
    least = float(checks.non_negative("floor", floor)) * mean_before
    ratio = new / np.maximum(old, max(least, np.finfo(np.float64).tiny))
    relit = photo.astype(np.float64).copy()
    own = relit[mask]
    if ratio.ndim == 2 and own.ndim == 1:
        raise ArgumentError("photo must have channels for a light that has, got a grey one")
    shaded = own * (np.atleast_2d(ratio).T if own.ndim == 2 else ratio)
    if exposure is None:
        exposure = float(own.mean() / max(shaded.mean(), np.finfo(np.float64).tiny))
    relit[mask] = exposure * shaded
    return relit
