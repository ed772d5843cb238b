"""Depth from normals by sparse weighted least squares, over any mask.

References
----------
.. [QA13] Quéau and Durou, Edge-Preserving Integration of a Normal Field: Weighted Least-Squares,
   TV and L1 Approaches, SSVM 2015.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.camera import Camera, PerspectiveCamera
from harmface.geometry.slopes import (
    checked_normals,
    focal_pixel,
    slopes_along_rays,
    towards_camera,
    view_slopes,
)

ROUNDS = 5
"""Reweightings against discontinuities."""

ANCHOR = 1e-9
"""Weight of z = 0 at every pixel: it fixes the free height of each connected part."""


def depth_least_squares(
    normals: Float[np.ndarray, "H W 3"],
    mask: Bool[np.ndarray, "H W"] | None = None,
    *,
    camera: Camera | None = None,
    weights: Float[np.ndarray, "H W"] | None = None,
    discontinuities: bool = False,
) -> Float[np.ndarray, "H W"]:
    """Return the height whose steps between neighbours fit the normals best.

    Between neighbours to the right, `z_j - z_i = (p_i + p_j) / 2` with p = -n_x / n_z, and
    upwards the same with q = -n_y / n_z; the equations of all pairs within the mask are solved
    at once, each weighed by the less sure of its pixels ([QA13]_). With `discontinuities` pairs
    that do not fit are weighed down and the system solved again.

    A perspective camera sees the point d (X, Y, -1), X and Y in units of the focal length. Its
    tangents `d_X (X, Y, -1) + d (1, 0, 0)` and likewise in Y are orthogonal to n, so that
    `(log d)_X = n_x / m` and `(log d)_Y = n_y / m` with `m = n_z - X n_x - Y n_y`: the same
    problem for log d.

    Parameters
    ----------
    normals
        Unit normals, x right and y up, z towards the viewer.
    mask
        The surface; everything if not given.
    camera
        The view; orthographic with pixels of unit size if not given.
    weights
        How sure each normal is, not negative.
    discontinuities
        Whether the surface may have steps.

    Returns
    -------
    numpy.ndarray
        For orthographic views the height towards the viewer, mean zero over the mask, in pixels
        or in the camera's unit; for a perspective one the distance along -z in units of its mean.
        Zero outside the mask.

    Raises
    ------
    ArgumentError
        If sizes differ, a weight is negative, or a normal looks away from the camera.
    """
    normals = checks.vectors("normals", normals)
    n, mask = checked_normals(normals, mask)
    if camera is not None and camera.shape != mask.shape:
        raise ArgumentError(f"camera must have the normals' size {mask.shape}, got {camera.shape}")
    slopes = np.zeros((2, *mask.shape))
    view = view_slopes(mask.shape, camera)[:, mask]
    slopes[:, mask] = slopes_along_rays(n, towards_camera(n, view))
    slopes *= focal_pixel(camera) if isinstance(camera, PerspectiveCamera) else -1
    sure = np.ones(mask.shape) if weights is None else checks.non_negative("weights", weights)
    if sure.shape != mask.shape:
        raise ArgumentError(f"weights must have the normals' size {mask.shape}, got {sure.shape}")
    steps, rise, weight = _pairs(slopes, mask, sure.astype(np.float64))
    z = _solved(steps, rise, weight)
    for _ in range(ROUNDS if discontinuities else 0):
        residual = np.abs(steps @ z - rise)
        scale = max(2 * float(np.median(residual)), 1e-6)
        z = _solved(steps, rise, weight / (1 + (residual / scale) ** 2))
    height = np.zeros(mask.shape)
    z -= z.mean()
    if isinstance(camera, PerspectiveCamera):
        distance = np.exp(z)
        height[mask] = distance / distance.mean()
    else:
        height[mask] = z * (1.0 if camera is None else camera.height / camera.shape[0])
    return height.astype(normals.dtype)


def _pairs(
    slopes: Float[np.ndarray, "2 H W"],
    mask: Bool[np.ndarray, "H W"],
    sure: Float[np.ndarray, "H W"],
) -> tuple[csr_array, Float[np.ndarray, "e"], Float[np.ndarray, "e"]]:
    """Return the differences between neighbours, what they should be, and their weights."""
    index = np.full(mask.shape, -1)
    count = int(mask.sum())
    index[mask] = np.arange(count)
    here, there, rise, weight = [], [], [], []
    # To the right, and upwards: from the lower row to the one above it.
    for slope, near, far in (
        (slopes[0], (slice(None), slice(None, -1)), (slice(None), slice(1, None))),
        (slopes[1], (slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        both = mask[near] & mask[far]
        here.append(index[near][both])
        there.append(index[far][both])
        rise.append(((slope[near] + slope[far]) / 2)[both])
        weight.append(np.minimum(sure[near], sure[far])[both])
    i, j = np.concatenate(here), np.concatenate(there)
    each = np.arange(len(i))
    steps = coo_array(
        (
            np.concatenate([np.ones(len(i)), -np.ones(len(i))]),
            (np.concatenate([each, each]), np.concatenate([j, i])),
        ),
        shape=(len(i), count),
    ).tocsr()
    return steps, np.concatenate(rise), np.concatenate(weight)


def _solved(
    steps: csr_array, rise: Float[np.ndarray, "e"], weight: Float[np.ndarray, "e"]
) -> Float[np.ndarray, "p"]:
    weighted = steps.T @ diags_array(weight)
    anchor = ANCHOR * max(float(weight.mean()) if weight.size else 0.0, 1.0)
    normal = weighted @ steps + anchor * diags_array(np.ones(steps.shape[1]))
    # Positive definite, so no pivoting: the symmetric ordering fills in half as much as another.
    factors = splu(
        normal.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.asarray(factors.solve(weighted @ rise))
