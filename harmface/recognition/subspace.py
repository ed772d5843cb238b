"""Linear subspaces of images and the distance of an image to them."""

from typing import Any

import numpy as np
from array_api_compat import array_namespace
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.probes import checked_probes


def orthonormal_basis(
    images: Float[np.ndarray, "*subjects n p"], dimension: int
) -> Float[np.ndarray, "*subjects d p"]:
    """Return orthonormal rows that span the images as well as `dimension` rows can.

    They are the leading right singular vectors; where the images span fewer dimensions the
    remaining rows are zero, so that they take no part in a projection.

    Parameters
    ----------
    images
        Images of each subject as rows of pixels: at least `dimension` of them.
    dimension
        Dimension of the subspace.

    Returns
    -------
    numpy.ndarray
        Shape (..., dimension, p), in the images' dtype.

    Raises
    ------
    ArgumentError
        If there are fewer images than dimensions, or a subject whose images are all black.
    """
    images = checks.finite("images", images)
    dimension = checks.positive_integer("dimension", dimension)
    count, pixels = images.shape[-2:]
    if count < dimension:
        raise ArgumentError(
            f"images must number at least {dimension} for a {dimension}-D subspace, got {count}; "
            "give more images or a lower dimension"
        )
    _, values, rows = np.linalg.svd(images, full_matrices=False)
    if (values[..., 0] == 0).any():
        raise ArgumentError("images of a subject must not all be black")
    rows, values = rows[..., :dimension, :], values[..., :dimension]
    noise = values[..., :1] * max(count, pixels) * np.finfo(images.dtype).eps
    rows = np.where((values > noise)[..., None], rows, 0)
    missing = dimension - rows.shape[-2]
    padding = [(0, 0)] * (rows.ndim - 2) + [(0, missing), (0, 0)]
    return np.pad(rows, padding)


def subspace_distances(
    probes: Float[np.ndarray, "n p"], bases: Float[np.ndarray, "N d p"]
) -> Float[np.ndarray, "n N"]:
    """Return the distance of every probe to every subspace, relative to the probe's norm.

    The distance is `|x - Q^T Q x| / |x| = sqrt(1 - |Q x|^2 / |x|^2)`, in [0, 1]: 0 for an image
    that the subject can look like under some light (negative light included), 1 for one
    orthogonal to all it can look like. One matrix product serves all pairs.

    Parameters
    ----------
    probes
        Images as rows of pixels; none may be all black.
    bases
        Orthonormal rows of each subject, see `orthonormal_basis`.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), in [0, 1], in the probes' dtype.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, probes of another size than the bases, or bases whose squares
        overflow.
    """
    bases = checks.finite("bases", bases)
    probes = checked_probes(probes, bases.shape[-1])
    squared = np.einsum("np,np->n", probes, probes)
    try:
        with np.errstate(over="raise"):
            inside = captured(probes, bases.astype(probes.dtype, copy=False)) / squared[:, None]
    except FloatingPointError:
        raise ArgumentError("bases must be orthonormal, got rows too large for that") from None
    return np.sqrt(np.maximum(1 - inside, 0))


def captured(probes: Any, bases: Any) -> Any:
    """Return the squared norm of what every subspace holds of every probe, by one product.

    Parameters
    ----------
    probes
        Rows of pixels, (n, p), of any library that follows the array API.
    bases
        Orthonormal rows of each subject, (N, d, p), of the same.

    Returns
    -------
    Array
        Shape (n, N).
    """
    xp = array_namespace(probes, bases)
    subjects, dimension, pixels = bases.shape
    inside = probes @ xp.reshape(bases, (subjects * dimension, pixels)).T
    inside = xp.reshape(inside, (probes.shape[0], subjects, dimension))
    return xp.linalg.vecdot(inside, inside)
