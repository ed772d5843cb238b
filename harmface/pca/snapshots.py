"""Components of images that are made block by block: the method of snapshots.

References
----------
.. [S87] Sirovich, Turbulence and the Dynamics of Coherent Structures I: Coherent Structures,
   Quarterly of Applied Mathematics 1987.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh

from harmface.errors import ArgumentError
from harmface.pca.gram import chunks

CHUNK = 2**23
"""Pixel values treated at a time: 64 MB in float64."""

DIRECT = 512
"""Side of the largest matrix that is decomposed directly; a larger one is iterated."""

ALL = slice(None)

Block = Callable[[slice, slice], Float[np.ndarray, "n c"]]
"""Makes a fresh array of some images (first slice) at some pixels (second slice)."""


class Components(NamedTuple):
    """Leading components of pixels scaled by the root of their weight."""

    eigenvalues: Float[np.ndarray, "count"]
    """Variance along each mode, falling."""
    modes: Float[np.ndarray, "count p"]
    """Orthonormal rows."""
    origin: Float[np.ndarray, "p"]
    """Mean image, not scaled; or black."""
    scores: Float[np.ndarray, "F count"]
    """Coordinates of each image along the modes."""
    energies: Float[np.ndarray, "F"]
    """Squared distance of each image from the origin."""


def over_images(
    block: Block, images: int, roots: Float[np.ndarray, "p"], count: int, subtract_mean: bool
) -> Components:
    """Decompose the inner products of all pairs of images, [S87]_, some pixels at a time."""
    gram, origin = np.zeros((images, images)), np.zeros(len(roots))
    parts = list(chunks(len(roots), max(1, CHUNK // images)))

    def deviations(some: slice) -> Float[np.ndarray, "F c"]:
        values = block(ALL, some)
        if subtract_mean:
            origin[some] = values.mean(axis=0, dtype=np.float64)
        values -= origin[some].astype(values.dtype)
        values *= roots[some].astype(values.dtype)
        return values

    for some in parts:
        values = deviations(some)
        gram += values @ values.T
    norms = np.square(origin * roots).sum()
    variances, vectors = _leading(gram, count, images * norms, values.dtype)
    lengths = np.sqrt(variances)
    onto = (vectors / lengths).T.astype(values.dtype)
    modes = np.concatenate([onto @ deviations(some) for some in parts], axis=1)
    return Components(variances / images, modes, origin, vectors * lengths, gram.diagonal())


def over_pixels(
    block: Block, images: int, roots: Float[np.ndarray, "p"], count: int, subtract_mean: bool
) -> Components:
    """Decompose the covariance of the pixels, fewer than images, some images at a time."""
    pixels = len(roots)
    covariance, origin = np.zeros((pixels, pixels)), np.zeros(pixels)
    parts = list(chunks(images, max(1, CHUNK // pixels)))
    if subtract_mean:
        origin = sum(block(some, ALL).sum(axis=0, dtype=np.float64) for some in parts) / images

    def deviations(some: slice) -> Float[np.ndarray, "c p"]:
        values = block(some, ALL)
        values -= origin.astype(values.dtype)
        values *= roots.astype(values.dtype)
        return values

    for some in parts:
        values = deviations(some)
        covariance += values.T @ values
    norms = np.square(origin * roots).sum()
    variances, vectors = _leading(covariance, count, images * norms, values.dtype)
    scores = np.empty((images, count))
    energies = np.empty(images)
    for some in parts:
        values = deviations(some)
        scores[some] = values @ vectors.astype(values.dtype)
        energies[some] = np.einsum("ip,ip->i", values, values)
    modes = vectors.T.astype(values.dtype)
    return Components(variances / images, modes, origin, scores, energies)


def _leading(
    matrix: Float[np.ndarray, "n n"], count: int, subtracted: float, dtype: np.dtype
) -> tuple[Float[np.ndarray, "count"], Float[np.ndarray, "n count"]]:
    """Return the largest eigenvalues, falling, with their eigenvectors as columns.

    `subtracted` is the sum of squares that the mean took away from a matrix whose products were
    made in precision `dtype`: what its rounding can leave is no signal.
    """
    n, eps = len(matrix), np.finfo(dtype).eps
    if matrix.trace() <= n * eps**2 * subtracted:
        raise ArgumentError("images must differ, got the same one throughout; vary the light")
    if n <= DIRECT or count >= n - 1:
        values, vectors = eigh(matrix, subset_by_index=(n - count, n - 1))
    else:
        # A start within the range of the matrix, and the same every time.
        values, vectors = eigsh(matrix, k=count, v0=matrix[matrix.diagonal().argmax()])
    values, vectors = values[::-1], vectors[:, ::-1]
    # Rounding of a sum grows like the square root of its length; ten times that is not signal.
    spanned = int(np.count_nonzero(values > 10 * np.sqrt(n) * eps * values[0]))
    if spanned < count:
        raise ArgumentError(
            f"count must be at most {spanned}, as many dimensions as the images span, got {count}; "
            "ask for fewer modes or vary the light more"
        )
    return values, vectors
