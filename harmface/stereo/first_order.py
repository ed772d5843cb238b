"""The first-order method: four-dimensional images, their Lorentz ambiguity and its resolution.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.stereo.cells import cells_of
from harmface.stereo.cues import NOTHING, Cues, Knowledge
from harmface.stereo.gauge import best_linear, best_lorentz, best_of_families, reliefs, shifted
from harmface.stereo.inflation import inflated_normals
from harmface.stereo.integrability import integrable_rows, integrable_start, isometric_rows
from harmface.stereo.lorentz import METRIC, NullCone, fit_null_cone


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Structure of degree 1.

    Parameters
    ----------
    cone
        The quadric of the structure, and whether its signature held.
    null_vectors
        (albedo, albedo n) up to a scaled Lorentz transformation.
    b
        Scaled normals after the ambiguity was resolved, up to one scale.
    cost
        Of the cues, see `Cues`.
    """

    cone: NullCone
    null_vectors: Float[np.ndarray, "4 p"]
    b: Float[np.ndarray, "p 3"]
    cost: float


def first_order(
    structure: Float[np.ndarray, "4 p"],
    mask: Bool[np.ndarray, "H W"],
    knowledge: Knowledge = NOTHING,
    *,
    cone: NullCone | None = None,
    rng: np.random.Generator | int = 0,
) -> FirstOrder:
    """Return scaled normals from the rank-4 structure of images under unknown light ([BJK07]_).

    The null cone leaves a Lorentz transformation; cues choose it. Members tried are those of
    the closed form of integrability, the one nearest to the mask blown up, and random ones.
    Light beyond degree 1 bends the cone, so where the pixels do not lie on it the last step frees
    all twelve numbers of b = T v, starting from these, from the bas-relief family of the closed
    form, and from the best map of the three leading dimensions alone.

    Parameters
    ----------
    structure
        Rank-4 factor of the images over the mask.
    mask
        The pixels.
    knowledge
        What else is known.
    cone
        The quadric, if it is known better than these pixels tell it.
    rng
        Draws the transformations tried.
    """
    rng = checks.generator(rng)
    if cone is None:
        cone = fit_null_cone(structure)
    vectors = cone.frame @ structure
    # Off the cone the two readings of albedo differ; the cues want one that has no zeros.
    shown = np.concatenate([np.linalg.norm(vectors[1:], axis=0)[None], vectors[1:]])
    cues = Cues(shown, mask, knowledge)
    direct = shown / shown[0]
    rows = integrable_rows(direct, cells_of(mask))
    resolved = isometric_rows(rows, -METRIC)
    inflated = inflated_normals(mask)
    blown = np.linalg.lstsq(direct.T[: len(inflated)], inflated, rcond=None)[0].T
    starts = [] if resolved is None else [resolved, -resolved]
    lorentz = best_lorentz(cues, starts, rng)
    if cone.exact:
        # Of means over blocks, only these are linear in the structure.
        shown, best = vectors, lorentz
    else:
        unit = rows / np.linalg.norm(rows, axis=1, keepdims=True)
        leading = _of_three_dimensions(structure, mask, knowledge)
        three = np.linalg.lstsq(shown.T, leading, rcond=None)[0].T
        families = [[lorentz], [blown], [three], reliefs(unit)]
        best = best_of_families(cues, families, shifted, 12)
    return FirstOrder(cone, vectors, shown.T @ best.T, cues.cost(best))


def _of_three_dimensions(
    structure: Float[np.ndarray, "4 p"], mask: Bool[np.ndarray, "H W"], knowledge: Knowledge
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals from the three leading dimensions, which reliefs hardly leave."""
    three = structure[:3]
    cues = Cues(three, mask, knowledge)
    return three.T @ best_linear(cues, [integrable_start(three, mask)]).T
