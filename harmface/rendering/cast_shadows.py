"""Harmonic images with cast shadows.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [LHK05] Lee, Ho and Kriegman, Acquiring Linear Subspaces for Face Recognition under Variable
   Lighting, PAMI 2005.
"""

import numpy as np
from jaxtyping import Float

from harmface.conventions import luminance
from harmface.geometry import GBuffer, Mesh
from harmface.rendering.precomputed_transfer import transfer

SAMPLES = 1024
"""Directions of the light: a face hides so little of it that as few will do."""


def shadowed_harmonic_images(
    view: GBuffer,
    caster: Mesh,
    degree: int = 2,
    *,
    albedo: Float[np.ndarray, "H W"] | None = None,
) -> Float[np.ndarray, "K H W"]:
    """Return `S_k = albedo T_k`: harmonic images with cast shadows.

    The integral over the light of [BJ03]_ with the visibility kept in it, the better variant of
    [LHK05]_: `transfer` without bounces. On a convex object it gives `harmonic_images`.

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
    received = transfer(caster, degree, view=view, samples=SAMPLES).coefficients
    return received * (luminance(view.albedo) if albedo is None else albedo)
