"""Photometric stereo from photographs, whatever is known of the light.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, 0.4.2.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.stereo.confidence import beside_neighbours, confidence_of, noise_error
from harmface.stereo.cues import KnownNormals
from harmface.stereo.encoding import looks_gamma_encoded
from harmface.stereo.factorization import chunks, factorize, interleaved
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.integrable_fit import of_one_surface
from harmface.stereo.known_lights import (
    normals_from_coefficients,
    normals_from_directions,
    normals_from_few,
    robust_weights,
)
from harmface.stereo.light_models import HarmonicLight, LightModel, is_single
from harmface.stereo.result import Recovered, StereoReport, StereoResult
from harmface.stereo.single_sources import SINGLE
from harmface.stereo.stack import ImageStack, image_stack
from harmface.stereo.unknown_light import harmonic_light, recover

ENCODED = (
    "images look gamma-encoded: they come nearer to four dimensions when the sRGB curve is "
    "undone; decode them first"
)

MANY = 0.01
"""Share of observations or pixels of which too little is known that is worth a word."""

MOST_KNOWN = 300
"""Known normals that are looked at: they decide a dozen numbers."""

UNKNOWNS = 3
"""Components of a scaled normal."""


def photometric_stereo(
    images: Float[np.ndarray, "F H W"],
    mask: Bool[np.ndarray, "H W"] | None = None,
    *,
    light: Float[np.ndarray, "F q"] | None = None,
    order: Literal[1, 2] = 2,
    refine: bool = True,
    outline: bool | None = None,
    normals_known: Float[np.ndarray, "H W 3"] | None = None,
    symmetric: bool = False,
    robust: bool = False,
    saturated: Bool[np.ndarray, "F H W"] | None = None,
    smoothness: float | None = None,
    rng: np.random.Generator | int = 0,
    progress: Callable[[float], None] = lambda done: None,
) -> StereoResult:
    """Return normals, albedo and light from photographs of a still, diffuse object.

    With unknown light ([BJK07]_, [R05]_ 0.4.2) the first-order method starts, the second-order
    method improves, and refinement fits physical light to every image and pixel. Without
    refinement, light from points in a few images settles what harmonics leave vague.

    Parameters
    ----------
    images
        Linear photographs of one channel, at least 4 (9 for order 2; 3 if light is known).
    mask
        The object; everything if not given.
    light
        If known: `(F, 3)` directions times irradiance, or `(F, K)` harmonic coefficients of
        radiance with K = 4, 9, ...
    order
        Degree of the harmonic method, 1 (4-D) or 2 (9-D).
    refine
        Whether to go on to physical light.
    outline
        Whether the rim of the mask is an occluding outline, where normals lie in the image
        plane; found out from the images if not given.
    normals_known
        Normals measured at a few pixels, zero vectors elsewhere. Of more than 300, so many are
        used, spread over all.
    symmetric
        Whether the object is symmetric about the vertical line through the middle of its mask.
    robust
        With known directions: whether highlights and cast shadows are to be expected.
    saturated
        Which observations the camera clipped, in any of its channels; none if not given. Only the
        harmonic methods cannot leave them out.
    smoothness
        If given, refined normals, or those under known light, are fitted once more as those of one
        surface, see `fit_integrable`, whose slopes change by about 1 / smoothness from a pixel
        to the next: 1 evens out noise, 3 is for few or noisy images, 0 asks for a surface only.
    rng
        Draws starting points and pixels.
    progress
        Called now and then with the share of the work that is done.

    Raises
    ------
    ArgumentError
        On too few images, images alike, an empty mask, NaN, light of the wrong number, or if
        everything is saturated.
    """
    if order not in (1, 2):
        raise ArgumentError(f"order must be 1 or 2, got {order}")
    if smoothness is not None and not 0 <= smoothness < np.inf:
        raise ArgumentError(f"smoothness must be at least 0 and finite, got {smoothness}")
    if smoothness is not None and light is None and not refine:
        raise ArgumentError(
            "smoothness needs refinement or known light; the first and second order alone are "
            "linear in the images' dimensions"
        )
    rng = checks.generator(rng)
    minimum = 3 if light is not None else (4, 9)[order - 1]
    stack = image_stack(images, mask, minimum=minimum, saturated=saturated)
    stack = replace(stack, values=stack.values.astype(np.float64, copy=False))
    if light is not None:
        found = _under_known_light(stack, np.asarray(light), robust, smoothness, progress)
    else:
        measured = _known_normals(normals_known, stack.mask)
        # Thousands of small products: more than one thread slows them by a third.
        with threadpool_limits(1, user_api="blas"):
            found = recover(
                stack,
                order=order,
                refine=refine,
                outline=outline,
                normals=measured,
                symmetric=symmetric,
                smoothness=smoothness,
                rng=rng,
                progress=progress,
            )
    if saturated is not None:
        said = _saturation(found, 1 - float(stack.seen.mean()))
        found = replace(found, warnings=(*found.warnings, *said))
    result = _result(stack, found)
    progress(1.0)
    return result


def _under_known_light(
    stack: ImageStack,
    light: Float[np.ndarray, "F q"],
    robust: bool,
    smoothness: float | None,
    progress: Callable[[float], None],
) -> Recovered:
    """Return every pixel fitted by itself, a share of them at a time to spare memory."""
    model: LightModel
    if light.ndim == 2 and light.shape[1] == 3:
        model, method = SINGLE, "known directions"
    elif light.ndim == 2 and light.shape[1] >= 4:
        model, method = HarmonicLight(max_degree_of(light.shape[1])), "known coefficients"
    else:
        raise ArgumentError(
            "light must be (F, 3) directions or (F, K) harmonic coefficients with K = 4, 9, ..., "
            f"got shape {light.shape}"
        )
    pixels = stack.values.shape[1]
    b, expected, few = np.empty((pixels, 3)), np.empty(pixels), np.empty(pixels, dtype=bool)
    kept = None if smoothness is None else np.empty(stack.values.shape, np.float32)
    parts = interleaved(pixels, 8 * len(stack.values))
    for number, some in enumerate(parts):
        values, seen = stack.values[:, some], stack.seen[:, some]
        usable = stack.usable[:, some] if is_single(model) else seen
        few[some] = usable.sum(axis=0) < UNKNOWNS
        if is_single(model):
            b[some], weights = _by_directions(values, light, usable, seen, robust)
        else:
            b[some] = normals_from_coefficients(values, light, usable=usable)
            weights = usable.astype(np.float64)
        expected[some] = noise_error(values, model, light, b[some], weights)
        if kept is not None:
            kept[:, some] = weights
        progress((number + 1) / len(parts))
    warnings: tuple[str, ...] = ()
    if few.mean() > MANY:
        warnings = (
            f"{few.mean():.0%} of the pixels are seen in fewer than three photographs, neither "
            "dark nor saturated: their normals are guesses",
        )
    if smoothness is not None and kept is not None:
        b = of_one_surface(stack, model, light, b, kept, smoothness)
    expected = beside_neighbours(directions_of(b), stack.mask, expected)
    expected = np.where(few, 90.0, np.minimum(expected, 90.0))
    return Recovered(method, b, expected, "light", warnings=warnings)


def _by_directions(
    values: Float[np.ndarray, "F p"],
    light: Float[np.ndarray, "F 3"],
    usable: Bool[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    robust: bool,
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals, and how much each observation counted."""
    b = normals_from_directions(values, light, usable=usable, robust=robust)
    few = usable.sum(axis=0) < UNKNOWNS
    if few.any():
        b[few] = normals_from_few(values[:, few], light, seen[:, few])
    if robust:
        return b, robust_weights(values, light @ b.T, usable)
    return b, usable.astype(np.float64)


