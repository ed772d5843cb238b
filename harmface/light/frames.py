"""Changes of frame that may mirror: orthogonal matrices of either determinant."""

import numpy as np
from jaxtyping import Float

from harmface.conventions import degrees, max_degree_of
from harmface.light.environment_map import check_frame
from harmface.sphere import rotate


def transformed(
    coefficients: Float[np.ndarray, "*channels K"], matrix: Float[np.ndarray, "3 3"]
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of light whose every direction `d` is moved to `matrix @ d`.

    A rotation turns the coefficients within each degree, [RH01]_ 3.2. A mirror is a rotation
    followed by the inversion `d -> -d`, which changes the sign of odd degrees.

    Parameters
    ----------
    coefficients
        Harmonic coefficients.
    matrix
        An orthogonal matrix, of determinant +1 or -1.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`, in the precision of `coefficients`.

    References
    ----------
    .. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
       Maps, SIGGRAPH 2001.

    Examples
    --------
    Light from +z, mirrored, comes from -z:

    >>> transformed(np.array([0.5, 0.0, 1.0, 0.0]), np.diag([1.0, 1.0, -1.0])).round(6) + 0.0
    array([ 0.5,  0. , -1. ,  0. ])
    """
    matrix = check_frame("matrix", matrix)
    if (matrix == np.eye(3)).all():
        return coefficients
    if np.linalg.det(matrix) > 0:
        return rotate(coefficients, matrix)
    odd = degrees(max_degree_of(coefficients.shape[-1])) % 2 == 1
    return rotate(np.where(odd, -coefficients, coefficients), -matrix)
