"""From photographs to recovered subjects, and to the photographs that were not taken."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.enrollment.subject import RelitSubject
from harmface.enrollment.surfaces import depths_near_generic
from harmface.errors import ArgumentError
from harmface.geometry import depth_least_squares
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.nine_points import nine_points
from harmface.stereo import photometric_stereo

BRIGHT = 95
"""Percentile that counts as the brightness of a picture."""

NEAR = 35.0
"""Degrees from a photograph's light within which another photograph would tell nothing new."""

GRAZING = 0.05
"""Least z of a recovered normal: what the camera sees does not look away."""


def from_known_lights(
    photographs: Float[np.ndarray, "n H W"], subjects: np.ndarray, lights: Float[np.ndarray, "n 3"]
) -> dict[str, RelitSubject]:
    """Recover the surface of every subject of a gallery, see `depths_near_generic`.

    Parameters
    ----------
    photographs
        Linear photographs under one light each, framed alike; one of a subject is enough.
    subjects
        Who each shows.
    lights
        Unit direction to the light of each.

    Returns
    -------
    dict of str to RelitSubject
        By subject, in sorted order.

    Raises
    ------
    ArgumentError
        If the numbers differ, a light stands behind the subject's plane, or a photograph is
        negative or NaN.
    """
    photographs = checks.non_negative("photographs", photographs)
    lights = checks.unit_vectors("lights", lights).astype(np.float64)
    if not len(photographs) == len(subjects) == len(lights):
        raise ArgumentError(
            f"photographs, subjects and lights must agree in number, got {len(photographs)}, "
            f"{len(subjects)} and {len(lights)}"
        )
    if min(photographs.shape[1:]) < 2:
        raise ArgumentError(
            f"photographs must be 2 x 2 pixels at least, got {photographs.shape[1:]}"
        )
    names, which = np.unique(subjects, return_inverse=True)
    each = [which == number for number in range(len(names))]
    depths, bright = depths_near_generic(
        [photographs[own] for own in each], [lights[own] for own in each]
    )
    return {
        str(name): _subject(depth, g) for name, depth, g in zip(names, depths, bright, strict=True)
    }


def from_stereo(
    photographs: Float[np.ndarray, "F H W"],
    lights: Float[np.ndarray, "F 3"] | None = None,
    symmetric: bool = True,
) -> RelitSubject:
    """Recover one subject from its photographs alone.

    With the lights known the surface is that of `from_known_lights`; a gallery of many subjects
    is better recovered there, where each helps the others. Without, it comes from
    `photometric_stereo`, which wants photographs under very different light.

    Parameters
    ----------
    photographs
        Linear photographs.
    lights
        Unit direction to the light of each, if known.
    symmetric
        Whether the subject is symmetric about the middle of its photographs, as faces are: what
        settles the surface under unknown light.

    Returns
    -------
    RelitSubject
        In the photographs' frame and unit.

    Raises
    ------
    ArgumentError
        As `from_known_lights`, and `photometric_stereo` on fewer than four photographs.
    """
    if lights is not None:
        found = from_known_lights(photographs, np.full(len(photographs), "subject"), lights)
        return found["subject"]
    result = photometric_stereo(photographs, symmetric=symmetric)
    normals = result.normals.copy()
    normals[..., 2] = np.maximum(normals[..., 2], GRAZING)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    depth = depth_least_squares(normals)
    # The light's strength is unknown: the frontal picture gets the brightness of the photographs.
    frontal = result.albedo * normals[..., 2]
    scale = np.percentile(photographs, BRIGHT) / np.percentile(frontal, BRIGHT)
    return RelitSubject(depth, result.albedo * scale)


def with_relit(gallery: Gallery) -> Gallery:
    """Return a gallery with the photographs that were not taken, as `relit`.

    They are rendered from the subjects' surfaces, under those of the nine points of light that no
    photograph of the subject is near. Together they span what a face can look like; photographs
    from the front alone do not.

    Parameters
    ----------
    gallery
        Photographs of known light.

    Returns
    -------
    Gallery
        As given otherwise.

    Raises
    ------
    ArgumentError
        As `from_known_lights`, and if lights are not known.
    """
    if gallery.lights is None:
        raise ArgumentError(
            "photographs must have names that tell the light, as Extended Yale B has, for surfaces "
            "to be recovered; recognise by the photographs alone"
        )
    photographs, subjects = gallery.photographs.images, gallery.photographs.subjects
    found = from_known_lights(photographs, subjects, gallery.lights)
    images, names = [photographs[:0]], [subjects[:0]]
    for name, subject in zip(gallery.names, found.values(), strict=True):
        nearest = (nine_points() @ gallery.lights[subjects == name].T).max(axis=1)
        missing = nine_points()[nearest < np.cos(np.radians(NEAR))]
        if len(missing):
            images.append(subject.photographs(missing))
            names.append(np.repeat(name, len(missing)))
    rendered, shown = np.concatenate(images), np.concatenate(names)
    # A camera would saturate where the photographs do.
    rendered = np.minimum(rendered, photographs.max()).astype(photographs.dtype)
    return replace(gallery, relit=Photographs(shown, rendered))


def _subject(depth: Float[np.ndarray, "H W"], g: Float[np.ndarray, "H W"]) -> RelitSubject:
    """Return the subject of which `g` is the albedo times the normals' z."""
    flat = RelitSubject(depth, np.ones_like(g))
    return RelitSubject(depth, g / flat.normals[..., 2])
