"""Factorisation for point sources alone, the classical case before general light.

References
----------
.. [H94] Hayakawa, Photometric Stereo under a Light Source with Arbitrary Motion, JOSA A 1994.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError
from harmface.stereo.robust_factorization import factorize_robustly


def point_source_structure(
    values: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"] | None = None,
    *,
    equal_lights: bool = True,
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals up to a rotation or reflection, for one point source an image.

    Where the light reaches, `I = b . l`, so the images have rank 3 ([H94]_) and M = L B' up to
    any invertible 3 x 3 matrix. If all sources have the same strength, `l_i Q l_i' = 1` for the
    symmetric Q = H H' that undoes it: six unknowns, linear in Q, and l_i H has length 1.

    Parameters
    ----------
    values
        Images as rows of pixels.
    usable
        Observations not in shadow and not saturated.
    equal_lights
        Whether the sources are equally strong; otherwise the result is up to any linear map.

    Returns
    -------
    numpy.ndarray
        Albedo times normal up to that, shape (p, 3).

    Raises
    ------
    ArgumentError
        If there are fewer than six images, or no common strength fits them.
    """
    factors = factorize_robustly(values, 3, usable)
    if not equal_lights:
        return factors.structure.T
    if len(factors.light) < 6:
        raise ArgumentError(
            f"images must number at least 6 for sources of equal strength, got {len(factors.light)}"
        )
    metric = equal_strength_metric(factors.light)
    if metric is None:
        raise ArgumentError(
            "images must come from point sources of equal strength, but no strength fits them; "
            "use general light, or say that the sources differ"
        )
    return np.linalg.solve(np.linalg.cholesky(metric), factors.structure).T


def equal_strength_metric(light: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "3 3"] | None:
    """Return the symmetric Q with `l Q l' = 1` for every source, or None if none has a root.

    For the right map T of the structure, the sources `l T^-1` have length 1, so `T Q T' = 1`.
    Fewer than six sources leave it open.
    """
    i, j = np.triu_indices(3)
    design = light[:, i] * light[:, j] * np.where(i == j, 1.0, 2.0)
    solution, *_ = np.linalg.lstsq(design, np.ones(len(light)), rcond=None)
    metric = np.empty((3, 3))
    metric[i, j] = metric[j, i] = solution
    return metric if np.linalg.eigvalsh(metric)[0] > 0 else None
