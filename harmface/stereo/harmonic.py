"""The closed forms under general, unknown light: 4-D, 9-D, and the exact case.

They are linear in the images' leading dimensions and refine nothing.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.cues import (
    Albedo,
    Cue,
    Explained,
    Facing,
    Integrability,
    LightMetric,
    Rim,
    Rows,
    StructureField,
    TypicalShape,
    structure_field,
)
from harmface.stereo.gauge import Gauge, bas_reliefs, boosted, choose_map, lorentz_families
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.inflation import inflated_normals
from harmface.stereo.joint import JointFit, fit_jointly
from harmface.stereo.light_models import HarmonicLight
from harmface.stereo.lorentz import METRIC, NullCone, fit_null_cone, nearest_lorentz

EXACT = 1e-10
"""Share of the energy beyond nine dimensions, or that nine harmonics leave, that is rounding."""

PIXELS = 2000
"""Pixels that are fitted exactly; they fix 27 numbers."""

ITERATIONS = 400


@dataclass(frozen=True, eq=False)
class HarmonicStructure:
    """Scaled normals of a closed form.

    Parameters
    ----------
    b
        Scaled normals, up to one scale: linear in the images' leading dimensions.
    gauge
        What the cues chose.
    numbers
        v that the gauge's rows map.
    signature_held
        Whether the quadric of the first order had the signature that it must have.
    """

    b: Float[np.ndarray, "p 3"]
    gauge: Gauge
    numbers: Float[np.ndarray, "p d"]
    signature_held: bool


def first_order(
    structure: Float[np.ndarray, "4 p"],
    mask: Bool[np.ndarray, "H W"],
    *,
    noise: float,
    rng: np.random.Generator,
    cone: NullCone | None = None,
) -> HarmonicStructure:
    """Return scaled normals from the rank-4 structure of images under unknown light ([BJK07]_).

    The null cone leaves a Lorentz transformation; cues choose it. Light beyond degree 1 bends the
    cone, so where the pixels do not lie on it all twelve numbers of b = T v are free, and how near
    they are to a Lorentz transformation is one of the cues.

    Parameters
    ----------
    structure
        Rank-4 factor of the images over the mask.
    mask
        The pixels.
    noise
        Standard deviation of its components.
    rng
        Draws the transformations tried.
    cone
        The quadric, if it is known better than these pixels tell it.
    """
    cone = fit_null_cone(structure) if cone is None else cone
    if cone.exact:
        v = (cone.frame @ structure).T
        seen = structure_field(v, mask, np.ones(len(v)), np.full(len(v), noise))
        cues = _cues(seen, np.linalg.inv(cone.frame))
        gauge = choose_map(cues, lorentz_families(rng), boosted)
        return HarmonicStructure(v @ gauge.rows.T, gauge, v, cone.signature_held)
    v = structure.T
    seen = structure_field(v, mask, np.ones(len(v)), np.full(len(v), noise))
    # Rows T W^-1 of null vectors W v are those of a Lorentz transformation.
    back = np.linalg.inv(cone.frame)
    cues = [*_cues(seen), LightMetric(-back @ METRIC @ back.T)]
    families = [[rows @ cone.frame for rows in each] for each in lorentz_families(rng)]
    families.append(_leading(v, mask, noise, rng))
    gauge = choose_map(cues, families)
    return HarmonicStructure(v @ gauge.rows.T, gauge, v, cone.signature_held)


def _leading(
    v: Float[np.ndarray, "p 4"],
    mask: Bool[np.ndarray, "H W"],
    noise: float,
    rng: np.random.Generator,
) -> list[Rows]:
    """Return maps of the three leading dimensions, which reliefs hardly leave."""
    three = v[:, :3]
    seen = structure_field(three, mask, np.ones(len(v)), np.full(len(v), noise))
    rows = Integrability.of(seen).best_rows(rng)[0]
    return [np.pad(each, ((0, 0), (0, 1))) for each in bas_reliefs(rows, three)]


def second_order(
    structure: Float[np.ndarray, "9 p"],
    mask: Bool[np.ndarray, "H W"],
    start: HarmonicStructure,
    *,
    noise: float,
) -> HarmonicStructure:
    """Return scaled normals from the rank-9 structure of images under unknown light ([BJK07]_).

    If images are of degree 2 their structure is v = A^-1 S, and the scaled normals, rows 1 to 3
    of S, are a linear map b = T v of it: 27 numbers. The other rows follow from b: its length,
    and the products of its components over its length. So T is right when the nine harmonic
    images of T v span v again; light then is whatever maps the one to the other. The part of v
    outside their span is made small together with the cues, from the first-order result. Since
    T has 27 numbers rather than three a pixel, light beyond degree 2 cannot bend single normals.

    The span alone leaves a Lorentz transformation, six numbers, open: not a rotation only. With
    s = (|b|, b), a null vector, the nine images are combinations of the products `s_i s_j / s_0`.
    If s' = L s for a Lorentz transformation L, then `b'' = (s'_0 / s_0) (s'_1, s'_2, s'_3)` has
    the images of `s'_i s'_j / s_0`, which are linear in those of s: other normals, another
    albedo, the same space of images. The cues choose among them.

    Parameters
    ----------
    structure
        Rank-9 factor of the images over the mask.
    mask
        The pixels.
    start
        Result of the first order.
    noise
        Standard deviation of the structure's components.
    """
    v = structure.T
    seen = structure_field(v, mask, np.ones(len(v)), np.full(len(v), noise))
    cues = [*_cues(seen), Explained.of(seen)]
    gauge = choose_map(cues, [_linear(structure, start.b)])
    return HarmonicStructure(v @ gauge.rows.T, gauge, v, start.signature_held)


def exact_second_order(
    structure: Float[np.ndarray, "9 p"],
    blocks: Float[np.ndarray, "9 c"],
    mask: Bool[np.ndarray, "H W"],
    start: HarmonicStructure,
    rng: np.random.Generator,
) -> HarmonicStructure | None:
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
    start
        Result of the second order on the blocks; the mask blown up is tried too.
    rng
        Draws the Lorentz transformations tried.
    """
    some = np.linspace(0, structure.shape[1] - 1, min(PIXELS, structure.shape[1])).astype(int)
    values = structure[:, some]
    inflated = inflated_normals(mask) * np.linalg.norm(blocks, axis=0)[:, None]
    for b in (start.b, inflated):
        rows, *_ = np.linalg.lstsq(blocks.T, b, rcond=None)
        fit = _fit(values, values.T @ rows)
        if 2 * fit.energies[-1] <= EXACT * np.sum(values**2):
            break
    else:
        return None
    found = blocks.T @ np.linalg.lstsq(values.T, fit.b, rcond=None)[0]
    null = np.concatenate([np.linalg.norm(found, axis=1, keepdims=True), found], axis=1)
    seen = structure_field(null, mask, np.ones(len(null)), np.full(len(null), EXACT))
    aligned = nearest_lorentz(directions_of(found), directions_of(b))[1:]
    gauge = choose_map(_cues(seen), [[aligned], *lorentz_families(rng)], boosted)
    # At single pixels, where alone the exact relation between s and b holds.
    length = np.linalg.norm(fit.b, axis=1, keepdims=True)
    grown = np.concatenate([length, fit.b], axis=1) @ gauge.rows.T
    chosen = grown * (np.linalg.norm(grown, axis=1, keepdims=True) / length)
    rows, *_ = np.linalg.lstsq(values.T, chosen, rcond=None)
    return HarmonicStructure(blocks.T @ rows, gauge, null, start.signature_held)


def _cues(seen: StructureField, whitening: Float[np.ndarray, "d d"] | None = None) -> list[Cue]:
    cues: list[Cue | None] = [
        Integrability.of(seen, whitening),
        Albedo.of(seen),
        Facing.of(seen),
        Rim.of(seen),
        TypicalShape.of(seen),
    ]
    return [cue for cue in cues if cue is not None]


def _linear(structure: Float[np.ndarray, "d p"], b: Float[np.ndarray, "p 3"]) -> list[Rows]:
    """Return the linear functions of the structure, and of its first four rows, nearest to b."""
    weight = 1 / np.maximum(np.linalg.norm(b, axis=1), np.finfo(np.float64).tiny)[:, None]
    found = []
    for used in (len(structure), 4):
        rows = np.zeros((3, len(structure)))
        design = structure[:used].T * weight
        rows[:, :used] = np.linalg.lstsq(design, b * weight, rcond=None)[0].T
        found.append(rows)
    return found


def _fit(values: Float[np.ndarray, "9 p"], b: Float[np.ndarray, "p 3"]) -> JointFit:
    """Return the light and scaled normals that explain the structure as if it were images."""
    light = np.linalg.lstsq(scaled_normal_images(b, 2).T, values.T, rcond=None)[0].T
    return fit_jointly(values, HarmonicLight(2), light, b, iterations=ITERATIONS, tolerance=0.0)
