"""Normals of a surface to be integrated, checked at the door."""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.camera import Camera, PerspectiveCamera, pixel_grid

STEEPEST = 20.0
"""Largest slope believed, 87 degrees: a pixel on an outline would outweigh all others."""


def checked_normals(
    normals: Float[np.ndarray, "H W 3"], mask: Bool[np.ndarray, "H W"] | None
) -> tuple[Float[np.ndarray, "p 3"], Bool[np.ndarray, "H W"]]:
    """Return the unit normals over a mask in float64, and the mask.

    Parameters
    ----------
    normals
        Unit normals over the mask; what lies outside is ignored.
    mask
        The surface; everything if not given.

    Raises
    ------
    ArgumentError
        If the mask is empty or of another size, or a normal is not of unit length.
    """
    normals = checks.vectors("normals", normals)
    if mask is None:
        mask = np.ones(normals.shape[:2], dtype=bool)
    mask = checks.mask("mask", mask, normals.shape[:2])
    if not mask.any():
        raise ArgumentError("mask must cover at least one pixel, got an empty one")
    return checks.unit_vectors("normals", normals[mask]).astype(np.float64), mask


def focal_pixel(camera: PerspectiveCamera) -> float:
    """Return the size of a pixel in units of the focal length."""
    return float(2 * np.tan(np.radians(camera.vertical_field_of_view) / 2) / camera.shape[0])


def view_slopes(shape: tuple[int, ...], camera: Camera | None) -> Float[np.ndarray, "2 H W"]:
    """Return X and Y of what each pixel sees at z = -1: rays are (X, Y, -1), zero if parallel."""
    if not isinstance(camera, PerspectiveCamera):
        return np.zeros((2, *shape))
    rows, columns = camera.shape
    return focal_pixel(camera) * np.stack(pixel_grid((rows, columns), 1)).reshape(2, rows, columns)


def towards_camera(
    normals: Float[np.ndarray, "*pixels 3"], view: Float[np.ndarray, "2 *pixels"]
) -> Float[np.ndarray, "*pixels"]:
    """Return the part of each normal along its ray, back to the camera: `n_z - X n_x - Y n_y`."""
    return normals[..., 2] - view[0] * normals[..., 0] - view[1] * normals[..., 1]


def facing_camera(
    normals: Float[np.ndarray, "H W 3"],
    mask: Bool[np.ndarray, "H W"],
    camera: Camera | None = None,
) -> Bool[np.ndarray, "H W"]:
    """Return the pixels of a mask whose normals face the camera: only those have a depth.

    Parameters
    ----------
    normals
        Unit normals.
    mask
        The surface.
    camera
        The view; orthographic if not given.

    Returns
    -------
    numpy.ndarray
        Pixels of `mask` that face the camera, (H, W) bool.

    Raises
    ------
    ArgumentError
        If the sizes differ, or a normal is not finite.
    """
    normals = checks.finite("normals", checks.vectors("normals", normals))
    mask = checks.mask("mask", mask, normals.shape[:-1])
    return mask & (towards_camera(normals, view_slopes(mask.shape, camera)) > 0)


def slopes_along_rays(
    n: Float[np.ndarray, "p 3"], towards: Float[np.ndarray, "p"]
) -> Float[np.ndarray, "2 p"]:
    """Return `(n_x, n_y) / towards`, steep ones shortened without turning them.

    Parameters
    ----------
    n
        Unit normals.
    towards
        Part of each normal along its ray, back to the camera: n_z in an orthographic view.

    Raises
    ------
    ArgumentError
        If a normal looks away from the camera.
    """
    away = int((towards < 0).sum())
    if away:
        raise ArgumentError(
            f"normals must face the camera, but {away} of {len(n)} look away; "
            "leave those pixels out of the mask"
        )
    return np.asarray(n[:, :2].T / np.maximum(towards, np.hypot(n[:, 0], n[:, 1]) / STEEPEST))
