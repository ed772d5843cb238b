"""Depth from normals in the Fourier domain.

References
----------
.. [FC88] Frankot and Chellappa, A Method for Enforcing Integrability in Shape from Shading
   Algorithms, PAMI 1988.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.geometry.slopes import checked_normals, slopes_along_rays


def depth_frankot_chellappa(
    normals: Float[np.ndarray, "H W 3"], mask: Bool[np.ndarray, "H W"] | None = None
) -> Float[np.ndarray, "H W"]:
    """Return the height z whose slopes are nearest to those of the normals ([FC88]_ eq. 21).

    With p = -n_x / n_z and q = -n_y / n_z, `Z(u, v) = -i (u P + v Q) / (u^2 + v^2)`. The picture
    is continued by its mirror images, so that it need not be periodic; slopes outside the mask
    count as zero, so that a silhouette is bent: use `depth_least_squares` there.

    Parameters
    ----------
    normals
        Unit normals with `n_z > 0`, x right and y up.
    mask
        The surface; everything if not given.

    Returns
    -------
    numpy.ndarray
        Height towards the viewer in pixels, of mean zero over the mask and zero outside.

    Raises
    ------
    ArgumentError
        If the normals are no unit vectors, the mask is empty or of another shape, or a normal faces
        away from the camera.

    Examples
    --------
    A plane that rises by half a pixel a pixel to the right:

    >>> normal = np.array([-1.0, 0.0, 2.0]) / np.sqrt(5)
    >>> depth = depth_frankot_chellappa(np.broadcast_to(normal, (8, 8, 3)).copy())
    >>> bool(depth[0, 7] > depth[0, 0])
    True
    """
    normals = checks.vectors("normals", normals)
    n, mask = checked_normals(normals, mask)
    slopes = np.zeros((2, *mask.shape))
    slopes[:, mask] = -slopes_along_rays(n, n[:, 2])
    p, q = slopes
    # Even continuation of z makes its slope across each mirror odd.
    p = np.block([[p, -p[:, ::-1]], [p[::-1], -p[::-1, ::-1]]])
    q = np.block([[q, q[:, ::-1]], [-q[::-1], -q[::-1, ::-1]]])
    rows, columns = p.shape
    u = 2 * np.pi * np.fft.fftfreq(columns)[None, :]
    v = -2 * np.pi * np.fft.fftfreq(rows)[:, None]
    squared = u**2 + v**2
    squared[0, 0] = 1
    spectrum = -1j * (u * np.fft.fft2(p) + v * np.fft.fft2(q)) / squared
    spectrum[0, 0] = 0
    height = np.fft.ifft2(spectrum).real[: mask.shape[0], : mask.shape[1]]
    return np.where(mask, height - height[mask].mean(), 0.0).astype(normals.dtype)
