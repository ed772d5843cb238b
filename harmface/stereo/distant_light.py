"""From photographs to structure where distant light is known: directions or coefficients."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.stereo.factorization import interleaved
from harmface.stereo.gauge import Belief
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.known_lights import (
    EQUAL,
    UNKNOWNS,
    few_seen,
    normals_from_coefficients,
    normals_from_directions,
    normals_from_few,
    require_light_for_each,
    robust_weights,
)
from harmface.stereo.lamp_strengths import strengths_of
from harmface.stereo.light_models import HarmonicLight, LightModel, is_single
from harmface.stereo.result import Recovered
from harmface.stereo.single_sources import SINGLE
from harmface.stereo.stack import ImageStack
from harmface.stereo.surface import of_one_surface
from harmface.stereo.uncertainty import beside_neighbours, noise_error, smoothed_noise


def under_distant_light(
    stack: ImageStack,
    light: Float[np.ndarray, "F q"],
    strengths: Float[np.ndarray, "F"] | None,
    smoothness: float | None,
    progress: Callable[[float], None],
) -> Recovered:
    """Return the structure under known light, every pixel fitted by itself.

    A share of the pixels is fitted at a time, to spare memory. Arguments are those of
    `photometric_stereo`.

    Raises
    ------
    ArgumentError
        If light is neither directions nor coefficients, or not one for each image.
    """
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
    warnings += few_seen(few)
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
        return SINGLE, light * strengths[:, None], (), ()
    if len(light) <= UNKNOWNS:
        return SINGLE, light, (), (EQUAL,)
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
