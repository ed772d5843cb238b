"""Subjects enrolled as meshes: harmonic images and photographs of each, in one common frame."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from harmface.conventions import luminance
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.nine_points import nine_points
from harmface.rendering import box_average, harmonic_images, render, shadowed_harmonic_images

SUPERSAMPLING = 2

SHADOWED_DEGREE = 4
"""Degree of the light with cast shadows, whose images go on beyond degree 2."""


def enroll(meshes: Mapping[str, Mesh], size: int = 64, cast_shadows: bool = True) -> Gallery:
    """Render the images by which every mesh is known.

    All images share the frontal orthographic frame of `frame_orthographic`: the whole mesh,
    centred by its bounding box, its height filling 1 / 1.05 of the picture. Compared are the pixels
    where every subject has a surface, so that the background of a probe plays no part.

    Parameters
    ----------
    meshes
        Mesh of each subject by name; faces look along +z.
    size
        Rows and columns of the images.
    cast_shadows
        Whether to render harmonic images with cast shadows too.

    Returns
    -------
    Gallery
        Harmonic images, and photographs under the nine points of light, all in float32.

    Raises
    ------
    ArgumentError
        If there is no mesh, or one that cannot be seen or is black, or no pixel shows all of them.
    """
    if not meshes:
        raise ArgumentError("meshes must hold at least one subject, got none")
    return gallery_of_meshes(
        {name: subject_models(mesh, size, cast_shadows) for name, mesh in meshes.items()}
    )


SubjectModels = tuple[np.ndarray, np.ndarray | None, np.ndarray]
"""Harmonic images of a subject, those with cast shadows, and photographs."""


def subject_models(mesh: Mesh, size: int, cast_shadows: bool = True) -> SubjectModels:
    """Return the images by which one mesh is known.

    Parameters
    ----------
    mesh
        The subject; faces look along +z.
    size
        Rows and columns of the images.
    cast_shadows
        Whether to render harmonic images with cast shadows too.

    Returns
    -------
    harmonic : numpy.ndarray
        Shape (9, size, size), in float32.
    shadowed : numpy.ndarray or None
        Shape (25, size, size), in float32.
    photographs : numpy.ndarray
        Shape (9, size, size), in float32, the brightest pixel of each 1.

    Raises
    ------
    ArgumentError
        If the mesh is black under some light.
    """
    light = DistantLight(nine_points(), np.eye(9))
    photographs = subject_photographs(mesh, light, size)
    if not photographs.any(axis=(1, 2)).all():
        raise ArgumentError("mesh is black under some light; give it some albedo")
    # An exposure for each, as a camera sets it.
    photographs = photographs / photographs.max(axis=(1, 2), keepdims=True)
    shadowed = subject_images(mesh, size, SHADOWED_DEGREE, True) if cast_shadows else None
    return subject_images(mesh, size, 2), shadowed, photographs


def gallery_of_meshes(
    models: Mapping[str, SubjectModels], facts: Mapping[str, object] | None = None
) -> Gallery:
    """Return the gallery of subjects by name, see `subject_models`.

    Parameters
    ----------
    models
        From `subject_models` by the subject's name, all of one size.
    facts
        How they were made: anything JSON can hold.

    Returns
    -------
    Gallery
        Its mask leaves the pixels where all subjects have a surface.

    Raises
    ------
    ArgumentError
        If no pixel shows all of them.
    """
    names = sorted(models)
    of_all, shadowed, photographs = zip(*(models[name] for name in names), strict=True)
    harmonic = np.stack(of_all)
    mask = np.asarray((harmonic[:, 0] > 0).all(axis=0))
    if not mask.any():
        raise ArgumentError("subjects must share some pixels, but no pixel shows all of them")
    return Gallery(
        Photographs(np.repeat(names, 9), np.concatenate(photographs)),
        mask,
        lights=np.tile(nine_points(), (len(names), 1)),
        harmonic=harmonic,
        shadowed=None if shadowed[0] is None else np.stack(shadowed),
        aligned=True,
        facts=facts or {},
    )


def subject_images(
    mesh: Mesh, size: int, degree: int, cast_shadows: bool = False
) -> Float[np.ndarray, "K H W"]:
    """Return the harmonic images of one subject in the common frontal frame, in float32.

    Parameters
    ----------
    mesh
        The subject.
    size
        Rows and columns.
    degree
        Highest degree of the light.
    cast_shadows
        Whether to cast rays for the shadows of the mesh on itself.

    Returns
    -------
    numpy.ndarray
        Shape (K, size, size): `pi` times the radiance that leaves, under a light that is each
        harmonic in turn.
    """
    if cast_shadows:
        # Rays must start on the surface, not at the mean of a pixel's samples, which lies in it.
        view = gbuffer(mesh, frame_orthographic(mesh, size * SUPERSAMPLING))
        fine = shadowed_harmonic_images(view, mesh, degree)
        return box_average(fine, SUPERSAMPLING).astype(np.float32)
    view = gbuffer(mesh, frame_orthographic(mesh, size), SUPERSAMPLING)
    return harmonic_images(view.normals, luminance(view.albedo), degree).astype(np.float32)


def subject_photographs(mesh: Mesh, light: DistantLight, size: int) -> Float[np.ndarray, "F H W"]:
    """Return photographs of one subject in the common frontal frame, with cast shadows.

    Rendered by the oracle and not by harmonics.

    Parameters
    ----------
    mesh
        The subject.
    light
        One photograph for each of its leading axis.
    size
        Rows and columns.

    Returns
    -------
    numpy.ndarray
        Shape (F, size, size), in float32: `pi` times the radiance that leaves.
    """
    view = gbuffer(mesh, frame_orthographic(mesh, size * SUPERSAMPLING))
    images = render(view, light, caster=mesh)
    return box_average(images, SUPERSAMPLING).astype(np.float32)
