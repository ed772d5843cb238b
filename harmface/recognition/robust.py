"""A robust distance to a subspace: blocks of pixels that no light explains lose their vote.

A cast shadow or a highlight that the subspace does not hold draws a plain projection towards
itself. Here the fit is reweighted, block by block (so that the weights are smooth in space): with
the energy `e_c` of block `c` of the probe and the energy `r_c` of what the fit leaves of it, it
minimises

    `sum_c t_c log(1 + r_c / (s^2 t_c)),  t_c = e_c + f n_c mean(e)`

A residual that is small against the block's own contrast counts as its square, as in the plain
distance; one that is large counts by its logarithm, and in a dark block, where `t_c` is small, for
next to nothing: that is a cast shadow that the subject's images know nothing of. `f` keeps blocks
that are all black, of `n_c` pixels, from counting for nothing at all.

Everything happens in sums over the block's pixels (`Q_c x_c`, `Q_c Q_c^T`, `|x_c|^2`), so that a
step costs as many operations as there are blocks, not pixels.

It supposes that probes are framed as the gallery is; the moved copies of `local_subspace` serve
where they are not.

References
----------
.. [HW77] Holland and Welsch, Robust Regression Using Iteratively Reweighted Least Squares, 1977.
"""

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.probes import checked_probes
from harmface.recognition.spanned import SubspaceDistance

SCALE = 0.15
"""The `s` above: residuals beyond this fraction of a block's amplitude count by their logarithm."""

FLOOR = 0.03
"""The `f` above."""

STEPS = 4
"""Fits, the first of them plain."""

BLOCKS_PER_HEIGHT = 12
"""Blocks in the height of an image: weights of single pixels would follow the noise."""

RIDGE = 1e-5
"""Added to the diagonal of the normal equations: what single precision resolves of them."""

SUBJECTS, PROBES = 2, 64
"""How many are treated at a time: their arrays fill no more than a cache."""


