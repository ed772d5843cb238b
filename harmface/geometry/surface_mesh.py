"""A mesh from a map of heights."""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.camera import PerspectiveCamera
from harmface.geometry.mesh import Mesh, vertex_normals
from harmface.geometry.slopes import view_slopes


def depth_to_mesh(
    depth: Float[np.ndarray, "H W"],
    mask: Bool[np.ndarray, "H W"],
    albedo: Float[np.ndarray, "H W"] | Float[np.ndarray, "H W 3"] | None = None,
    camera: PerspectiveCamera | None = None,
) -> Mesh:
    """Return the surface over a mask, two triangles to each 2 x 2 block of its pixels.

    Vertices are the pixels of the mask in row-major order.

    Parameters
    ----------
    depth
        Height towards the viewer in pixels; with a camera its distance along -z.
    mask
        The surface.
    albedo
        Grey or linear RGB, scaled so that its largest value is at most 1; white if not given.
    camera
        The view, if it is perspective.

    Returns
    -------
    Mesh
        In pixels for an orthographic view, in the unit of `depth` for a perspective one.

    Raises
    ------
    ArgumentError
        If the sizes differ, no 2 x 2 block lies in the mask, or a distance is not positive.
    """
    depth = checks.finite("depth", depth).astype(np.float64)
    mask = checks.mask("mask", mask, depth.shape)
    if albedo is None:
        albedo = np.ones(mask.shape)
    albedo = checks.non_negative("albedo", albedo).astype(np.float64)
    if albedo.shape[:2] != mask.shape:
        raise ArgumentError(f"albedo must have the size {mask.shape}, got {albedo.shape[:2]}")
    colour = albedo if albedo.ndim == 3 else np.repeat(albedo[..., None], 3, axis=2)
    rows, columns = mask.shape
    index = np.full(mask.shape, -1)
    index[mask] = np.arange(mask.sum())
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    whole = (a >= 0) & (b >= 0) & (c >= 0) & (d >= 0)
    if not whole.any():
        raise ArgumentError("mask must hold at least one block of 2 x 2 pixels, got none")
    a, b, c, d = (corner[whole] for corner in (a, b, c, d))
    faces = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
    if camera is None:
        y, x = np.nonzero(mask)
        vertices = np.stack([x + 0.5 - columns / 2, rows / 2 - y - 0.5, depth[mask]], axis=1)
    else:
        if camera.shape != mask.shape or not (depth[mask] > 0).all():
            raise ArgumentError(
                f"camera must have the size {mask.shape} and see positive distances only, "
                f"got {camera.shape} and a least distance of {depth[mask].min():.4g}"
            )
        rays = np.concatenate([view_slopes(mask.shape, camera), -np.ones((1, rows, columns))])
        vertices = camera.position + (depth * rays)[:, mask].T
    painted = colour[mask]
    return Mesh(vertices, faces, vertex_normals(vertices, faces), painted / max(painted.max(), 1.0))


def pixel_coordinates(mask: Bool[np.ndarray, "H W"]) -> Float[np.ndarray, "V 2"]:
    """Return texture coordinates of the vertices of `depth_to_mesh`: the centres of their pixels.

    u runs from 0 at the left edge of the picture to 1 at the right, v from the bottom to the top.

    Parameters
    ----------
    mask
        Pixels that are vertices, (H, W).

    Returns
    -------
    numpy.ndarray
        Shape (V, 2), u to the right and v upwards, in [0, 1], in the order of the vertices.
    """
    rows, columns = mask.shape
    y, x = np.nonzero(mask)
    return np.stack([(x + 0.5) / columns, 1 - (y + 0.5) / rows], axis=1)
