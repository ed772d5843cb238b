"""Harmonic images with cast shadows, by casting rays to sampled light.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [LHK05] Lee, Ho and Kriegman, Acquiring Linear Subspaces for Face Recognition under Variable
   Lighting, PAMI 2005.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count, luminance
from harmface.geometry import GBuffer, Mesh, visible
from harmface.rendering.reference import clamped_cosines
from harmface.sphere import lebedev, real_harmonics

EXACT_DEGREE = 47
"""Degree to which the quadrature is exact: 770 directions, 7 degrees apart."""

CHUNK = 2**22
"""Pairs of direction and pixel treated at a time: 32 MB."""


def shadowed_harmonic_images(
    view: GBuffer,
    caster: Mesh,
    degree: int = 2,
    *,
    albedo: Float[np.ndarray, "H W"] | None = None,
) -> Float[np.ndarray, "K H W"]:
    """Return `S_k = albedo sum_j w_j max(n . w_j, 0) V_j Y_k(w_j)`: harmonic images with shadows.

    The integral over the light of [BJ03]_ with the visibility `V` kept in it, the better variant
    of [LHK05]_. On a convex object it gives `harmonic_images`.

    Parameters
    ----------
    view
        What the camera sees of the subject.
    caster
        The mesh that casts shadows, usually that of the view.
    degree
        Highest degree of the light.
    albedo
        By default the luminance of the view's.

    Returns
    -------
    numpy.ndarray
        `K = (degree + 1)**2` images in float64; zero in the background.
    """
    degree = checks.degree("degree", degree)
    rule = lebedev(EXACT_DEGREE)
    weighted = real_harmonics(rule.directions, degree) * rule.weights
    normals, points = view.normals[view.mask], view.position[view.mask]
    irradiance = np.zeros((harmonic_count(degree), len(normals)))
    step = max(1, CHUNK // len(normals))
    for first in range(0, len(rule.directions), step):
        some = slice(first, first + step)
        directions = rule.directions[some]
        cosines = clamped_cosines(normals, directions)
        cosines *= visible(caster, points, normals, directions)
        irradiance += weighted[:, some] @ cosines
    images = np.zeros((len(irradiance), *view.mask.shape))
    albedo = luminance(view.albedo) if albedo is None else albedo
    images[:, view.mask] = albedo[view.mask] * irradiance
    return images