def pixel_blocks(mask: Bool[np.ndarray, "H W"]) -> Integer[np.ndarray, "C m"]:
    """Return which pixels of `images[:, mask]` make up each block; -1 where a block has fewer.

    Parameters
    ----------
    mask
        Pixels that take part.

    Returns
    -------
    numpy.ndarray
        Shape (blocks, pixels of a block): numbers of pixels of the mask, in row-major order.

    Raises
    ------
    ArgumentError
        If there are none.
    """
    if not mask.any():
        raise ArgumentError("mask must leave some pixels, but leaves none; widen it")
    side = max(1, round(mask.shape[0] / BLOCKS_PER_HEIGHT))
    numbers = np.full([-(-length // side) * side for length in mask.shape], -1)
    numbers[: mask.shape[0], : mask.shape[1]][mask] = np.arange(mask.sum())
    rows, columns = numbers.shape
    squares = numbers.reshape(rows // side, side, columns // side, side).swapaxes(1, 2)
    blocks = squares.reshape(-1, side * side)
    return blocks[(blocks >= 0).any(axis=1)]


def robust_distances(
    probes: Float[np.ndarray, "n p"],
    bases: Float[np.ndarray, "N d p"],
    blocks: Integer[np.ndarray, "C m"],
) -> Float[np.ndarray, "n N"]:
    """Return the robust distance of every probe to every subspace.

    It is `sqrt(s^2 sum_c t_c log(1 + r_c / (s^2 t_c)) / sum_c t_c)` at the fit that reweighting
    reaches ([HW77]_, weights `1 / (1 + r_c / (s^2 t_c))`); of a probe that fits well, nearly what
    `subspace_distances` gives. Exposure plays no part.

    Parameters
    ----------
    probes
        Images as rows of pixels; none may be all black.
    bases
        Orthonormal rows of each subject, see `orthonormal_basis`.
    blocks
        Pixels of each block, see `pixel_blocks`.

    Returns
    -------
    numpy.ndarray
        In single precision.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, or probes of another size than the bases.
    """
    subjects, _, pixels = bases.shape
    probes = checked_probes(probes, pixels)
    norms = np.sqrt(np.einsum("np,np->n", probes, probes, dtype=np.float64))
    cut = _cut((probes / norms[:, None]).astype(np.float32), blocks)
    energy = np.einsum("cnm,cnm->nc", cut, cut)
    counts = (blocks >= 0).sum(axis=1)
    tolerance = energy + FLOOR * counts / counts.sum()
    tolerance = tolerance.astype(np.float32)
    distances = np.empty((len(probes), subjects), np.float32)
    for first in range(0, subjects, SUBJECTS):
        some = slice(first, first + SUBJECTS)
        rows = _cut(bases[some].astype(np.float32), blocks)
        packed = _packed_products(rows)
        flat = rows.reshape(len(rows), -1, rows.shape[-1]).swapaxes(1, 2)
        for start in range(0, len(probes), PROBES):
            few = slice(start, start + PROBES)
            inside = (cut[:, few] @ flat).reshape(len(cut), -1, *rows.shape[1:3])
            inside = np.ascontiguousarray(inside.transpose(2, 1, 3, 0))
            distances[few, some] = _reweighted(inside, packed, energy[few], tolerance[few]).T
    return distances


def _reweighted(
    inside: Float[np.ndarray, "N n d C"],
    packed: Float[np.ndarray, "N C u"],
    energy: Float[np.ndarray, "n C"],
    tolerance: Float[np.ndarray, "n C"],
) -> Float[np.ndarray, "N n"]:
    """Return the distances of a few probes to a few subjects.

    Parameters
    ----------
    inside
        Projections `Q_c x_c`.
    packed
        Products `Q_c Q_c^T`, see `_packed_products`.
    energy
        `|x_c|^2`.
    tolerance
        `t_c`, of sum `1 + f`.
    """
    dimension = inside.shape[2]
    row, column = np.triu_indices(dimension)
    twice = np.where(row == column, 1, 2).astype(np.float32)
    square = np.empty((dimension, dimension), int)
    square[row, column] = square[column, row] = np.arange(len(row))
    # With all weights 1 the system is the identity. A subject of few images has rows of zeros.
    ridge = RIDGE * np.eye(dimension, dtype=np.float32)
    weights = np.ones((*inside.shape[:2], inside.shape[3]), np.float32)
    for _ in range(STEPS):
        system = (weights @ packed)[..., square] + ridge
        fit = np.linalg.solve(system, inside @ weights[..., None])
        squares = fit[..., row, 0] * fit[..., column, 0] * twice
        residual = squares @ packed.swapaxes(1, 2)
        residual -= 2 * (fit.swapaxes(2, 3) @ inside)[:, :, 0]
        residual += energy
        np.maximum(residual, 0, out=residual)
        residual /= SCALE**2 * tolerance
        weights = 1 / (1 + residual)
    return SCALE * np.sqrt(np.einsum("nc,snc->sn", tolerance / (1 + FLOOR), np.log1p(residual)))


def _cut(images: Float[np.ndarray, "*n p"], blocks: Integer[np.ndarray, "C m"]) -> np.ndarray:
    """Return each block of the images, (C, *n, m), zeros where it has no pixel."""
    cut = np.moveaxis(images[..., blocks], -2, 0)
    return cut * (blocks >= 0).reshape(len(blocks), *[1] * (images.ndim - 1), -1)


def _packed_products(rows: Float[np.ndarray, "C N d m"]) -> Float[np.ndarray, "N C u"]:
    """Return the upper triangle of `Q_c Q_c^T` of every subject and block."""
    dimension = rows.shape[2]
    products = rows @ rows.swapaxes(2, 3)
    upper = np.triu_indices(dimension)
    return np.ascontiguousarray(products[..., upper[0], upper[1]].swapaxes(0, 1))


class RobustDistance(SubspaceDistance):
    """The `robust_distances`.

    The method of choice where probes are framed exactly as the gallery, as renderings of meshes
    are; for photographs cropped by hand see `LocalDistance`.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    dimension
        Greatest dimension of each subject's subspace.
    first
        Flat index of the first harmonic image.
    """

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1].

        Parameters
        ----------
        model
            From `fit`.
        probes
            Linear photographs in the gallery's unit, (n, rows, columns).
        mask
            Pixels that are compared: those of the gallery.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), in [0, 1], in float32.
        """
        return robust_distances(probes[:, mask], model["bases"], pixel_blocks(mask))
