"""Stores filled by the items of a job: galleries from meshes or photographs, and probes."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Bool, Float
from threadpoolctl import threadpool_limits

from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh
from harmface.io.parts import digest
from harmface.io.photo_sets import Photograph, read_probe
from harmface.io.stores import (
    GALLERY,
    PROBES,
    Store,
    create_store,
    missing_chunks,
    seal_store,
    write_images,
)
from harmface.recognition import SubspaceDistance, distance_named, orthonormal_basis
from harmface.recognition.gallery import HARMONIC, PHOTOGRAPHS, RELIT
from harmface.recognition.meshes import SHADOWED_DEGREE, subject_images, subject_models
from harmface.scale.engines import Engine, InProcess

Progress = Callable[[float], None]
LoadMesh = Callable[[Path], Mesh]
LoadImage = Callable[[Path], Float[np.ndarray, "H W"]]
Key = TypeVar("Key")


def _untold(done: float) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Job:
    """How a job is done, whatever it does.

    Parameters
    ----------
    engine
        Where to work.
    progress
        Told the fraction done.
    skip_bad
        Whether to go on without files that cannot be used; otherwise the first one ends the job.
    """

    engine: Engine = field(default_factory=InProcess)
    progress: Progress = field(default_factory=lambda: _untold)
    skip_bad: bool = False

    def each(
        self,
        function: Callable[[Any], Any],
        items: Sequence[Any],
        share: tuple[float, float] = (0, 1),
    ) -> Iterator[Any]:
        """Return what every item gives, and tell the share of the whole job that is done.

        Parameters
        ----------
        function
            Pure, see `Engine`.
        items
            What it is given.
        share
            Shares of the job that are done before and after.

        Yields
        ------
        Any
            One result for each item, in their order.
        """
        for number, found in enumerate(self.engine.each(function, items), 1):
            yield found
            self.progress(share[0] + (share[1] - share[0]) * number / len(items))

    def usable(
        self, read: Callable[[Path], Any], files: Mapping[Key, Path], until: float
    ) -> tuple[dict[Key, Any], list[FileError]]:
        """Read files; return what those gave that can be used, and the errors of the others.

        Parameters
        ----------
        read
            Reads a file.
        files
            By anything.
        until
            Share of the job that is done then.

        Returns
        -------
        tuple
            What was read, by the same keys, and errors.

        Raises
        ------
        FileError
            If a file cannot be used and `skip_bad` is not set.
        """
        found, skipped = {}, []
        results = self.each(partial(_tried, read), list(files.values()), (0, until))
        for key, result in zip(files, results, strict=True):
            if not isinstance(result, FileError):
                found[key] = result
            elif self.skip_bad:
                skipped.append(result)
            else:
                raise result
        return found, skipped


HERE = Job()
"""In this process, telling nobody, until the first file that cannot be used."""


def enroll_meshes(
    path: Path, files: Mapping[str, Path], load: LoadMesh, size: int, method: str, job: Job = HERE
) -> tuple[Store, list[FileError]]:
    """Enroll subjects from mesh files in a store, or finish one that was stopped.

    The subspaces are those of `recognition.enroll` and the method. Every mesh is read twice: the
    pixels that all subjects share have to be known before the first is enrolled.

    Parameters
    ----------
    path
        Folder of the store.
    files
        Mesh file of each subject by name.
    load
        Reads one; it can be pickled.
    size
        Rows and columns of the images.
    method
        Name of a method that compares with a subspace of each subject; "best" is 25d.
    job
        How it is done.

    Returns
    -------
    tuple
        The store, and the errors of the meshes left out.

    Raises
    ------
    ArgumentError
        If the method compares with anything but a subspace, or no pixel shows all subjects.
    FileError
        If a mesh cannot be used, or the store cannot be written.
    """
    method = "25d" if method == "best" else method
    distance = _subspace_distance(method)
    files = {name: files[name].absolute() for name in sorted(files)}
    masks, skipped = job.usable(partial(_visible, load, size), files, 0.2)
    if not masks:
        raise FileError("no mesh could be read")
    mask = np.logical_and.reduce(list(masks.values()))
    if not mask.any():
        raise ArgumentError("subjects must share some pixels, but no pixel shows all of them")
    made = made_of(files.values(), size=size, method=method)
    item = distance.dimension, int(mask.sum())
    store = create_store(path, GALLERY, list(masks), mask, item, {"method": method, "made": made})
    make = partial(_mesh_basis, load, size, distance, mask)
    fill_store(store, make, [files[name] for name in masks], job, 0.2)
    return store, skipped


def enroll_photographs(
    path: Path,
    photographs: Sequence[Photograph],
    method: str,
    size: tuple[int, int] | None = None,
    srgb: bool = False,
    job: Job = HERE,
    **reading: Any,
) -> tuple[Store, list[FileError]]:
    """Enroll subjects from photographs in a store, or finish one that was stopped.

    The subspaces are those of `SubspaceDistance` of the same photographs. With `skip_bad` all are
    read twice.

    Parameters
    ----------
    path
        Folder of the store.
    photographs
        Of all subjects.
    method
        "subspace", which is "best", too.
    size
        Rows and columns to resize to.
    srgb
        Whether values are encoded in sRGB and should be made linear.
    job
        How it is done.
    **reading
        See `read_probe`.

    Returns
    -------
    tuple
        The store, and the errors of the photographs left out.

    Raises
    ------
    ArgumentError
        If the method compares with anything but a subspace of photographs.
    FileError
        If a photograph cannot be used, or the store cannot be written.
    """
    method = "subspace" if method == "best" else method
    distance = _subspace_distance(method)
    if distance.source != PHOTOGRAPHS:
        raise ArgumentError(f"method {method} must have meshes; use subspace for photographs")
    read, facts = _like_the_first(photographs, size, srgb, **reading)
    files = {number: each.path.absolute() for number, each in enumerate(photographs)}
    skipped: list[FileError] = []
    if job.skip_bad:
        found, skipped = job.usable(partial(_nothing, read), files, 0.5)
        files = {number: files[number] for number in found}
    own: dict[str, list[Path]] = {}
    for number, file in files.items():
        own.setdefault(photographs[number].subject, []).append(file)
    names = sorted(own)
    mask = read.keywords["mask"]
    dimension = min(distance.dimension, *map(len, own.values()))
    made = made_of(files.values(), size=size, srgb=srgb, method=method)
    facts = {"method": method, **facts, "skipped": list(map(str, skipped)), "made": made}
    store = create_store(path, GALLERY, names, mask, (dimension, mask.size), facts)
    make = partial(_photograph_basis, read, dimension)
    fill_store(store, make, [own[name] for name in names], job, 0.5 * job.skip_bad)
    return store, skipped


def pack_probes(
    path: Path,
    files: Sequence[Path],
    gallery: Store,
    srgb: bool = False,
    job: Job = HERE,
    **reading: Any,
) -> tuple[Store, list[FileError]]:
    """Put photographs into a store of probes for a gallery, or finish one that was stopped.

    Parameters
    ----------
    path
        Folder of the store.
    files
        Photographs; they are resized and cut as the gallery's were.
    gallery
        Whom they are to be compared with.
    srgb
        Whether values are encoded in sRGB and should be made linear; as the gallery's if not given.
    job
        How it is done; with `skip_bad` all are read twice.
    **reading
        See `read_probe`.

    Returns
    -------
    tuple
        The store, and the errors of the photographs left out.

    Raises
    ------
    FileError
        If a photograph cannot be used, or the store cannot be written.
    """
    facts = gallery.facts
    like = tuple(facts["rows_and_columns"]) if facts.get("resized") else None
    srgb = srgb or facts.get("srgb") is True
    read = partial(read_probe, mask=gallery.mask, like=like, srgb=srgb, **reading)
    kept = {str(each): each.absolute() for each in files}
    skipped: list[FileError] = []
    if job.skip_bad:
        found, skipped = job.usable(partial(_nothing, read), kept, 0.5)
        kept = {name: kept[name] for name in found}
    if not kept:
        raise FileError("no image is left to recognise")
    made = made_of(kept.values(), gallery=gallery.seal, srgb=srgb)
    item = (int(gallery.mask.sum()),)
    store = create_store(path, PROBES, list(kept), gallery.mask, item, {"made": made})
    fill_store(
        store, partial(_probe, read, gallery.mask), list(kept.values()), job, 0.5 * job.skip_bad
    )
    return store, skipped


def fill_store(
    store: Store,
    make: Callable[[Any], Float[np.ndarray, "*item"]],
    items: Sequence[Any],
    job: Job = HERE,
    done: float = 0.0,
) -> None:
    """Write the images that a store lacks, and seal it.

    Parameters
    ----------
    store
        From `create_store`.
    make
        Returns the image of an item; it can be pickled.
    items
        One for each image.
    job
        How it is done.
    done
        Share of the job that is done before.
    """
    spans = [(start, items[start : start + store.chunk]) for start in missing_chunks(store)]
    for _ in job.each(partial(_written, store.path.absolute(), make), spans, (done, 1)):
        pass
    seal_store(store)


def _written(path: Path, make: Callable[[Any], np.ndarray], span: tuple[int, Any]) -> None:
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        write_images(path, span[0], np.stack([make(item) for item in span[1]]))


def _tried(read: Callable[[Path], Any], path: Path) -> Any:
    try:
        return read(path)
    except FileError as error:
        return error


def _nothing(read: LoadImage, path: Path) -> None:
    read(path)


def _subspace_distance(method: str) -> SubspaceDistance:
    distance = distance_named(method)
    if not isinstance(distance, SubspaceDistance) or distance.source == RELIT:
        raise ArgumentError(
            "a store holds a subspace of each subject: method must be subspace, 3d, 4d, 9d, 16d or "
            f"25d, got {method!r}; write a gallery file (.npz) for others"
        )
    return distance


def made_of(files: Iterable[Path], **request: Any) -> str:
    """Return a digest of what a store is made of, and of the code that makes it."""
    found = []
    for path in files:
        try:
            status = path.stat()
        except OSError as error:
            raise FileError(f"{path}: cannot be read: {error.strerror}") from None
        found.append([str(path), status.st_size, status.st_mtime_ns])
    return digest({**request, "files": found})


def _visible(load: LoadMesh, size: int, path: Path) -> Bool[np.ndarray, "H W"]:
    """Return the pixels in which a mesh is seen."""
    mask = _of_mesh(load, path, lambda mesh: subject_images(mesh, size, 2))[0] > 0
    if not mask.any():
        raise FileError(f"{path}: is black; give it some albedo")
    return np.asarray(mask)


def _mesh_basis(
    load: LoadMesh, size: int, distance: SubspaceDistance, mask: np.ndarray, path: Path
) -> Float[np.ndarray, "d p"]:
    def images(mesh: Mesh) -> np.ndarray:
        if distance.source == PHOTOGRAPHS:
            return subject_models(mesh, size, cast_shadows=False)[2]
        degree, shadowed = (2, False) if distance.source == HARMONIC else (SHADOWED_DEGREE, True)
        return subject_images(mesh, size, degree, shadowed)[distance.harmonics]

    return orthonormal_basis(_of_mesh(load, path, images)[:, mask], distance.dimension)


def _of_mesh(load: LoadMesh, path: Path, function: Callable[[Mesh], np.ndarray]) -> np.ndarray:
    """Return what a function makes of a mesh file; its errors name the file."""
    try:
        return function(load(path))
    except ArgumentError as error:
        raise FileError(f"{path}: {error}") from None


def _like_the_first(
    photographs: Sequence[Photograph], size: tuple[int, int] | None, srgb: bool, **reading: Any
) -> tuple["partial[np.ndarray]", dict[str, Any]]:
    """Return how to read photographs as the first one that can be read, and what to say of it."""
    from harmface.io import read_image

    for photograph in photographs:
        try:
            stored = read_image(photograph.path, **reading).shape[:2]
        except FileError as error:
            broken = error
            continue
        mask = np.ones(size or stored, bool)
        like = None if size is None else stored
        facts = {"srgb": srgb, "resized": like is not None, "rows_and_columns": list(stored)}
        return partial(read_probe, mask=mask, like=like, srgb=srgb, **reading), facts
    raise broken


def _photograph_basis(
    read: LoadImage, dimension: int, files: Sequence[Path]
) -> Float[np.ndarray, "d p"]:
    images = np.stack([read(file).astype(np.float32).reshape(-1) for file in files])
    return orthonormal_basis(images, dimension)


def _probe(read: LoadImage, mask: np.ndarray, path: Path) -> Float[np.ndarray, "p"]:
    return read(path)[mask]
