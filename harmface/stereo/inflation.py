"""A first guess of a surface from its outline alone."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve


def inflated_normals(mask: Bool[np.ndarray, "H W"]) -> Float[np.ndarray, "p 3"]:
    """Return unit normals of the surface that the mask makes when blown up.

    With u the solution of Poisson's equation `lap u = -4`, u = 0 outside the mask, the surface is
    z = sqrt(u): exactly the hemisphere over a disc, and steep at any outline. Its normal is along
    `(-u_x, -u_y, 2 z)`, so nothing is divided by zero at the rim.

    Parameters
    ----------
    mask
        Pixels of the object.

    Returns
    -------
    numpy.ndarray
        One normal for each masked pixel, towards the viewer.
    """
    padded = np.pad(mask, 1)
    index = np.full(padded.shape, -1)
    count = int(mask.sum())
    index[padded] = np.arange(count)
    rows, columns = np.nonzero(padded)
    entries = [(np.arange(count), np.arange(count), np.full(count, 4.0))]
    for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        neighbour = index[rows + down, columns + right]
        inside = neighbour >= 0
        entries.append((np.flatnonzero(inside), neighbour[inside], np.full(inside.sum(), -1.0)))
    i, j, value = (np.concatenate(part) for part in zip(*entries, strict=True))
    u = np.zeros(padded.shape)
    u[padded] = spsolve(
        coo_array((value, (i, j)), shape=(count, count)).tocsc(), np.full(count, 4.0)
    )
    down, right = np.gradient(u)
    normals = np.stack([-right, down, 2 * np.sqrt(u)], axis=-1)[padded]
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
