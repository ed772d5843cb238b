"""Highlights: the dimensions that a shiny skin adds to a harmonic subspace.

Phong's lobe is a function of the angle between the light and the mirrored view `R(n)`, so that a
shiny surface convolves the light as a matt one does ([RH01b]_), and looks like
`share L_lm rho_l Y_lm(R(n))` on top of its diffuse image. With the share known that is added to the
harmonic images, and the subspace keeps its dimension. With the share unknown, the images
`T_lm = rho_l Y_lm(R(n))` may be added as dimensions, but nine or more of them fit too much.

Which few are best? For a lamp that may stand anywhere, all coefficients `L_lm` have the same
variance and none is correlated with another (the addition theorem). So of the specular image's part
outside the diffuse subspace, `sum L_lm T'_lm`, the expected energy is `sum |T'_lm|^2`, and `k`
dimensions capture the most of it if they are the leading principal components of the `T'_lm`
(Eckart and Young). For a face the first holds 16 % of what a lobe of exponent 8 leaves and the
first four 41 %: each helps a little, and the known share far more.

References
----------
.. [RH01b] Ramamoorthi and Hanrahan, A Signal-Processing Framework for Inverse Rendering,
   SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.recognition.meshes import SUPERSAMPLING
from harmface.reflectance import Phong
from harmface.sphere import real_harmonics


def phong_coefficients(exponent: float, max_degree: int) -> Float[np.ndarray, "L"]:
    """Return `rho_l = 2 pi int_0^1 c^e P_l(c) dc`, by which a lobe scales light of degree `l`.

    Of the lobe `max(r . w, 0)^e`, not normalised; see `reflectance.Phong`.

    Parameters
    ----------
    exponent
        Sharpness `e`, at least 0.
    max_degree
        Greatest degree.

    Returns
    -------
    numpy.ndarray
        Shape (max_degree + 1,), in float64.

    Raises
    ------
    ArgumentError
        If the exponent or the degree is negative.

    Examples
    --------
    With exponent 1 it is Lambert's law about the mirrored view:

    >>> phong_coefficients(1, 2) / np.pi
    array([1.        , 0.66666667, 0.25      ])
    """
    lobe = Phong(exponent)
    return 2 * np.pi / (exponent + 1) * lobe.radial(max_degree)


def specular_images(
    normals: Float[np.ndarray, "*pixels 3"],
    to_camera: Float[np.ndarray, "*pixels 3"],
    exponent: float,
    degree: int = 6,
) -> Float[np.ndarray, "K *pixels"]:
    """Return what a purely specular object looks like under each harmonic of the light.

    Radiance times pi, as `rendering.render` gives for a `Phong` lobe of share 1 without cast
    shadows; the cosine of incidence is taken at the middle of the lobe, `n . v`.

    Parameters
    ----------
    normals
        Unit normals that face the camera.
    to_camera
        Unit directions to the camera.
    exponent
        Sharpness of the lobe.
    degree
        Highest degree of the light that still matters: a lobe of exponent `e` passes about
        `2 sqrt(e)`.

    Returns
    -------
    numpy.ndarray
        Shape (K, ...) over the shape of the pixels.

    Raises
    ------
    ArgumentError
        If directions are not of length 1, or normals and directions differ in shape.
    """
    normals = checks.unit_vectors("normals", normals)
    to_camera = checks.unit_vectors("to_camera", to_camera)
    if normals.shape != to_camera.shape:
        raise ArgumentError(f"to_camera must match normals {normals.shape}, got {to_camera.shape}")
    facing = np.einsum("...i,...i->...", normals, to_camera)
    mirrored = 2 * facing[..., None] * normals - to_camera
    spectrum = (exponent + 2) / 2 * phong_coefficients(exponent, degree)[degrees(degree)]
    spectrum = spectrum.reshape(-1, *[1] * facing.ndim)
    return real_harmonics(mirrored, degree) * spectrum * np.maximum(facing, 0)


def subject_highlights(
    mesh: Mesh, size: int, exponent: float, degree: int = 6
) -> Float[np.ndarray, "K H W"]:
    """Return the specular images of one subject in the common frontal frame, in float32.

    Parameters
    ----------
    mesh
        The subject.
    size
        Rows and columns, as in `enroll`.
    exponent, degree
        See `specular_images`.

    Returns
    -------
    numpy.ndarray
        Shape (K, size, size); zero off the subject.
    """
    view = gbuffer(mesh, frame_orthographic(mesh, size), SUPERSAMPLING)
    towards = view.camera.towards(view.position[view.mask])
    images = np.zeros(((degree + 1) ** 2, *view.mask.shape), np.float32)
    images[:, view.mask] = specular_images(view.normals[view.mask], towards, exponent, degree)
    return images


def extended_bases(
    bases: Float[np.ndarray, "N d p"], specular: Float[np.ndarray, "N K p"], extra: int = 1
) -> Float[np.ndarray, "N e p"]:
    """Return the bases with the dimensions added that hold most of the highlights.

    They are the leading principal components of what the specular images have outside each basis.

    Parameters
    ----------
    bases
        Orthonormal rows of each subject, see `orthonormal_basis`.
    specular
        Specular images of each subject, at least `extra` of them.
    extra
        How many dimensions to add.

    Returns
    -------
    numpy.ndarray
        Orthonormal rows, `d + extra` of each subject.

    Raises
    ------
    ArgumentError
        If there are fewer specular images than dimensions to add, or of other subjects.
    """
    specular = checks.finite("specular", specular)
    extra = checks.positive_integer("extra", extra)
    if specular.shape[1] < extra:
        raise ArgumentError(f"specular must hold at least {extra} images, got {specular.shape[1]}")
    if specular.shape[::2] != bases.shape[::2]:
        raise ArgumentError(
            f"specular must be of the subjects and pixels of bases {bases.shape[::2]}, "
            f"got {specular.shape[::2]}"
        )
    outside = specular - specular @ bases.swapaxes(1, 2) @ bases
    added = np.linalg.svd(outside, full_matrices=False)[2][:, :extra]
    return np.concatenate([bases, added.astype(bases.dtype)], axis=1)
