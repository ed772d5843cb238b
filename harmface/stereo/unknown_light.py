"""Structure from photographs under unknown light: the methods in their order.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion

from harmface.stereo.coarse import coarse_factor, coarse_stack, spread_over, spread_to_nearest
from harmface.stereo.confidence import ambiguity_error, beside_neighbours, noise_error
from harmface.stereo.cues import Cues, Knowledge, KnownNormals, outline_of
from harmface.stereo.exact_second_order import EXACT, exact_second_order
from harmface.stereo.factorization import chunks, factorize, interleaved
from harmface.stereo.first_order import FirstOrder, first_order
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.integrable_fit import of_one_surface
from harmface.stereo.light_models import HarmonicLight, LightModel, Mapped, PointLights, is_single
from harmface.stereo.lorentz import NullCone, fit_null_cone
from harmface.stereo.map_by_light import settled_by_light
from harmface.stereo.measured import beside
from harmface.stereo.per_pixel import fit_robustly
from harmface.stereo.refinement import mapped, structure_of
from harmface.stereo.refinement import refine as refined
from harmface.stereo.result import Recovered
from harmface.stereo.second_order import second_order
from harmface.stereo.single_sources import refitted
from harmface.stereo.stack import ImageStack

Progress = Callable[[float], None]

OUTLINE_PRICE = 3.0
"""Most that a pixel on an outline may cost the cues if the outline is to be believed: about 1 on
true outlines, 4 and more on the borders of reliefs."""

WORSE = 0.05
"""Rise of the cues' cost, for each pixel, beyond which a refinement is not believed: sound ones
change it by -0.12 to 0.01, one led astray by highlights raised it by 0.25."""

WEAK = 1e-3
"""Share of the first singular value below which a ninth dimension is of no use."""


def recover(
    stack: ImageStack,
    *,
    order: int,
    refine: bool,
    outline: bool | None,
    normals: KnownNormals | None,
    symmetric: bool,
    smoothness: float | None,
    rng: np.random.Generator,
    progress: Progress,
) -> Recovered:
    """Return the structure by the method of an order ([BJK07]_), refined or not.

    What all pixels share is found on blocks of pixels, then every pixel follows.

    Parameters
    ----------
    stack
        Photographs in float64.
    order, refine, outline, symmetric, smoothness
        As in `photometric_stereo`.
    normals
        Normals measured at some pixels.
    rng
        Draws starting points and pixels.
    progress
        Called with the share of the work that is done.
    """
    factor = coarse_factor(stack.mask)
    coarse = coarse_stack(stack, factor)
    blocks = coarse.values.shape[1]
    measured = None
    if normals is not None:
        coarse, measured = beside(coarse, stack, normals)
    known = Knowledge(None, measured, mirror_index(coarse.mask) if symmetric else None)
    found = factorize(coarse.values, (4, 9)[order - 1])
    structure = found.light.T @ stack.values
    # Means over blocks lie inside the cone, so that of exact images is found from single pixels.
    cone = fit_null_cone(structure[:4]) if 1 - found.energy[3] < EXACT else None
    first, known = _first_order(found.structure[:4], coarse.mask, outline, known, cone, rng)
    progress(0.1)
    b = first.b
    warnings = []
    if not first.cone.signature_held:
        warnings.append("the quadric of the first-order structure lost its signature")
    exact = first.cone.exact
    if order == 2:
        b = second_order(found.structure, coarse.mask, b, known).b
        if 1 - found.energy[8] < EXACT:
            starts = (b, first.b)
            closed = exact_second_order(structure, found.structure, coarse.mask, starts, known, rng)
            if closed is not None:
                b, exact = closed, True
        elif found.singular_values[8] < WEAK * found.singular_values[0]:
            warnings.append(
                "images have fewer than nine usable dimensions: the light is smooth or changes "
                "little, so the second order adds little to the first"
            )
        progress(0.3)
    settled = None
    if not exact and not refine:
        settled = settled_by_light(coarse, found.structure, b, known, rng)
    model: LightModel = HarmonicLight(order)
    converged = None
    fit = refined(coarse, b, known, rng=rng) if refine else None
    progress(0.7)
    if fit is not None and not is_single(fit.model):
        turned = mapped(fit.transformation, fit.structure)
        rise = cue_cost(turned, coarse.mask, known) - cue_cost(b, coarse.mask, known)
        if rise > WORSE * len(b):
            fit = None
            warnings.append(
                "refinement was set aside: its surface contradicts integrability, outline or "
                "albedo more than the unrefined one; highlights or other light than points and a "
                "uniform part may be the reason"
            )
    if fit is not None:
        model, light, converged = fit.model, fit.light, fit.converged
        rows, weights, cues = fit.transformation, fit.weights, fit.cues
        raw = fit.structure[-3:].T
        if factor == 1:
            raw, weights = raw[:blocks], weights[:, :blocks]
        else:
            raw = spread_over(raw, found.structure, structure)
            raw, weights = _refitted(
                stack, model, light, raw, lambda done: progress(0.7 + 0.2 * done)
            )
        extended = structure_of(model, raw)
        b = mapped(rows, extended)
    else:
        if settled is not None:
            b = settled.scaled_normals(structure)
            rows, cues = settled.fit.transformation, settled.fit.cues
            extended = np.linalg.solve(rows, b.T)
        else:
            rows = np.linalg.lstsq(found.structure.T, b, rcond=None)[0].T
            extended, b = structure, structure.T @ rows.T
            cues = Cues(found.structure, coarse.mask, known, explain=order == 2)
        raw = b
        light = harmonic_light(stack.values, raw, order)
        weights = np.broadcast_to(1.0, stack.values.shape)
    by_light = fit if settled is None else settled.fit
    if b[:, 2].sum() < 0:
        rows, b = -rows, -b
    noise = noise_error(stack.values, model, light, raw, weights)
    systematic = ambiguity_error(cues, rows, extended)
    if settled is not None:
        bent = spread_to_nearest(settled.truncation_error[:blocks], coarse.mask, stack.mask, factor)
        systematic = np.hypot(systematic, bent)
    if smoothness is not None and fit is not None:
        b = _of_one_surface(stack, model, light, rows, b, weights, smoothness)
    b, convexity = _convex(b, stack.mask, known)
    noise = beside_neighbours(directions_of(b), stack.mask, noise)
    expected = np.minimum(np.hypot(noise, systematic), 90.0)
    return Recovered(
        "refined" if fit is not None else ("first order", "second order")[order - 1],
        b / np.linalg.norm(b, axis=1).max(),
        expected,
        convexity,
        signature_held=first.cone.signature_held,
        light_model=None if by_light is None else _name_of(by_light.model),
        converged=converged,
        warnings=tuple(warnings),
    )


def cue_cost(b: Float[np.ndarray, "c 3"], mask: Bool[np.ndarray, "H W"], known: Knowledge) -> float:
    """Return how much scaled normals, as they are, contradict what is known of surfaces."""
    scaled = b / np.linalg.norm(b, axis=1).max()
    return Cues(np.ascontiguousarray(scaled.T), mask, known).cost(np.eye(3))


def _first_order(
    structure: Float[np.ndarray, "4 c"],
    mask: Bool[np.ndarray, "H W"],
    outline: bool | None,
    known: Knowledge,
    cone: NullCone | None,
    rng: np.random.Generator,
) -> tuple[FirstOrder, Knowledge]:
    """Return the first-order structure, and what is known with the outline if it is believed."""
    rim = outline_of(mask)
    if outline is False or (outline is None and len(rim.pixels) < 16):
        return first_order(structure, mask, known, cone=cone, rng=rng), known
    knowing = replace(known, outline=rim)
    with_rim = first_order(structure, mask, knowing, cone=cone, rng=rng)
    if outline:
        return with_rim, knowing
    without = first_order(structure, mask, known, cone=cone, rng=rng)
    if with_rim.cost - without.cost < OUTLINE_PRICE * len(rim.pixels):
        return with_rim, knowing
    return without, known


def _refitted(
    stack: ImageStack,
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    start: Float[np.ndarray, "p 3"],
    progress: Progress,
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return every pixel fitted by itself, and the weights of its observations.

    A share of the pixels at a time, to hold no more than the weights beside the stack.
    """
    raw, weights = np.empty(start.shape), np.empty(stack.values.shape, np.float32)
    parts = interleaved(len(start), 64 * len(light))
    for number, some in enumerate(parts):
        values = stack.values[:, some]
        if is_single(model):
            raw[some], weights[:, some] = refitted(
                values, stack.usable[:, some], light, start[some]
            )
        else:
            raw[some], weights[:, some] = fit_robustly(
                values, stack.seen[:, some], model, light, start[some]
            )
        progress((number + 1) / len(parts))
    return raw, weights


