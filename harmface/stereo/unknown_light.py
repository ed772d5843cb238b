"""Surface normals from photographs under unknown light: structure, gauge, convexity, uncertainty.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion

from harmface.errors import ArgumentError
from harmface.stereo.coarse import coarse_factor, coarse_stack, nearest_blocks, spread_over
from harmface.stereo.cues import KnownDirections, MeasuredNormals, Rim, outline_of
from harmface.stereo.factorization import chunks, factorize, interleaved
from harmface.stereo.gauge import CONCAVE, Gauge, alike, spread_of_maps
from harmface.stereo.harmonic import EXACT, exact_second_order, first_order, second_order
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.light_models import (
    HarmonicLight,
    Mapped,
    PointLights,
    has_one_point,
    is_single,
)
from harmface.stereo.lorentz import fit_null_cone
from harmface.stereo.result import Recovered
from harmface.stereo.stack import ImageStack
from harmface.stereo.structure import Knowledge, Measured, Structure, explain
from harmface.stereo.surface import of_one_surface
from harmface.stereo.uncertainty import (
    MapError,
    beside_neighbours,
    map_error,
    noise_error,
    smoothed_noise,
)

Progress = Callable[[float], None]

WEAK = 1e-3
"""Share of the first singular value below which a ninth dimension is of no use."""


def refined(
    stack: ImageStack,
    *,
    known_normals: tuple[Int[np.ndarray, "k"], Float[np.ndarray, "k 3"]] | None,
    directions: Float[np.ndarray, "F 3"] | None,
    symmetric: bool,
    smoothness: float | None,
    rng: np.random.Generator,
    progress: Progress,
) -> Recovered:
    """Return the surface whose light and albedo explain the photographs.

    What all pixels share is found on blocks of pixels, then every pixel follows.

    Parameters
    ----------
    stack
        Photographs in float64.
    known_normals
        Columns of the stack at which normals were measured, and these.
    directions
        Unit directions to the lamps, zero where they are not known.
    symmetric, smoothness
        As in `photometric_stereo`.
    rng
        Draws starting points and pixels.
    progress
        Called with the share of the work that is done.
    """
    unit = float(stack.values.mean())
    factor = coarse_factor(stack.mask)
    coarse = coarse_stack(stack, factor)
    coarse = replace(coarse, values=coarse.values / unit)
    knowledge = Knowledge(symmetric=symmetric, directions=directions)
    if known_normals is not None:
        columns, normals = known_normals
        pixels = ImageStack(
            stack.values[:, columns] / unit,
            np.ones((1, len(columns)), bool),
            stack.seen[:, columns],
            stack.usable[:, columns],
        )
        near = nearest_blocks(columns, stack.mask, coarse.mask, factor)
        knowledge = replace(knowledge, measured=Measured(pixels, near, normals))
    found, gauge = explain(coarse, knowledge, rng)
    if directions is not None and not has_one_point(found.model):
        raise ArgumentError(
            "directions_known are those of one lamp an image, but these images show several; leave "
            "directions_known out"
        )
    progress(0.6)
    found = replace(found, light=found.light * unit, residual=found.residual * unit)
    if factor == 1:
        raw, weights = found.b, found.weights
    else:
        space = factorize(coarse.values, min(9, *coarse.values.shape))
        start = spread_over(found.b, space.structure, space.light.T @ stack.values / unit)
        raw, weights = _every_pixel(stack, found, start, lambda done: progress(0.6 + 0.3 * done))
    b = found.mapped(gauge.rows, raw)
    noise = noise_error(stack.values, found.model, found.light, raw, weights)
    if smoothness is not None:
        model, light = found.model, found.light
        if isinstance(model, HarmonicLight):
            light = harmonic_light(stack.values, b, model.degree)
        else:
            model = Mapped(model, np.linalg.inv(gauge.rows))
        smooth = of_one_surface(stack, model, light, b, weights, smoothness)
        noise = smoothed_noise(noise, b, smooth, stack.mask)
        b = smooth
    convex, how = _convex(b, stack.mask, gauge)
    lamps = None
    if is_single(found.model):
        lamps = found.light @ np.linalg.inv(gauge.rows) * (convex, convex, 1)
    return _recovered(
        "refined",
        b * (convex, convex, 1),
        noise,
        gauge,
        found.numbers(raw),
        stack.mask,
        how,
        light_model=_name_of(found),
        converged=found.converged,
        lamps=lamps,
    )


def harmonic(
    stack: ImageStack, *, order: int, rng: np.random.Generator, progress: Progress
) -> Recovered:
    """Return the closed form of an order ([BJK07]_): 4-D or 9-D, linear in the dimensions.

    Parameters
    ----------
    stack
        Photographs in float64.
    order
        1 or 2.
    rng
        Draws starting points.
    progress
        Called with the share of the work that is done.
    """
    coarse = coarse_stack(stack, coarse_factor(stack.mask))
    space = factorize(coarse.values, (4, 9)[order - 1])
    structure = space.light.T @ stack.values
    warnings = []
    # Means over blocks lie inside the cone, so that of exact images is found from single pixels.
    cone = fit_null_cone(structure[:4]) if 1 - space.energy[3] < EXACT else None
    found = first_order(space.structure[:4], coarse.mask, noise=space.noise, rng=rng, cone=cone)
    progress(0.3)
    if not found.signature_held:
        warnings.append(
            "the quadric of the first-order structure lost its signature: the closed form does not "
            "hold, use the method 'refined'"
        )
    if order == 2:
        found = second_order(space.structure, coarse.mask, found, noise=space.noise)
        if 1 - space.energy[8] < EXACT:
            exact = exact_second_order(structure, space.structure, coarse.mask, found, rng)
            found = found if exact is None else exact
        elif space.singular_values[8] < WEAK * space.singular_values[0]:
            warnings.append(
                "images have fewer than nine usable dimensions: the light is smooth or changes "
                "little, so the second order adds little to the first"
            )
    progress(0.8)
    rows = np.linalg.lstsq(space.structure.T, found.b, rcond=None)[0].T
    b = structure.T @ rows.T
    towards = np.sign(b[:, 2].sum()) or 1.0
    b = b * towards
    model = HarmonicLight(order)
    light = harmonic_light(stack.values, b, order)
    noise = noise_error(stack.values, model, light, b, np.broadcast_to(1.0, stack.values.shape))
    convex, how = _convex(b, stack.mask, found.gauge)
    numbers = spread_over(found.numbers, space.structure, structure)
    recovered = _recovered(
        ("4d", "9d")[order - 1],
        b * (convex, convex, 1),
        noise,
        found.gauge,
        numbers,
        stack.mask,
        how,
        signature_held=found.signature_held,
        warnings=tuple(warnings),
    )
    if found.signature_held:
        return recovered
    return replace(recovered, of_map=MapError(np.full(len(b), 90.0), (90.0, 90.0), 1.0))


def _recovered(
    method: str,
    b: Float[np.ndarray, "p 3"],
    noise: Float[np.ndarray, "p"],
    gauge: Gauge,
    numbers: Float[np.ndarray, "p d"],
    mask: Bool[np.ndarray, "H W"],
    convexity: str,
    *,
    lamps: Float[np.ndarray, "F 3"] | None = None,
    **found: Any,
) -> Recovered:
    """Return the result with its uncertainty."""
    of_map = map_error(spread_of_maps(gauge), gauge.rows, numbers)
    noise = beside_neighbours(directions_of(b), mask, noise)
    size = float(np.linalg.norm(b, axis=1).max())
    return Recovered(
        method,
        b / size,
        noise,
        of_map,
        convexity,
        beliefs=gauge.beliefs,
        lamps=None if lamps is None else lamps * size,
        **found,
    )


def _every_pixel(
    stack: ImageStack, found: Structure, start: Float[np.ndarray, "p 3"], progress: Progress
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return every pixel fitted by itself, and the weights of its observations.

    A share of the pixels at a time, to hold no more than the weights beside the stack.
    """
    raw, weights = np.empty(start.shape), np.empty(stack.values.shape, np.float32)
    parts = interleaved(len(start), 64 * len(found.light))
    for number, some in enumerate(parts):
        part = ImageStack(
            stack.values[:, some], stack.mask, stack.seen[:, some], stack.usable[:, some]
        )
        raw[some], weights[:, some] = found.at(part, start[some])
        progress((number + 1) / len(parts))
    return raw, weights


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
    b: Float[np.ndarray, "p 3"], mask: Bool[np.ndarray, "H W"], gauge: Gauge
) -> tuple[float, str]:
    """Return the sign of x and y that makes the surface convex, and what decided.

    (-x, -y, z) under light turned likewise makes the same images and is as integrable. On an
    outline normals lean outwards; where the border of the mask is none, it is made to lean so, as
    that of most objects does.
    """
    believed = {belief.name for belief in gauge.beliefs if belief.accepted}
    for measured in (MeasuredNormals.name, KnownDirections.name):
        # One that points at the camera does not tell.
        if measured in believed and not any(
            alike(CONCAVE @ rows, gauge.rows) for _, rows in gauge.rivals
        ):
            return 1.0, measured
    n = directions_of(b)
    if Rim.name in believed:
        outline = outline_of(mask)
        lean, how = (n[outline.pixels, :2] * outline.outward).sum(), "outline"
    else:
        rows, columns = np.nonzero(mask)
        width = max(1, int(np.sqrt(mask.sum()) / 20))
        rim = (mask & ~binary_erosion(mask, iterations=width))[mask]
        x, y = columns - columns.mean(), rows.mean() - rows
        lean, how = (n[:, 0] * x + n[:, 1] * y)[rim].sum(), "assumed"
    return (-1.0 if lean < 0 else 1.0), how


def _name_of(found: Structure) -> str:
    if isinstance(found.model, PointLights):
        return "points and uniform" if found.model.ambient else "one point"
    return "harmonic"