def _saturation(found: Recovered, share: float) -> tuple[str, ...]:
    """Return what to say of the share of observations that are saturated."""
    if share <= MANY:
        return ()
    if found.convexity == "light" or found.method == "refined":
        return (f"{share:.0%} of the observations are saturated and were left out",)
    return (
        f"{share:.0%} of the observations are saturated: expose less, as what is clipped bends "
        "the surface",
    )


def _result(stack: ImageStack, found: Recovered) -> StereoResult:
    length = np.linalg.norm(found.b, axis=1)
    # A pixel that no light reaches has no normal; towards the viewer is as good as any.
    dark = length <= 1e-9 * length.max()
    n = np.where(dark[:, None], (0.0, 0.0, 1.0), found.b / np.where(dark, 1.0, length)[:, None])
    expected = np.where(dark, 90.0, found.expected)
    lighting = harmonic_light(stack.values, found.b, 2)
    rank = min(9, *stack.values.shape)
    spectrum = factorize(stack.values, rank)
    encoded = (ENCODED,) if looks_gamma_encoded(stack.values) else ()
    report = StereoReport(
        found.method,
        (float(spectrum.energy[min(3, rank - 1)]), float(spectrum.energy[rank - 1])),
        spectrum.rank,
        found.signature_held,
        found.convexity,
        found.light_model,
        _residual_share(stack.values, found.b, lighting),
        found.converged,
        encoded + found.warnings,
    )
    return StereoResult(
        stack.picture(n),
        stack.picture(length),
        lighting,
        stack.picture(confidence_of(expected)),
        stack.picture(expected),
        stack.mask,
        report,
    )


def _residual_share(
    values: Float[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    lighting: Float[np.ndarray, "F 9"],
) -> float:
    """Return the norm of what the harmonic images leave, relative to that of the images."""
    left = sum(
        float(np.sum((values[:, some] - lighting @ scaled_normal_images(b[some], 2)) ** 2))
        for some in chunks(len(b), 8 * len(values))
    )
    return float(np.sqrt(left) / np.linalg.norm(values))


def _known_normals(
    normals: Float[np.ndarray, "H W 3"] | None, mask: Bool[np.ndarray, "H W"]
) -> KnownNormals | None:
    if normals is None:
        return None
    normals = checks.vectors("normals_known", normals)
    if normals.shape[:2] != mask.shape:
        raise ArgumentError(
            f"normals_known must have the images' size {mask.shape}, got {normals.shape[:2]}"
        )
    inside = normals[mask]
    pixels = np.flatnonzero((inside != 0).any(axis=1))
    if len(pixels) < 2:
        raise ArgumentError(
            f"normals_known must hold at least 2 normals within the mask, got {len(pixels)}"
        )
    normals = checks.unit_vectors("normals_known", inside[pixels])
    some = np.linspace(0, len(pixels) - 1, min(len(pixels), MOST_KNOWN)).astype(int)
    return KnownNormals(pixels[some], normals[some])