def _of_one_surface(
    stack: ImageStack,
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    rows: Float[np.ndarray, "3 d"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
    smoothness: float,
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals as those of one surface, under light that was found for `rows^-1 b`."""
    if isinstance(model, HarmonicLight):
        light = harmonic_light(stack.values, b, model.degree)
    else:
        model = Mapped(model, np.linalg.inv(rows))
    return of_one_surface(stack, model, light, b, weights, smoothness)


def harmonic_light(
    values: Float[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"], degree: int
) -> Float[np.ndarray, "F K"]:
    """Return the coefficients of least squares for known structure."""
    gram, right = 0.0, 0.0
    for some in chunks(len(b), 8 * len(values)):
        images = scaled_normal_images(b[some], degree)
        gram, right = gram + images @ images.T, right + images @ values[:, some].T
    return np.linalg.lstsq(gram, right, rcond=1e-12)[0].T


def _convex(
    b: Float[np.ndarray, "p 3"], mask: Bool[np.ndarray, "H W"], known: Knowledge
) -> tuple[Float[np.ndarray, "p 3"], str]:
    """Return b, or its convex-concave counterpart, and what decided.

    (-x, -y, z) under light turned likewise makes the same images and is as integrable.
    Measured normals and outlines tell the two apart; without them the rim is made to lean
    outwards, as that of most objects does.
    """
    if known.normals is not None:
        return b, "known normals"
    if known.outline is not None:
        return b, "outline"
    rows, columns = np.nonzero(mask)
    rim = (mask & ~binary_erosion(mask, iterations=max(1, int(np.sqrt(mask.sum()) / 20))))[mask]
    x, y = columns - columns.mean(), rows.mean() - rows
    lean = ((b[:, 0] * x + b[:, 1] * y) / np.linalg.norm(b, axis=1).clip(min=1e-300))[rim].sum()
    return (b * (-1, -1, 1) if lean < 0 else b), "assumed"


def mirror_index(mask: Bool[np.ndarray, "H W"]) -> Int[np.ndarray, "p"]:
    """Return the index of each pixel's mirror image about the mask's middle column, or -1."""
    columns = np.flatnonzero(mask.any(axis=0))
    index = np.full(mask.shape, -1)
    index[mask] = np.arange(mask.sum())
    rows, here = np.nonzero(mask)
    there = columns[0] + columns[-1] - here
    inside = (there >= 0) & (there < mask.shape[1])
    return np.where(inside, index[rows, there.clip(0, mask.shape[1] - 1)], -1)


def _name_of(model: LightModel) -> str:
    if isinstance(model, PointLights):
        return "points and uniform" if model.ambient else "one point"
    return "harmonic"
