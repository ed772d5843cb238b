"""Harmonic images: what a diffuse object looks like under each harmonic of the light.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics


def harmonic_images(
    normals: Float[np.ndarray, "*pixels 3"],
    albedo: Float[np.ndarray, "*pixels"],
    max_degree: int = 2,
) -> Float[np.ndarray, "K *pixels"]:
    """Return the basis images `S_k = albedo A_l Y_k(n)` of [BJ03]_, [RH01]_ eq. 2 and 7.

    The radiosity under lighting coefficients `L` is `L @ S`, see `relight`. Attached shadows
    are in it; cast shadows and interreflection are not.

    Parameters
    ----------
    normals
        Unit normals; where `albedo` is 0 (the background) they may be zero vectors.
    albedo
        Fraction of the light reflected, at least 0.
    max_degree
        Highest degree; 2 gives the nine images that hold 99.2 % of the energy ([R05]_ 0.3.2).

    Returns
    -------
    numpy.ndarray
        `K = (degree + 1)**2` images in the wider precision of both inputs.

    Raises
    ------
    ArgumentError
        On NaN, negative albedo, normals that are not of unit length, or a negative degree.

    Examples
    --------
    A white pixel that faces the viewer, in light of the same radiance 1 from everywhere
    (`L_00 = sqrt(4 pi)`), has irradiance pi:

    >>> images = harmonic_images(np.array([[0.0, 0.0, 1.0]]), np.array([1.0]))
    >>> bool(abs(np.sqrt(4 * np.pi) * images[0, 0] - np.pi) < 1e-12)
    True
    """
    normals = checks.vectors("normals", normals)
    albedo = checks.non_negative("albedo", albedo)
    if albedo.shape != normals.shape[:-1]:
        raise ArgumentError(
            f"albedo must have the shape of the pixels {normals.shape[:-1]}, got {albedo.shape}"
        )
    max_degree = checks.degree("max_degree", max_degree)
    dark = albedo == 0
    if dark.any():
        # Any direction serves where nothing is reflected; unit length is asked of the rest.
        normals = np.where(dark[..., None], np.array([0, 0, 1], normals.dtype), normals)
    normals = checks.unit_vectors("normals", normals)
    images = real_harmonics(normals, max_degree)
    per_degree = lambert_per_coefficient(max_degree).astype(images.dtype)
    images *= per_degree.reshape(-1, *[1] * albedo.ndim)
    return images * albedo


def relight(
    lighting: Float[np.ndarray, "*images K"], basis: Float[np.ndarray, "K *pixels"]
) -> Float[np.ndarray, "..."]:
    """Return `L @ S`: images under lighting coefficients, [RH01]_ eq. 7.

    Parameters
    ----------
    lighting
        Harmonic coefficients of radiance; leading axes are images and colour channels.
    basis
        Harmonic images, see `harmonic_images`.

    Returns
    -------
    numpy.ndarray
        Radiosity.

    Raises
    ------
    ArgumentError
        If the numbers of coefficients differ.
    """
    lighting, basis = checks.finite("lighting", lighting), checks.finite("basis", basis)
    if lighting.shape[-1:] != basis.shape[:1]:
        raise ArgumentError(
            f"lighting must have {basis.shape[0]} coefficients as the basis has images, "
            f"got shape {lighting.shape}"
        )
    return np.tensordot(lighting, basis, axes=1)


def outgoing_radiance(
    radiosity: Float[np.ndarray, "..."],
) -> Float[np.ndarray, "..."]:
    """Return the radiance `B / pi` that a diffuse surface of radiosity `B` sends out.

    Parameters
    ----------
    radiosity
        Albedo times irradiance; any shape.

    Returns
    -------
    numpy.ndarray
        Radiance, in the shape and precision of `radiosity`.

    Raises
    ------
    ArgumentError
        If the radiosity is not finite.

    Examples
    --------
    >>> outgoing_radiance(np.array([np.pi]))
    array([1.])
    """
    radiosity = checks.finite("radiosity", radiosity)
    return np.asarray(radiosity / np.asarray(np.pi, radiosity.dtype))
