"""Principal components of images over light and materials together.

References
----------
.. [NE04] Nillius and Eklundh, Phenomenological Eigenfunctions for Image Irradiance, ICCV 2003, and
   Low-Dimensional Representations of Shaded Surfaces under Varying Illumination, CVPR 2003.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.sphere import frames_facing, mixed_functions


def materials_spectrum(
    materials: Float[np.ndarray, "M L P Q"],
    power: Float[np.ndarray, "..."],
    normals: Float[np.ndarray, "N 3"],
    to_camera: Float[np.ndarray, "N 3"],
) -> Float[np.ndarray, "n"]:
    """Return the variance of each principal component of images, largest first.

    Light of any direction has coefficients of variance `c_l`, none correlated with another; the
    material is any of those given. The covariance of pixels `x` and `y` is then
    `sum_lm c_l sum E[rho_lpq rho_lp'q'] f_lmpq(x) f_lmp'q'(y)`, `f` being the mixed functions of
    [R05]_ eq. 38: light and material enter by second moments only ([NE04]_).

    Parameters
    ----------
    materials
        Coefficients `rho_lpq` of each material, see `Material.coefficients`.
    power
        Variance `c_l` of each coefficient of the light, `(L,)`, at least 0.
    normals, to_camera
        Unit normals of the pixels, and unit directions to the camera, above them.

    Returns
    -------
    numpy.ndarray
        Variances, in squared radiance summed over pixels.

    Raises
    ------
    ArgumentError
        If shapes do not agree or a power is negative.
    """
    materials = checks.finite("materials", materials)
    power = checks.non_negative("power", power)
    if materials.ndim != 4 or materials.shape[1:2] != power.shape:
        raise ArgumentError(
            "materials must have shape (M, L, P, Q) with L powers of light, got "
            f"{materials.shape} and {power.shape}"
        )
    count, degrees, outgoing = materials.shape[:3]
    frames = frames_facing(normals, to_camera)
    local = np.einsum("pij,pi->pj", frames, to_camera)
    p, q = np.indices(materials.shape[2:])
    # The outgoing hemisphere alone matters: the even extension has no step at the horizon.
    even = 2 * materials * ((p + q) % 2 == 0)
    functions = mixed_functions(frames, local, degrees - 1, outgoing - 1)
    images = np.zeros((harmonic_count(degrees - 1), count, len(normals)))
    for l in range(degrees):  # noqa: E741 - the field's name for it
        block = slice(l**2, (l + 1) ** 2)
        images[block] = np.einsum("kpqn,apq->kan", functions[block], even[:, l]) * np.sqrt(
            power[l] / count
        )
    return np.linalg.svd(images.reshape(-1, len(normals)), compute_uv=False) ** 2
