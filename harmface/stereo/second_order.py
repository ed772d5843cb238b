"""The second-order method: normals whose harmonics explain the nine-dimensional images.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.cues import NOTHING, Cues, Knowledge
from harmface.stereo.gauge import best_of, shifted


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """Structure of degree 2.

    Parameters
    ----------
    b
        Scaled normals, up to one scale.
    cost
        Of the cues, see `Cues`.
    """

    b: Float[np.ndarray, "p 3"]
    cost: float


def second_order(
    structure: Float[np.ndarray, "9 p"],
    mask: Bool[np.ndarray, "H W"],
    start: Float[np.ndarray, "p 3"],
    knowledge: Knowledge = NOTHING,
) -> SecondOrder:
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
        Scaled normals of the first-order method.
    knowledge
        What else is known.
    """
    cues = Cues(structure, mask, knowledge, explain=True)
    weight = 1 / np.maximum(np.linalg.norm(start, axis=1), np.finfo(np.float64).tiny)
    rows, *_ = np.linalg.lstsq(structure.T * weight[:, None], start * weight[:, None], rcond=None)
    leading = np.zeros((3, 9))
    leading[:, :4] = np.linalg.lstsq(
        structure[:4].T * weight[:, None], start * weight[:, None], rcond=None
    )[0].T
    best = best_of(cues, [rows.T, leading], shifted, 27)
    return SecondOrder(structure.T @ best.T, cues.cost(best))
