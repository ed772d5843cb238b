"""The second order of images that hold nothing beyond degree 2: exact but for the ambiguity."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.cues import Cues, Knowledge
from harmface.stereo.gauge import best_lorentz
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.inflation import inflated_normals
from harmface.stereo.joint import JointFit, fit_jointly
from harmface.stereo.light_models import HarmonicLight
from harmface.stereo.lorentz import nearest_lorentz
from harmface.stereo.refinement import mapped, structure_of

EXACT = 1e-10
"""Share of the energy beyond nine dimensions, or that nine harmonics leave, that is rounding."""

MODEL = HarmonicLight(2)

PIXELS = 2000
"""Pixels that are fitted; they fix 27 numbers."""

ITERATIONS = 400


def exact_second_order(
    structure: Float[np.ndarray, "9 p"],
    blocks: Float[np.ndarray, "9 c"],
    mask: Bool[np.ndarray, "H W"],
    starts: Iterable[Float[np.ndarray, "c 3"]],
    knowledge: Knowledge,
    rng: np.random.Generator,
) -> Float[np.ndarray, "c 3"] | None:
    """Return scaled normals T v whose harmonics span the structure v, or None if none were found.

    Each pixel is free, so the harmonics of the true scaled normals leave nothing, and neither do
    those of a Lorentz transformation of them, see `second_order`; the cues choose it.

    Parameters
    ----------
    structure
        Rank-9 factor of the images at single pixels, since the mean over a block is not of
        degree 2.
    blocks
        The same over blocks of pixels.
    mask
        The blocks.
    starts
        Scaled normals of other methods on the blocks; the mask blown up is tried too.
    knowledge
        What else is known, of the blocks.
    rng
        Draws the Lorentz transformations tried.
    """
    some = np.linspace(0, structure.shape[1] - 1, min(PIXELS, structure.shape[1])).astype(int)
    values = structure[:, some]
    inflated = inflated_normals(mask)
    inside = blocks[:, : len(inflated)]
    inflated = inflated * np.linalg.norm(inside, axis=0)[:, None]
    blown = blocks.T @ np.linalg.lstsq(inside.T, inflated, rcond=None)[0]
    for b in (*starts, blown):
        rows, *_ = np.linalg.lstsq(blocks.T, b, rcond=None)
        fit = _fit(values, values.T @ rows)
        if 2 * fit.energies[-1] <= EXACT * np.sum(values**2):
            break
    else:
        return None
    rows, *_ = np.linalg.lstsq(values.T, fit.b, rcond=None)
    found = blocks.T @ rows
    null = structure_of(MODEL, found)
    aligned = nearest_lorentz(directions_of(found), directions_of(b))
    transformation = best_lorentz(Cues(null, mask, knowledge), [aligned[1:]], rng)
    chosen = mapped(transformation, structure_of(MODEL, fit.b))
    rows, *_ = np.linalg.lstsq(values.T, chosen, rcond=None)
    return np.asarray(blocks.T @ rows)


def _fit(values: Float[np.ndarray, "9 n"], b: Float[np.ndarray, "n 3"]) -> JointFit:
    light = np.linalg.lstsq(scaled_normal_images(b, 2).T, values.T, rcond=None)[0].T
    return fit_jointly(values, MODEL, light, b, iterations=ITERATIONS, tolerance=0)
