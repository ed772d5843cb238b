"""Chunked stores of images of many people, which need not fit in memory: folders that Zarr reads.

A store holds one float32 array, `images`, cut along its first axis into chunks that each carry
their checksum, and the name of each entry. It is written chunk by chunk, by any number of
processes, and sealed in the end: the seal is a digest of all that is not in the chunks, and of
their checksums. A store without a seal is half written; the next run goes on with it.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, read_bytes
from harmface.io.folders import make_folder

if TYPE_CHECKING:
    import zarr

SUFFIX = ".zarr"
GALLERY, PROBES = "gallery", "probes"
KINDS = (GALLERY, PROBES)
VERSION = 1
ARRAYS = ("images", "names", "mask")
SEAL = "seal"

CHUNK_BYTES = 2**24
"""Bytes of a chunk: 16 MiB, in which a flipped byte is found, and which is written at once."""

FEWEST_CHUNKS = 64
"""A smaller store has smaller chunks, so that several processes can write it."""

MAX_CHUNK_BYTES = 2**28
"""Largest chunk read into memory."""

_CHECKSUM = 4
"""Bytes of the checksum at the end of a chunk."""


@dataclass(frozen=True, eq=False)
class Store:
    """Images of many people in a folder, read in parts.

    Parameters
    ----------
    path
        The folder.
    kind
        "gallery" or "probes".
    names
        Of a gallery, subjects in sorted order; of probes, their files.
    mask
        Pixels that the last axis of the images has.
    shape
        Shape of the images: of a gallery (subjects, dimension, pixels), of probes (probes, pixels).
    chunk
        Entries of a chunk.
    facts
        How it was made: anything JSON can hold.
    """

    path: Path
    kind: str
    names: Sequence[str]
    mask: Bool[np.ndarray, "H W"]
    shape: tuple[int, ...]
    chunk: int
    facts: Mapping[str, Any]

    def read(self, start: int, stop: int) -> Float[np.ndarray, "n *item"]:
        """Return some of the images.

        Parameters
        ----------
        start, stop
            Numbers of the first, and of the first that is not read.

        Returns
        -------
        numpy.ndarray
            As `shape` says, float32.

        Raises
        ------
        FileError
            If a chunk is missing or damaged.
        """
        return read_images(self.path, start, stop)

    @property
    def starts(self) -> range:
        """First entry of each chunk."""
        return range(0, self.shape[0], self.chunk)

    @cached_property
    def seal(self) -> str:
        """Digest of all that the store holds.

        Raises
        ------
        FileError
            If a chunk is missing.
        """
        head = [self.kind, VERSION, list(self.names), self.mask.tolist(), self.shape, self.chunk]
        found = sha256(json.dumps([*head, dict(self.facts)], sort_keys=True).encode())
        for start in self.starts:
            try:
                with _chunk_file(self, start).open("rb") as file:
                    file.seek(-_CHECKSUM, 2)
                    found.update(file.read())
            except OSError:
                raise FileError(
                    f"{self.path}: lacks the images from number {start}; make it again"
                ) from None
        return found.hexdigest()


def create_store(
    path: Path,
    kind: str,
    names: Sequence[str],
    mask: Bool[np.ndarray, "H W"],
    item: tuple[int, ...],
    facts: Mapping[str, Any],
) -> Store:
    """Make a store without images, or take up the same one that was left half written or whole.

    Parameters
    ----------
    path
        The folder to make.
    kind
        "gallery" or "probes".
    names
        Of every entry.
    mask
        Pixels that the last axis of the images has.
    item
        Shape of one entry.
    facts
        How it is made, and all that its images depend on: anything JSON can hold.

    Returns
    -------
    Store
        Of which the images are still to be written.

    Raises
    ------
    FileError
        If the folder holds anything else, or cannot be made.
    """
    zarr = _zarr()

    if kind not in KINDS or not names:
        raise ArgumentError(f"a store must be one of {', '.join(KINDS)}, with at least one entry")
    size = 4 * math.prod(item)
    chunk = max(1, min(CHUNK_BYTES // size, -(-len(names) // FEWEST_CHUNKS)))
    shape = (len(names), *item)
    store = Store(path, kind, names, mask, shape, chunk, json.loads(json.dumps(dict(facts))))
    made = make_folder(path)
    if "zarr.json" in made and _head(_opened(path, kind)) == _head(store):
        return store
    if not set(made) <= set(ARRAYS) or not all(_hardly_begun(path / name) for name in made):
        raise FileError(f"{path}: holds something else; give a new folder, or what it was made of")
    encoded = np.char.encode(np.array(names, dtype=str), "utf-8")
    text = encoded.view(np.uint8).reshape(len(names), -1)
    checksums = {"compressors": [zarr.codecs.Crc32cCodec()], "overwrite": True}
    with _naming(path):
        zarr.create_array(
            path / "images",
            shape=shape,
            chunks=(chunk, *item),
            dtype="float32",
            fill_value=np.nan,
            **checksums,
        )
        zarr.create_array(path / "names", data=text, chunks=text.shape, **checksums)
        zarr.create_array(path / "mask", data=mask, chunks=mask.shape, **checksums)
        # The group comes last, and tells that all of the rest is there.
        attributes = {"kind": kind, "version": VERSION, "facts": dict(store.facts)}
        zarr.create_group(path, attributes=attributes)
    return store


def missing_chunks(store: Store) -> list[int]:
    """Return the first entry of every chunk that is still to be written."""
    return [start for start in store.starts if not _chunk_file(store, start).exists()]


def write_images(path: Path, start: int, images: Float[np.ndarray, "n *item"]) -> None:
    """Write whole chunks of a store, from an entry on; each is whole or not there.

    Raises
    ------
    FileError
        If they cannot be written.
    """
    zarr = _zarr()
    with _naming(path):
        array = zarr.open_array(path / "images", mode="r+")
        array[start : start + len(images)] = images.astype(np.float32)


def seal_store(store: Store) -> None:
    """Say that a store is whole."""
    for path in store.path.rglob("*.partial"):
        path.unlink(missing_ok=True)  # of a process that was killed
    with atomic_write(store.path / SEAL) as file:
        file.write(store.seal.encode() + b"\n")


def open_store(path: Path | str, kind: str) -> Store:
    """Return a whole store, of which no image is read yet.

    Parameters
    ----------
    path
        A folder of `harmface enroll` or `harmface pack`.
    kind
        What it must hold, "gallery" or "probes".

    Returns
    -------
    Store
        As it was sealed.

    Raises
    ------
    FileError
        If it is missing, of another kind, half written, or changed since it was written.
    """
    path = Path(path)
    if not path.is_dir():
        raise FileError(f"{path}: is no store; give a folder of `harmface enroll` or `pack`")
    store = _opened(path, kind)
    if not (path / SEAL).exists():
        raise FileError(
            f"{path}: is half written; give the command that makes it again, which finishes it"
        )
    if read_bytes(path / SEAL, MAX_TEXT) != store.seal.encode() + b"\n":
        raise FileError(f"{path}: is damaged (its seal does not match); make it again")
    return store


def read_images(path: Path, start: int, stop: int) -> Float[np.ndarray, "n *item"]:
    """Return some images of a store without reading anything else of it.

    Raises
    ------
    FileError
        If a chunk is missing or damaged.
    """
    zarr = _zarr()
    try:
        images = zarr.open_array(path / "images", mode="r")[start:stop]
    except PARSE_ERRORS as error:
        raise FileError(
            f"{path}: is damaged among its images {start} to {stop - 1} ({excerpt(error)}); make "
            "it again"
        ) from None
    return np.asarray(images)


def _zarr() -> ModuleType:
    """Return Zarr, which reads and writes all of it.

    Raises
    ------
    ArgumentError
        If it is not installed.
    """
    try:
        import zarr
    except ModuleNotFoundError:
        raise ArgumentError(
            "Zarr, which stores need, is not installed; pip install 'harmface[dask]'"
        ) from None
    return zarr


def _opened(path: Path, kind: str) -> Store:
    """Return a store, whole or not."""
    zarr = _zarr()
    try:
        group = zarr.open_group(path, mode="r")
        attributes: dict[str, Any] = dict(group.attrs)
        if (attributes["kind"], attributes["version"]) != (kind, VERSION):
            raise ValueError(
                f"it holds {attributes['kind']} version {attributes['version']}, but {kind} "
                f"version {VERSION} is needed"
            )
        images, text, mask = (_array(group, name) for name in ARRAYS)
        if images.dtype != np.float32 or text.dtype != np.uint8 or mask.dtype != bool:
            raise TypeError("its arrays are of other types")
        width = text.shape[1]
        names = np.asarray(text[:]).reshape(-1).view(f"S{width}")
        if len(names) != images.shape[0] or images.shape[-1] != np.count_nonzero(mask[:]):
            raise ValueError("its arrays do not belong together")
        return Store(
            path,
            kind,
            np.char.decode(names, "utf-8").tolist(),
            np.asarray(mask[:]),
            tuple(map(int, images.shape)),
            int(images.chunks[0]),
            dict(attributes["facts"]),
        )
    except KeyError as error:
        raise FileError(f"{path}: is no store of ours: it has no {error}") from None
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no store of use ({excerpt(error)})") from None


def _array(group: "zarr.Group", name: str) -> "zarr.Array":
    """Return an array of a store whose chunks are not too large to be read."""
    zarr = _zarr()
    array = group[name]
    if not isinstance(array, zarr.Array):
        raise TypeError(f"its {name} are no array")
    if math.prod(array.chunks) * array.dtype.itemsize > MAX_CHUNK_BYTES:
        raise ValueError(f"a chunk of its {name} has more than {MAX_CHUNK_BYTES} bytes")
    if name == "images" and array.chunks[1:] != array.shape[1:]:
        raise ValueError("its images are cut")
    return array


def _hardly_begun(path: Path) -> bool:
    """Return whether a folder is an array of a store that was killed while it was made."""
    inside = list(path.iterdir()) if path.is_dir() else [path]
    return all(each.name in ("zarr.json", "c") or each.suffix == ".partial" for each in inside)


def _head(store: Store) -> tuple[Any, ...]:
    facts = json.dumps(dict(store.facts), sort_keys=True)
    mask = store.mask.tolist()
    return store.kind, list(store.names), mask, store.shape, store.chunk, facts


def _chunk_file(store: Store, start: int) -> Path:
    places = [str(start // store.chunk), *["0"] * (len(store.shape) - 1)]
    return store.path / "images" / "c" / Path(*places)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Turn an error of the system into one that names the store."""
    try:
        yield
    except OSError as error:
        raise FileError(
            f"{path}: cannot be written: {error.strerror or error}; the same command goes on from "
            "there"
        ) from None
