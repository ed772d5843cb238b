"""Recognition of a store of probes in a store of subjects, neither of which fits in memory."""

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float, Integer
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.stores import Store, read_images
from harmface.recognition import Ranking, SubjectClassifier, merge_top, score_block, score_pairs
from harmface.scale.engines import Engine, InProcess
from harmface.scale.first_pass import directions_of, reduced

BLOCK_BYTES = 2**28
"""Bytes of the subjects that are compared at a time: 256 MiB, the most a worker holds but for
what `score_block` makes of them."""

PROBES = 1000
"""Probes that are compared at a time."""

LISTED = 5
"""How many times as many are compared with the few that a first pass leaves: it is reading then
that takes the time."""

IMAGES = 64
"""Images that a classifier compares at a time."""


@dataclass(frozen=True)
class _Block:
    """Some probes, and the subjects to compare them with."""

    probes: Path
    some: tuple[int, int]
    gallery: Path
    subjects: tuple[int, int]
    top: int
    pairs: Integer[np.ndarray, "2 m"] | None = None


def recognize(
    gallery: Store,
    probes: Store,
    top: int = 5,
    engine: Engine | None = None,
    first_pass: int | None = None,
) -> Iterator[Ranking]:
    """Return the nearest subjects of all probes, some hundred probes at a time, in their order.

    The result does not depend on the engine: see `score_block`.

    Parameters
    ----------
    gallery
        A store of `enroll_meshes` or `enroll_photographs`.
    probes
        A store of `pack_probes`, of the same mask.
    top
        How many subjects to return of each probe.
    engine
        Where to work; in this process by default.
    first_pass
        How many subjects a first pass in fewer dimensions leaves of each probe to be compared: at
        least `top`. Who is not among them is missed; see `first_pass`.

    Yields
    ------
    Ranking
        Of the next probes.

    Raises
    ------
    ArgumentError
        If the two are not of the same pixels.
    FileError
        If a chunk of either is damaged.
    """
    checks.positive_integer("top", top)
    if not np.array_equal(gallery.mask, probes.mask):
        raise ArgumentError(
            f"{probes.path}: is of other pixels than {gallery.path}; pack the probes for it"
        )
    engine = engine or InProcess()
    blocks = partial(_blocks, probes, gallery)
    if first_pass is None:
        yield from engine.merged(_score, (blocks(some, top) for some in _probes(probes)), merge_top)
        return
    if checks.positive_integer("first_pass", first_pass) < top:
        raise ArgumentError(f"first_pass must be at least top, {top}, got {first_pass}")
    small = reduced(gallery, engine)
    groups = (_blocks(probes, small, some, first_pass) for some in _probes(probes))
    left = engine.merged(_score_reduced, groups, merge_top)
    listed = ((some, _joined(islice(left, LISTED))) for some in _probes(probes, LISTED))
    groups = (
        [_listed(block, among) for block in blocks(some, first_pass)] for some, among in listed
    )
    for found in engine.merged(_score_pairs, groups, merge_top):
        yield Ranking(found.subjects[:, :top], found.distances[:, :top])


def _joined(rankings: Iterable[Ranking]) -> Integer[np.ndarray, "n top"]:
    return np.concatenate([each.subjects for each in rankings])


def _listed(block: _Block, among: Integer[np.ndarray, "n top"]) -> _Block:
    """Return a block with those pairs only of which the subject is in it."""
    start, stop = block.subjects
    rows, columns = np.nonzero((among >= start) & (among < stop))
    return replace(block, pairs=np.stack([rows, among[rows, columns]]))


def _probes(probes: Store, times: int = 1) -> list[tuple[int, int]]:
    return _spans(probes.shape[0], times * PROBES)


def _blocks(probes: Store, gallery: Store, some: tuple[int, int], top: int) -> list[_Block]:
    """Return what some probes are to be compared with, by whole chunks of the gallery."""
    size = 4 * math.prod(gallery.shape[1:])
    step = max(1, BLOCK_BYTES // size // gallery.chunk) * gallery.chunk
    paths = probes.path.absolute(), gallery.path.absolute()
    return [
        _Block(paths[0], some, paths[1], subjects, top)
        for subjects in _spans(gallery.shape[0], step)
    ]


def distances_on(
    engine: Engine, classifier: SubjectClassifier, images: Float[np.ndarray, "n p"]
) -> Float[np.ndarray, "n N"]:
    """Return the distance of every image to every subject of a classifier, by any method.

    Parameters
    ----------
    engine
        Where to work.
    classifier
        Fitted.
    images
        As rows of pixels.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), the same bytes on every engine.
    """
    some = [images[start:stop] for start, stop in _spans(len(images), IMAGES)]
    return np.concatenate(list(engine.each(partial(_distances, classifier), some)))


def _distances(
    classifier: SubjectClassifier, images: Float[np.ndarray, "n p"]
) -> Float[np.ndarray, "n N"]:
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        return classifier.distances(images)


def _score(block: _Block) -> Ranking:
    images = read_images(block.probes, *block.some)
    with _about(block):
        return score_block(_subjects(block), images, block.top, block.subjects[0])


def _score_reduced(block: _Block) -> Ranking:
    images = read_images(block.probes, *block.some) @ directions_of(block.gallery).T
    with _about(block):
        return score_block(_subjects(block), images, block.top, block.subjects[0])


def _score_pairs(block: _Block) -> Ranking:
    images = read_images(block.probes, *block.some)
    assert block.pairs is not None
    with _about(block):
        return score_pairs(_subjects(block), images, block.pairs, block.top, block.subjects[0])


def _subjects(block: _Block) -> Float[np.ndarray, "N d p"]:
    return read_images(block.gallery, *block.subjects)


@contextmanager
def _about(block: _Block) -> Iterator[None]:
    """Turn an error of what a store holds into one that names it."""
    try:
        yield
    except ArgumentError as error:
        raise FileError(f"{block.gallery}, {block.probes}: cannot be compared ({error})") from None


def _spans(count: int, step: int) -> list[tuple[int, int]]:
    return [(start, min(start + step, count)) for start in range(0, count, step)]
