"""What integrability says about an unknown linear map of the structure, in closed form.

Scaled normals b = T v come from unknown rows t_x, t_y, t_z of T and known v, three or four
numbers a pixel. A surface z(x, y) has slopes z_x = -b_x / b_z and z_y = -b_y / b_z, and equal
mixed derivatives: `d/dy (b_x / b_z) = d/dx (b_y / b_z)`. Times b_z^2 that is

    (b_z d_y b_x - b_x d_y b_z) - (b_z d_x b_y - b_y d_x b_z) = 0,

and each bracket is the bivector t_z ^ t_x (or t_z ^ t_y) applied to v ^ dv: bilinear in the rows
but linear in their 2 x 2 minors, three or six each ([YS97]_, [BJK07]_). The minors are the null
vector of a homogeneous system; t_z is where their two planes meet; t_x and t_y are known up to
multiples of t_z, and t_z up to scale: the generalised bas-relief freedom, three numbers.

References
----------
.. [YS97] Yuille and Snow, Shape and Albedo from Multiple Images using Integrability, CVPR 1997.
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.cells import Cells, cells_of

ROUNDS = 8
"""Reweightings against discontinuities."""


def wedge(v: Float[np.ndarray, "c d"], w: Float[np.ndarray, "c d"]) -> Float[np.ndarray, "c e"]:
    """Return the 2 x 2 minors `v_i w_j - v_j w_i`, i < j, of pairs of vectors."""
    i, j = np.triu_indices(v.shape[1], 1)
    return v[:, i] * w[:, j] - v[:, j] * w[:, i]


def integrable_rows(structure: Float[np.ndarray, "d p"], cells: Cells) -> Float[np.ndarray, "3 d"]:
    """Return rows t_x, t_y, t_z that make `T v` integrable, up to a bas-relief transformation.

    t_x and t_y are orthogonal to t_z and share their scale; t_z has unit length. Cells at
    discontinuities are found by their residual and lose their say.

    Parameters
    ----------
    structure
        Three or four numbers a pixel, all scaled alike: divide by an albedo if there is one.
    cells
        Where to take derivatives.
    """
    v = structure.T
    middle = cells.middle(v)
    design = np.concatenate(
        [wedge(middle, cells.along_y(v)), -wedge(middle, cells.along_x(v))], axis=1
    )
    size = np.linalg.norm(design, axis=1)
    weights = np.ones(len(design))
    for _ in range(ROUNDS):
        squared = np.einsum("c,ci,cj->ij", weights, design, design)
        minors = np.linalg.eigh(squared)[1][:, 0]
        residual = np.abs(design @ minors)
        # L1 rather than L2: 1 / |r|, kept finite by what rounding leaves of the largest cell.
        weights = 1 / np.maximum(residual, max(np.median(residual), 1e-12 * size.max()))
    zx, zy = np.split(minors, 2)
    return _rows_from_minors(_antisymmetric(zx), _antisymmetric(zy))


def integrable_start(
    structure: Float[np.ndarray, "d p"], mask: Bool[np.ndarray, "H W"]
) -> Float[np.ndarray, "3 d"]:
    """Return `integrable_rows` of unit length, the structure's length taken for its albedo.

    A start for searches that try bas-relief transformations of it.

    Parameters
    ----------
    structure
        Three or four numbers a pixel.
    mask
        The pixels.
    """
    length = np.maximum(np.linalg.norm(structure, axis=0), np.finfo(np.float64).tiny)
    rows = integrable_rows(structure / length, cells_of(mask))
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def isometric_rows(
    rows: Float[np.ndarray, "3 d"], metric: Float[np.ndarray, "d d"]
) -> Float[np.ndarray, "3 d"] | None:
    """Return the member of a bas-relief family of rows with `T G T'` a multiple of the identity.

    The rows are orthogonal in G and equally long, and that fixes the three numbers: multiples of
    t_z are taken from t_x and t_y, and t_z is scaled to their length. What differences over cells
    leave of the products of t_x and t_y is shared by both, so that the result is an isometry
    to rounding. Returns None if G gives no length to the rows, as noise can make it.

    Parameters
    ----------
    rows
        From `integrable_rows`.
    metric
        G: minus `lorentz.METRIC` for null vectors.
    """
    x, y, z = rows
    length = z @ metric @ z
    if length <= 0:
        return None
    x = x - (x @ metric @ z) / length * z
    y = y - (y @ metric @ z) / length * z
    found = np.stack([x, y, z])
    squares, axes = np.linalg.eigh(found @ metric @ found.T)
    if squares[0] <= 0:
        return None
    return np.asarray((axes / np.sqrt(squares)) @ axes.T @ found)


def _antisymmetric(minors: Float[np.ndarray, "e"]) -> Float[np.ndarray, "d d"]:
    size = {3: 3, 6: 4}[len(minors)]
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size, 1)] = minors
    return matrix - matrix.T


def _rows_from_minors(
    zx: Float[np.ndarray, "d d"], zy: Float[np.ndarray, "d d"]
) -> Float[np.ndarray, "3 d"]:
    """Solve `t_z t_x' - t_x t_z' = zx` and the same with y, for t_x, t_y orthogonal to t_z."""
    outside = np.zeros_like(zx)
    for matrix in (zx, zy):
        plane = np.linalg.svd(matrix)[0][:, :2]
        outside += np.eye(len(zx)) - plane @ plane.T
    z = np.linalg.eigh(outside)[1][:, 0]
    return np.stack([-zx @ z, -zy @ z, z])
