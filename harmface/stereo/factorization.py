"""Best approximation of a stack of images by a product of light and structure, M ~ L S.

References
----------
.. [BJK07] Basri, Jacobs and Kemelmacher, Photometric Stereo with General, Unknown Lighting,
   IJCV 2007.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, 0.4.2.
.. [GD14] Gavish and Donoho, The Optimal Hard Threshold for Singular Values is 4/sqrt(3), IEEE
   Transactions on Information Theory 2014.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError

CHUNK = 2**22
"""Observations treated at a time: 32 MB in float64."""

MANY = 2**24
"""Observations in float32 from which products of single precision will do."""

TERMS = 1024
"""Products that are summed in single precision: many such sums average their rounding out."""


@dataclass(frozen=True, eq=False)
class Factorization:
    """`M ~ light @ structure` of the best approximation of a rank, and what is left over.

    Parameters
    ----------
    light
        Left singular vectors, orthonormal columns.
    structure
        Right singular vectors times their singular values: each row weighs as much as it
        explains.
    singular_values
        All of them, in decreasing order.
    noise
        Standard deviation of an observation about the approximation.
    rank
        Dimensions that stand out from noise, see `significant_rank`.
    """

    light: Float[np.ndarray, "F K"]
    structure: Float[np.ndarray, "K p"]
    singular_values: Float[np.ndarray, "n"]
    noise: float
    rank: int

    @property
    def energy(self) -> Float[np.ndarray, "n"]:
        """Share of the stack's energy in its best approximation of rank 1, 2, ..."""
        squared = self.singular_values**2
        return np.cumsum(squared) / squared.sum()


def factorize(values: Float[np.ndarray, "F p"], rank: int) -> Factorization:
    """Return the best approximation of a rank ([R05]_ 0.4.2, the SVD step of [BJK07]_).

    With M = U D V^T the Gram matrix is M M^T = U D^2 U^T, small since images are few, and
    D V^T = U^T M. So two passes over the stack suffice, in chunks of pixels, and nothing of its
    size is made. Singular values below about 1e-7 of the first drown in rounding; below 1e-4 in
    large stacks of float32, see `gram_matrix`.

    Parameters
    ----------
    values
        Images as rows of pixels.
    rank
        Dimensions to keep: at most the number of images and of pixels.

    Returns
    -------
    Factorization
        Light (F, rank) and structure (rank, p) in the dtype of `values`.

    Raises
    ------
    ArgumentError
        On NaN, or fewer images or pixels than dimensions.

    Examples
    --------
    >>> stack = np.outer([1.0, 2.0, 3.0], [1.0, 1.0, 2.0, 4.0])
    >>> best = factorize(stack, 1)
    >>> bool(np.allclose(best.light @ best.structure, stack))
    True
    """
    rank = checks.positive_integer("rank", rank)
    count, pixels = values.shape
    if min(count, pixels) < rank:
        raise ArgumentError(
            f"images and pixels must number at least {rank} for a factorisation of that rank, "
            f"got {count} images of {pixels} pixels; give more or lower the rank"
        )
    gram, rounding = gram_matrix(values)
    if not np.isfinite(gram).all():
        raise ArgumentError("images must be finite, got NaN, Inf or values whose square overflows")
    squared, light = np.linalg.eigh(gram)
    squared, light = np.maximum(squared[::-1], 0), light[:, ::-1][:, :rank]
    # Signs are arbitrary; a positive mean makes the first image of structure look like one.
    light = light * np.where(light.sum(axis=0) < 0, -1.0, 1.0)
    light = light.astype(values.dtype)
    structure = np.empty((rank, pixels), values.dtype)
    for some in chunks(pixels, count):
        structure[:, some] = light.T @ values[:, some]
    singular = np.sqrt(squared)[: min(count, pixels)]
    freedom = (count - rank) * (pixels - rank)
    noise = float(np.sqrt(squared[rank:].sum() / freedom)) if freedom else 0.0
    kept = significant_rank(singular, count / pixels, singular[0] * np.sqrt(rounding))
    return Factorization(light, structure, singular, noise, kept)


def leading_dimensions(values: Float[np.ndarray, "F p"]) -> Float[np.ndarray, "p 3"]:
    """Return the first three singular vectors as scaled normals, the first towards the viewer.

    Images are positive, so the first singular vector is of one sign. The three nearly span the
    scaled normals.
    """
    first, second, third = factorize(values, 3).structure
    b = np.stack([second, third, first * np.sign(first.sum())], axis=1)
    return np.asarray(b / np.linalg.norm(b, axis=1).mean())


def gram_matrix(values: Float[np.ndarray, "F p"]) -> tuple[Float[np.ndarray, "F F"], float]:
    """Return M M^T in float64, and the share of its largest eigenvalue that may be rounding.

    Large stacks of float32 are multiplied as they are, which is twice as fast, but only `TERMS`
    pixels at a time; the sums are added in float64. Against float64 the rounding of n sums was
    measured to be a third of eps / sqrt(n).
    """
    count, pixels = values.shape
    single = values.dtype == np.float32 and values.size >= MANY
    gram = np.zeros((count, count))
    parts = chunks(pixels, CHUNK // TERMS if single else count)
    for some in parts:
        part = values[:, some] if single else values[:, some].astype(np.float64, copy=False)
        gram += part @ part.T
    if single:
        return gram, float(np.finfo(np.float32).eps / np.sqrt(len(parts)))
    return gram, count * float(np.finfo(np.float64).eps)


def significant_rank(
    singular_values: Float[np.ndarray, "n"], aspect: float, rounding: float
) -> int:
    """Return how many singular values stand out from noise of unknown size.

    Noise alone has singular values about a median; [GD14]_ sect. III.C gives the multiple of the
    median beyond which keeping a direction lowers the error.

    Parameters
    ----------
    singular_values
        In decreasing order, all of them.
    aspect
        Rows over columns of the matrix, or the other way round.
    rounding
        Below this a singular value is none.
    """
    aspect = min(aspect, 1 / aspect)
    multiple = 0.56 * aspect**3 - 0.95 * aspect**2 + 1.82 * aspect + 1.43
    return int((singular_values > max(multiple * np.median(singular_values), rounding)).sum())


def chunks(pixels: int, height: int) -> list[slice]:
    """Return slices over the pixels with at most `CHUNK` observations each."""
    step = max(1, CHUNK // max(1, height))
    return [slice(first, first + step) for first in range(0, pixels, step)]


def interleaved(pixels: int, height: int) -> list[slice]:
    """Return slices like `chunks`, each of pixels from all over the image: a fair sample of it."""
    count = len(chunks(pixels, height))
    return [slice(first, None, count) for first in range(count)]
