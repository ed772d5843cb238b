"""A first pass of recognition in fewer dimensions, after which few subjects are left to compare.

The dimensions are the principal directions of all subspaces of a gallery together: of all spaces of
as many dimensions theirs keeps most of the subspaces, in the sum of squares. In it subjects are
compared as in the space of the pixels, by the distance to their subspace, which costs less by the
ratio of the two dimensions.
"""

from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float
from threadpoolctl import threadpool_limits

from harmface.io.npz import read_npz, write_npz
from harmface.io.stores import (
    GALLERY,
    Store,
    create_store,
    missing_chunks,
    read_images,
    seal_store,
    write_images,
)
from harmface.recognition import orthonormal_basis
from harmface.scale.engines import Engine, InProcess

DIMENSION = 256
"""Of the first pass. Fewer miss more, and no longer cost much less than reading the gallery."""

SAMPLE = 2000
"""Subjects that the directions are found from, more than there are directions."""

STORE, DIRECTIONS = "first_pass.zarr", "directions.npz"
"""What is kept in the folder of the gallery."""


def reduced(gallery: Store, engine: Engine | None = None) -> Store:
    """Return a gallery in fewer dimensions, made once and kept with the gallery.

    Parameters
    ----------
    gallery
        A whole store.
    engine
        Where to work; in this process by default.

    Returns
    -------
    Store
        Of the same subjects.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    dimension = min(DIMENSION, gallery.shape[2])
    store = create_store(
        *(gallery.path / STORE, GALLERY, gallery.names, np.ones((1, dimension), bool)),
        *((gallery.shape[1], dimension), {"gallery": gallery.seal}),
    )
    missing = missing_chunks(store)
    if missing:
        file = store.path / DIRECTIONS
        if not file.exists():
            # What stands in the file is what all parts are made with, whoever found it.
            write_npz(file, "directions", 1, {"directions": _principal(gallery, dimension)})
        spans = [(start, min(start + store.chunk, store.shape[0])) for start in missing]
        make = partial(_reduce, gallery.path.absolute(), store.path.absolute())
        for _ in (engine or InProcess()).each(make, spans):
            pass
    seal_store(store)
    return store


def directions_of(store: Path) -> Float[np.ndarray, "k p"]:
    """Return the orthonormal directions of a reduced gallery, as rows of pixels."""
    return read_npz(store / DIRECTIONS, "directions", 1)[0]["directions"]


def _principal(gallery: Store, dimension: int) -> Float[np.ndarray, "k p"]:
    """Return the directions that keep most of the subspaces of a sample of chunks."""
    starts = gallery.starts
    step = max(1, len(starts) * gallery.chunk // SAMPLE)
    moments = np.zeros((gallery.shape[2],) * 2)
    with threadpool_limits(1):
        for start in starts[::step]:
            rows = gallery.read(start, start + gallery.chunk).reshape(-1, gallery.shape[2])
            moments += rows.T @ rows
        return np.linalg.eigh(moments)[1][:, : -dimension - 1 : -1].T.astype(np.float32)


def _reduce(gallery: Path, store: Path, span: tuple[int, int]) -> None:
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        images = read_images(gallery, *span) @ directions_of(store).T
        write_images(store, span[0], orthonormal_basis(images, images.shape[1]))
