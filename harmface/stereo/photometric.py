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
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.stereo.advice import doubts, relative_strengths
from harmface.stereo.encoding import looks_gamma_encoded
from harmface.stereo.factorization import chunks, factorize, interleaved
from harmface.stereo.gauge import Belief
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.known_lights import (
    normals_from_coefficients,
    normals_from_directions,
    normals_from_few,
    require_light_for_each,
    robust_weights,
)
from harmface.stereo.lamp_strengths import strengths_of
from harmface.stereo.light_models import HarmonicLight, LightModel, is_single
from harmface.stereo.result import Recovered, StereoReport, StereoResult
from harmface.stereo.single_sources import SINGLE
from harmface.stereo.stack import ImageStack, image_stack
from harmface.stereo.surface import of_one_surface
from harmface.stereo.uncertainty import (
    MapError,
    beside_neighbours,
    confidence_of,
    noise_error,
    smoothed_noise,
)
from harmface.stereo.unknown_light import harmonic, harmonic_light, refined

FEWEST_IMAGES = {"4d": 4, "9d": 9, "refined": 4, "known-lights": 3}
"""Images that each method needs."""

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
    method: str = "refined",
    light: Float[np.ndarray, "F q"] | None = None,
    strengths: Float[np.ndarray, "F"] | None = None,
    normals_known: Float[np.ndarray, "H W 3"] | None = None,
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
        "known-lights": with `light`.
    light
        Of "known-lights": `(F, 3)` unit directions to the lamps, or `(F, K)` harmonic coefficients
        of radiance, K = 4, 9, ...
    strengths
        Irradiance by each lamp on a surface that faces it; estimated if directions alone are known.
    normals_known
        For "refined": normals measured at a few pixels, zero vectors elsewhere. Of more than 300,
        so many are used, spread over all.
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
        mask, NaN, light of the wrong number, or if everything is saturated.
    """
    _check_method(method, light, strengths, normals_known, symmetric, smoothness)
    rng = checks.generator(rng)
    stack = image_stack(images, mask, minimum=FEWEST_IMAGES[method], saturated=saturated)
    stack = replace(stack, values=stack.values.astype(np.float64, copy=False))
    # Thousands of small products: more than one thread slows them by a third.
    with threadpool_limits(1, user_api="blas"):
        if light is not None:
            found = _under_known_light(stack, light, strengths, smoothness, progress)
        elif method == "refined":
            found = refined(
                stack,
                known_normals=_known_normals(normals_known, stack.mask),
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
    strengths: object,
    normals: object,
    symmetric: bool,
    smoothness: float | None,
) -> None:
    if method not in FEWEST_IMAGES:
        raise ArgumentError(f"method must be one of {', '.join(FEWEST_IMAGES)}, got {method!r}")
    if (light is not None) != (method == "known-lights"):
        raise ArgumentError(
            f"light must be given for the method 'known-lights' and for no other, got {method!r} "
            f"{'with' if light is not None else 'without'} light"
        )
    if strengths is not None and light is None:
        raise ArgumentError("strengths are those of the lamps in light, which is missing")
    if smoothness is not None and not 0 <= smoothness < np.inf:
        raise ArgumentError(f"smoothness must be at least 0 and finite, got {smoothness}")
    if smoothness is not None and method in ("4d", "9d"):
        raise ArgumentError(
            f"smoothness needs the method 'refined' or 'known-lights'; {method!r} is linear in the "
            "images' dimensions"
        )
    if method != "refined" and (normals is not None or symmetric):
        raise ArgumentError(
            f"normals_known and symmetric serve the method 'refined' only, got {method!r}"
        )


def _under_known_light(
    stack: ImageStack,
    light: Float[np.ndarray, "F q"],
    strengths: Float[np.ndarray, "F"] | None,
    smoothness: float | None,
    progress: Callable[[float], None],
) -> Recovered:
    """Return every pixel fitted by itself, a share of them at a time to spare memory."""
    model, light, beliefs, warnings = _known_light(stack, light, strengths)
    pixels = stack.values.shape[1]
    b, noise, few = np.empty((pixels, 3)), np.empty(pixels), np.empty(pixels, dtype=bool)
    kept = None if smoothness is None else np.empty(stack.values.shape, np.float32)
    parts = interleaved(pixels, 8 * len(stack.values))
    for number, some in enumerate(parts):
        values, seen = stack.values[:, some], stack.seen[:, some]
        usable = stack.usable[:, some] if is_single(model) else seen
        few[some] = usable.sum(axis=0) < UNKNOWNS
        if is_single(model):
            b[some], weights = _by_directions(values, light, usable, seen)
        else:
            b[some] = normals_from_coefficients(values, light, usable=usable)
            weights = usable.astype(np.float64)
        noise[some] = noise_error(values, model, light, b[some], weights)
        if kept is not None:
            kept[:, some] = weights
        progress((number + 1) / len(parts))
    if few.mean() > MANY:
        warnings = (
            *warnings,
            f"{few.mean():.0%} of the pixels are seen in fewer than three photographs, neither "
            "dark nor saturated: their normals are guesses",
        )
    if smoothness is not None and kept is not None:
        smooth = of_one_surface(stack, model, light, b, kept, smoothness)
        noise = smoothed_noise(noise, b, smooth, stack.mask)
        b = smooth
    noise = beside_neighbours(directions_of(b), stack.mask, noise)
    noise = np.where(few, 90.0, noise)
    lamps = light if is_single(model) else None
    name = "one point" if is_single(model) else "harmonic"
    return Recovered(
        "known-lights",
        b,
        noise,
        None,
        "light",
        beliefs=beliefs,
        light_model=name,
        lamps=lamps,
        warnings=warnings,
    )


def _known_light(
    stack: ImageStack, light: Float[np.ndarray, "F q"], strengths: Float[np.ndarray, "F"] | None
) -> tuple[LightModel, Float[np.ndarray, "F q"], tuple[Belief, ...], tuple[str, ...]]:
    """Return the model of known light, its parameters, beliefs, and what was assumed."""
    light = checks.finite("light", light).astype(np.float64)
    if light.ndim != 2 or light.shape[1] < 3:
        raise ArgumentError(
            "light must be (F, 3) directions or (F, K) harmonic coefficients with K = 4, 9, ..., "
            f"got shape {light.shape}"
        )
    require_light_for_each("light", len(light), len(stack.values))
    if light.shape[1] > 3:
        if strengths is not None:
            raise ArgumentError("strengths belong to directions; coefficients hold theirs")
        return HarmonicLight(max_degree_of(light.shape[1])), light, (), ()
    light = checks.unit_vectors("light", light)
    if strengths is not None:
        strengths = checks.non_negative("strengths", strengths)
        if strengths.shape != (len(light),):
            raise ArgumentError(
                f"strengths must be one for each of the {len(light)} lamps, got {strengths.shape}"
            )
        return SINGLE, light * strengths[:, None], (), ()
    if len(light) <= UNKNOWNS:
        return SINGLE, light, (), ("three images do not tell the lamps' strengths: taken as equal",)
    strengths, beliefs = strengths_of(stack, light)
    return SINGLE, light * strengths[:, None], beliefs, ()


def _by_directions(
    values: Float[np.ndarray, "F p"],
    light: Float[np.ndarray, "F 3"],
    usable: Bool[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals, and how much each observation counted."""
    b = normals_from_directions(values, light, usable=usable, robust=True)
    few = usable.sum(axis=0) < UNKNOWNS
    if few.any():
        b[few] = normals_from_few(values[:, few], light, seen[:, few])
    return b, robust_weights(values, light @ b.T, usable)


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
    if len(pixels) < 2:
        raise ArgumentError(
            f"normals_known must hold at least 2 normals within the mask, got {len(pixels)}"
        )
    normals = checks.unit_vectors("normals_known", inside[pixels])
    some = np.linspace(0, len(pixels) - 1, min(len(pixels), MOST_KNOWN)).astype(int)
    return pixels[some], normals[some]
