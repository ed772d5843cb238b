"""How much the harmonics overlap on the normals that are seen: Gram matrices of images."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from harmface.conventions import harmonic_count
from harmface.sphere import real_harmonics

CHUNK = 10_000
"""Pixels treated at a time: few enough for the cache, and no power of two, since rows that far
apart would fall on the same places in it."""


def harmonic_gram(
    normals: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "p"],
    max_degree: int,
    kept: Int[np.ndarray, "k"] | None = None,
) -> Float[np.ndarray, "K K"]:
    """Return `Q = Y^T W Y`, the harmonics' inner products over weighted normals.

    One pass; the harmonics of all pixels are never held together. Products are summed in the
    precision of `normals` over a chunk of pixels and in float64 over the chunks.

    Parameters
    ----------
    normals
        Unit normals.
    weights
        Weight of each normal, not negative.
    max_degree
        Highest degree of the harmonics.
    kept
        Flat indices of the harmonics that matter, by default all; the others' products are
        left at 0, which saves their time.

    Returns
    -------
    numpy.ndarray
        Symmetric, shape (K, K), float64.
    """
    count = harmonic_count(max_degree)
    if kept is None:
        kept = np.arange(count)
    products = np.zeros((len(kept), len(kept)))
    roots = np.sqrt(weights).astype(normals.dtype, copy=False)
    for some in chunks(len(normals), CHUNK):
        weighted = real_harmonics(normals[some], max_degree)[kept]
        weighted *= roots[some]
        products += weighted @ weighted.T
    gram = np.zeros((count, count))
    gram[np.ix_(kept, kept)] = products
    return gram


def chunks(count: int, size: int) -> Iterator[slice]:
    """Yield slices of at most `size` that cover `count` items in order."""
    for first in range(0, count, size):
        yield slice(first, min(first + size, count))
