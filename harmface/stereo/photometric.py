"""Photometric stereo from photographs, whatever is known of the light.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, 0.4.2.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.errors import ArgumentError
from harmface.stereo.advice import doubts, relative_strengths
from harmface.stereo.distant_light import under_distant_light
from harmface.stereo.encoding import looks_gamma_encoded
from harmface.stereo.factorization import chunks, factorize
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.known_lights import (
    MANY,
)
from harmface.stereo.near_lamps import under_near_lamps
from harmface.stereo.result import Recovered, StereoReport, StereoResult
from harmface.stereo.stack import ImageStack, image_stack
from harmface.stereo.uncertainty import (
    MapError,
    confidence_of,
)
from harmface.stereo.unknown_light import harmonic, harmonic_light, refined

FEWEST_IMAGES = {"4d": 4, "9d": 9, "refined": 4, "known-lights": 3}
"""Images that each method needs."""

ENCODED = (
    "images look gamma-encoded: they come nearer to four dimensions when the sRGB curve is "
    "undone; decode them first"
)

MOST_KNOWN = 300
"""Known normals that are looked at: they decide a dozen numbers."""


def photometric_stereo(
    images: Float[np.ndarray, "F H W"],
    mask: Bool[np.ndarray, "H W"] | None = None,
    *,
    method: str = "refined",
    light: Float[np.ndarray, "F q"] | None = None,
    positions: Float[np.ndarray, "F 3"] | None = None,
    strengths: Float[np.ndarray, "F"] | None = None,
    normals_known: Float[np.ndarray, "H W 3"] | None = None,
    directions_known: Float[np.ndarray, "F 3"] | None = None,
    symmetric: bool = False,
    saturated: Bool[np.ndarray, "F H W"] | None = None,
    smoothness: float | None = None,
    rng: np.random.Generator | int = 0,
    progress: Callable[[float], None] = lambda done: None,
) -> StereoResult:
    """Return normals, albedo and light from photographs of a still, diffuse object.

    With unknown light, images determine scaled normals up to a map ([BJK07]_, [R05]_ 0.4.2), and
    cues choose the map: integrability, albedo, lamps of one strength, maxima of the shading,
    highlights, the rim, and what objects look like. Each is tested, and the report says which were
    believed.

    Parameters
    ----------
    images
        Linear photographs of one channel: at least 4, 9 for "9d", 3 if light is known.
    mask
        The object; everything if not given.
    method
        "refined": physical light and every pixel, shadows and highlights left out. "4d" and "9d":
        the closed forms of degree 1 and 2, for matte objects under general light.
        "known-lights": with `light` or `positions`.
    light
        Of "known-lights": `(F, 3)` unit directions to the lamps, or `(F, K)` harmonic coefficients
        of radiance, K = 4, 9, ...
    positions
        Of "known-lights", for lamps so near that their light changes over the object: x right, y
        up, z towards the camera, in units of the width of the mask, from the middle of its bounding
        box, at the mean height of the surface. See `near_lamps`.
    strengths
        Irradiance by each lamp on a surface that faces it in the object's middle; estimated if
        directions or positions alone are known.
    normals_known
        For "refined": normals measured at a few pixels, zero vectors elsewhere. Of more than 300,
        so many are used, spread over all.
    directions_known
        For "refined" where each image has one lamp: unit directions to those that were measured,
        zero vectors for the others.
    symmetric
        For "refined": whether the object is symmetric about the vertical line through the middle
        of its mask.
    saturated
        Which observations the camera clipped, in any of its channels; none if not given. Only the
        closed forms cannot leave them out.
    smoothness
        If given, refined normals, or those under known light, are fitted once more as those of one
        surface, see `fit_integrable`, whose slopes change by about 1 / smoothness from a pixel
        to the next: 1 evens out noise, 3 is for few or noisy images, 0 asks for a surface only.
    rng
        Draws starting points and pixels.
    progress
        Called now and then with the share of the work that is done.

    Returns
    -------
    StereoResult
        Normals, albedo, lighting, expected errors in degrees, and the report.

    Raises
    ------
    ArgumentError
        On an unknown method, arguments that it cannot use, too few images, images alike, an empty
        mask, NaN, light of the wrong number, if everything is saturated, or if directions are known
        but the images show more light than one lamp's.
    """
    known = normals_known is not None or directions_known is not None or symmetric
    _check_method(method, light, positions, strengths, known, smoothness)
    rng = checks.generator(rng)
    stack = image_stack(images, mask, minimum=FEWEST_IMAGES[method], saturated=saturated)
    stack = replace(stack, values=stack.values.astype(np.float64, copy=False))
    # Thousands of small products: more than one thread slows them by a third.
    with threadpool_limits(1, user_api="blas"):
        if strengths is not None:
            strengths = _strengths(strengths, len(stack.values))
        if positions is not None:
            found = under_near_lamps(stack, positions, strengths, progress)
        elif light is not None:
            found = under_distant_light(stack, light, strengths, smoothness, progress)
        elif method == "refined":
            found = refined(
                stack,
                known_normals=_known_normals(normals_known, stack.mask),
                directions=_known_directions(directions_known, len(stack.values)),
                symmetric=symmetric,
                smoothness=smoothness,
                rng=rng,
                progress=progress,
            )
        else:
            found = harmonic(stack, order=1 if method == "4d" else 2, rng=rng, progress=progress)
    result = _result(stack, found, saturated is not None)
    progress(1.0)
    return result


def _check_method(
    method: str,
    light: object,
    positions: object,
    strengths: object,
    surface_known: bool,
    smoothness: float | None,
) -> None:
    if method not in FEWEST_IMAGES:
        raise ArgumentError(f"method must be one of {', '.join(FEWEST_IMAGES)}, got {method!r}")
    known = (light is not None) + (positions is not None)
    if known != (method == "known-lights"):
        raise ArgumentError(
            "light or positions must be given for the method 'known-lights' and for no other, got "
            f"{method!r} with {('neither', 'one', 'both')[known]} of them"
        )
    if strengths is not None and not known:
        raise ArgumentError("strengths are those of lamps in light or positions: both are missing")
    if smoothness is not None and not 0 <= smoothness < np.inf:
        raise ArgumentError(f"smoothness must be at least 0 and finite, got {smoothness}")
    if smoothness is not None and method in ("4d", "9d"):
        raise ArgumentError(
            f"smoothness needs the method 'refined' or 'known-lights'; {method!r} is linear in the "
            "images' dimensions"
        )
    if smoothness is not None and positions is not None:
        raise ArgumentError("smoothness serves distant light only, but positions are given")
    if method != "refined" and surface_known:
        raise ArgumentError(
            "normals_known, directions_known and symmetric serve the method 'refined' only, got "
            f"{method!r}"
        )


def _strengths(strengths: Float[np.ndarray, "F"], lamps: int) -> Float[np.ndarray, "F"]:
    strengths = checks.non_negative("strengths", strengths).astype(np.float64)
    if strengths.shape != (lamps,):
        raise ArgumentError(
            f"strengths must be one for each of the {lamps} lamps, got {strengths.shape}"
        )
    return strengths


def _saturation(method: str, share: float) -> tuple[str, ...]:
    """Return what to say of the share of observations that are saturated."""
    if share <= MANY:
        return ()
    if method in ("4d", "9d"):
        return (
            f"{share:.0%} of the observations are saturated: expose less, as what is clipped bends "
            "the surface",
        )
    return (f"{share:.0%} of the observations are saturated and were left out",)


def _result(stack: ImageStack, found: Recovered, clipping_told: bool) -> StereoResult:
    length = np.linalg.norm(found.b, axis=1)
    # A pixel that no light reaches has no normal; towards the viewer is as good as any.
    dark = length <= 1e-9 * length.max()
    n = np.where(dark[:, None], (0.0, 0.0, 1.0), found.b / np.where(dark, 1.0, length)[:, None])
    of_map = MapError(np.zeros(len(n)), (0.0, 0.0), 0.0) if found.of_map is None else found.of_map
    expected = np.minimum(np.hypot(found.noise, of_map.angle), 90.0)
    expected = np.where(dark, 90.0, expected)
    lighting = harmonic_light(stack.values, found.b, 2)
    rank = min(9, *stack.values.shape)
    spectrum = factorize(stack.values, rank)
    warnings: tuple[str, ...] = (ENCODED,) if looks_gamma_encoded(stack.values) else ()
    warnings += found.warnings + doubts(found)
    if clipping_told:
        warnings += _saturation(found.method, 1 - float(stack.seen.mean()))
    report = StereoReport(
        found.method,
        (float(spectrum.energy[min(3, rank - 1)]), float(spectrum.energy[rank - 1])),
        spectrum.rank,
        found.signature_held,
        found.convexity,
        found.light_model,
        _residual_share(stack.values, found.b, lighting),
        found.converged,
        float(np.median(found.noise)),
        float(np.median(of_map.angle)),
        of_map.tilt,
        of_map.stretch,
        found.beliefs,
        None if found.lamps is None else relative_strengths(found.lamps),
        warnings,
    )
    return StereoResult(
        stack.picture(n),
        stack.picture(length),
        lighting,
        found.lamps,
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
) -> tuple[Int[np.ndarray, "k"], Float[np.ndarray, "k 3"]] | None:
    """Return columns of the stack at which normals were measured, and these."""
    if normals is None:
        return None
    normals = checks.vectors("normals_known", normals)
    if normals.shape[:2] != mask.shape:
        raise ArgumentError(
            f"normals_known must have the images' size {mask.shape}, got {normals.shape[:2]}"
        )
    inside = normals[mask]
    pixels = np.flatnonzero((inside != 0).any(axis=1))
    if not len(pixels):
        raise ArgumentError("normals_known must hold a normal within the mask, but all are zero")
    normals = checks.unit_vectors("normals_known", inside[pixels])
    some = np.linspace(0, len(pixels) - 1, min(len(pixels), MOST_KNOWN)).astype(int)
    return pixels[some], normals[some]


def _known_directions(
    directions: Float[np.ndarray, "F 3"] | None, images: int
) -> Float[np.ndarray, "F 3"] | None:
    if directions is None:
        return None
    directions = checks.vectors("directions_known", directions).astype(np.float64)
    if directions.shape != (images, 3):
        raise ArgumentError(
            f"directions_known must hold a row for each of the {images} images, zero where it is "
            f"not known, got {directions.shape}"
        )
    known = directions.any(axis=1)
    if not known.any():
        raise ArgumentError("directions_known must hold a direction, but all are zero")
    checks.unit_vectors("directions_known", directions[known])
    return directions
