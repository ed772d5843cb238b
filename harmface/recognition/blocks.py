"""The nearest subjects of a part of a gallery, and of parts together.

Both functions are pure: what they return does not depend on how a gallery or its probes were cut
into blocks, on the number of threads, or on the order in which parts are merged. Blocks may be
arrays of any library that follows the array API standard, on any device that has float64.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [HM19] Higham and Mary, A New Approach to Probabilistic Rounding Error Analysis, SISC 2019.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from array_api_compat import array_namespace, device
from jaxtyping import Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.subspace import captured

PRODUCTS = 2**25
"""Coordinates of probes in subspaces that are held at a time: 128 MiB."""

PAIRS = 2**18
"""Values of subspaces that are scored again at a time: 2 MiB, which a processor's cache holds."""

NOBODY = -1
"""Number that stands where a block has fewer subjects than are asked for."""


@dataclass(frozen=True, eq=False)
class Ranking:
    """The nearest subjects of every probe, the nearest first; of equals the lower number.

    Parameters
    ----------
    subjects
        Their numbers in the gallery; `NOBODY` where there are no more.
    distances
        In [0, 1], relative to the probe's norm; infinite where there are no more.
    """

    subjects: Integer[np.ndarray, "n top"]
    distances: Float[np.ndarray, "n top"]


def score_block(gallery: Any, probes: Any, top: int, first: int = 0) -> Ranking:
    """Return the subjects of a block of a gallery that are nearest to each probe.

    The squared distance of a probe `x` of norm 1 to a subspace with orthonormal rows `Q` is
    `|x|^2 - |Q x|^2` ([BJ03]_), for all pairs by one product in float32. Where it is small its
    digits cancel: it is off by up to `sqrt(d p) eps`, the statistical bound of `d` products of `p`
    terms ([HM19]_). So whatever may be among the nearest within that error is scored again as
    `|x - Q^T Q x|` in float64, pair by pair in one order of sums, and only that decides.

    Parameters
    ----------
    gallery
        Orthonormal rows of each subject, (N, d, p), see `orthonormal_basis`.
    probes
        Images as rows of the same pixels, (n, p), of the same library and device; none all black.
    top
        How many subjects to return of each probe.
    first
        Number of the block's first subject in the whole gallery.

    Returns
    -------
    Ranking
        In numpy arrays, whatever the library.

    Raises
    ------
    ArgumentError
        On NaN or infinity, an all-black probe, or blocks of other shapes.

    Examples
    --------
    >>> gallery = np.eye(4)[:, None]  # four subjects of one pixel each
    >>> found = score_block(gallery, np.array([[0.0, 3, 4, 0]]), top=2)
    >>> found.subjects, found.distances
    (array([[2, 1]]), array([[0.6, 0.8]]))
    """
    top = checks.positive_integer("top", top)
    probes = _unit_probes(gallery, probes)
    xp = array_namespace(gallery)
    subjects, dimension, pixels = gallery.shape
    single = xp.astype(probes, xp.float32)
    step = max(1, PRODUCTS // max(1, len_of(probes) * dimension))
    left = xp.concat(
        [
            1 - captured(single, xp.astype(gallery[some, ...], xp.float32, copy=False))
            for some in _slices(subjects, step)
        ],
        axis=1,
    )
    if not xp.all(xp.isfinite(left)):
        raise ArgumentError("gallery must be finite, got NaN or Inf; make it again")
    slack = math.sqrt(dimension * pixels) * float(np.finfo(np.float32).eps)
    last = min(top, subjects) - 1
    within = xp.sort(left, axis=1)[:, last : last + 1] + 2 * slack
    probe, subject = xp.nonzero(left <= within)
    return _scored(gallery, probes, probe, subject, top, first)


def score_pairs(
    gallery: Any, probes: Any, pairs: Integer[np.ndarray, "2 m"], top: int, first: int = 0
) -> Ranking:
    """Return the nearest of some subjects of a block, such as a first pass has left.

    Parameters
    ----------
    gallery, probes
        As of `score_block`.
    pairs
        Numbers of a probe, and of a subject in the whole gallery that it is compared with.
    top
        How many subjects to return of each probe.
    first
        Number of the block's first subject.

    Returns
    -------
    Ranking
        As of `score_block`.

    Raises
    ------
    ArgumentError
        As `score_block`, or if a subject is not of the block.
    """
    probes = _unit_probes(gallery, probes)
    subjects = pairs[1] - first
    if subjects.size and not (subjects.min() >= 0 and subjects.max() < len_of(gallery)):
        raise ArgumentError(f"pairs must be of subjects from {first} on that the gallery holds")
    xp = array_namespace(gallery)
    probe, subject = (xp.asarray(each, device=device(gallery)) for each in (pairs[0], subjects))
    return _scored(gallery, probes, probe, subject, top, first)


def merge_top(one: Ranking, other: Ranking) -> Ranking:
    """Return the nearest of two rankings of the same probes; grouping and order do not matter.

    Parameters
    ----------
    one, other
        Of the same probes, of as many subjects each.

    Returns
    -------
    Ranking
        Of as many subjects.

    Raises
    ------
    ArgumentError
        If they are not of as many probes and subjects.
    """
    if one.subjects.shape != other.subjects.shape:
        raise ArgumentError(
            "rankings must be of the same probes and length, got shapes "
            f"{one.subjects.shape} and {other.subjects.shape}"
        )
    subjects = np.concatenate([one.subjects, other.subjects], axis=1)
    distances = np.concatenate([one.distances, other.distances], axis=1)
    order = np.lexsort((subjects, distances))[:, : one.subjects.shape[1]]
    return Ranking(
        np.take_along_axis(subjects, order, axis=1), np.take_along_axis(distances, order, axis=1)
    )


def len_of(array: Any) -> int:
    """Return the length of the first axis: the standard has no `len`."""
    return int(array.shape[0])


def _unit_probes(gallery: Any, probes: Any) -> Any:
    """Return probes in float64 and of norm 1, if they fit the gallery."""
    if gallery.ndim != 3 or probes.ndim != 2 or gallery.shape[2] != probes.shape[1]:
        raise ArgumentError(
            "gallery must have shape (N, d, p) and probes (n, p), got "
            f"{tuple(gallery.shape)} and {tuple(probes.shape)}"
        )
    if not all(gallery.shape):
        raise ArgumentError(f"gallery must hold subjects, got shape {tuple(gallery.shape)}")
    xp = array_namespace(gallery, probes)
    probes = xp.astype(probes, xp.float64)
    norms = xp.sqrt(xp.sum(probes * probes, axis=1, keepdims=True))
    if not xp.all(xp.isfinite(norms)):
        raise ArgumentError("probes must be finite, got NaN or Inf")
    if not xp.all(norms > 0):
        raise ArgumentError("probes must not be all black")
    return probes / norms


def _scored(gallery: Any, probes: Any, probe: Any, subject: Any, top: int, first: int) -> Ranking:
    """Return the nearest of pairs of a probe and a subject, by their distances in float64."""
    xp = array_namespace(gallery)
    found = [np.empty(0)]
    for some in _slices(len_of(probe), max(1, PAIRS // math.prod(gallery.shape[1:]))):
        images = xp.take(probes, probe[some], axis=0)
        bases = xp.astype(xp.take(gallery, subject[some], axis=0), xp.float64)
        # Sums along the last axis, and not products of matrices, which threads cut differently.
        inside = xp.sum(bases * images[:, None, :], axis=2)
        rest = images - xp.sum(bases * inside[:, :, None], axis=1)
        found.append(_on_host(xp.sqrt(xp.sum(rest * rest, axis=1))))
    distances = np.concatenate(found)
    rows, subjects = _on_host(probe), _on_host(subject) + first
    order = np.lexsort((subjects, distances, rows))
    rows, subjects, distances = rows[order], subjects[order], distances[order]
    rank = np.arange(len(rows)) - np.searchsorted(rows, rows)
    kept = rank < top
    place = rows[kept], rank[kept]
    shape = (len_of(probes), top)
    ranking = Ranking(np.full(shape, NOBODY, dtype=np.int64), np.full(shape, np.inf))
    ranking.subjects[place] = subjects[kept]
    ranking.distances[place] = distances[kept]
    return ranking


def _on_host(array: Any) -> np.ndarray:
    return np.from_dlpack(array, device="cpu")


def _slices(count: int, step: int) -> Iterator[slice]:
    for start in range(0, count, step):
        yield slice(start, min(start + step, count))
