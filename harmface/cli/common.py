"""What several commands share: tables, progress, option types, sets of photographs."""

import os
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from harmface import checks
from harmface.errors import ArgumentError, FileError, FileWarning

if TYPE_CHECKING:
    from harmface.io import Photograph
    from harmface.recognition import Gallery, Photographs, SubjectClassifier
    from harmface.scale import Engine

SizeOption = Annotated[int, typer.Option(help="Rows and columns of the picture.")]
MaxDegreeOption = Annotated[
    int, typer.Option("--max-degree", "--degree", help="Highest degree of the harmonics.")
]
DpiOption = Annotated[int | None, typer.Option(help="Dots per inch of the figure; 120 by default.")]
ResizeOption = Annotated[
    str | None, typer.Option(metavar="HxW", help="Resize to rows x columns, such as 48x42.")
]
SrgbOption = Annotated[
    bool,
    typer.Option(
        "--srgb",
        help="Photographs are sRGB-encoded where their files do not say so: make them linear.",
    ),
]
SkipBadOption = Annotated[
    bool, typer.Option("--skip-bad", help="Go on without files that cannot be used; name them.")
]
SessionsOption = Annotated[
    bool,
    typer.Option(
        "--sessions", help="Folders in a subject's folder are sessions, not subjects themselves."
    ),
]
MaxPixelsOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Largest picture read, in pixels; 67 million by default."),
]
MethodOption = Annotated[
    str,
    typer.Option(
        help="How to compare: best, whatever was enrolled; of photographs local, whitened, robust, "
        "registered, subspace, likelihood, cone, correlation, nearest, eigenfaces, eigenfaces-3, "
        "fisherfaces, gradient-direction, lbph, dlib (a network, of the extra harmface[peers]); of "
        "meshes also 3d, 4d, 9d, 16d, 25d, glossy (9d and highlights), "
        "non-negative-4d, non-negative-9d. Before one may stand framed+ (how probes are framed is "
        "searched for), what subjects are known by, relit+ "
        "(photographs and what their surfaces look like under other light), harmonic+ or "
        "shadowed+ (harmonic images of meshes, without and with cast shadows), and equalized+, "
        "self-quotient+ or tan-triggs+."
    ),
]
LearnFromOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Photographs of other people under several lights each, cropped alike, to learn from "
        "how light changes faces; procedural heads by default.",
    ),
]
WorkersOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Work in N processes, by Dask."),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Work on a Dask cluster."),
]
FIGURE_HELP = "The ending of its name says the format: .png, .svg or .pdf."
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON for programs.")]

# Names are shown as they are: brackets in them are no markup, nor are colons a picture.
output = Console(markup=False, emoji=False)
errors = Console(stderr=True, markup=False, emoji=False)

_claimed = ExitStack()


@contextmanager
def releasing_outputs() -> Iterator[None]:
    """Let go of all outputs, see `claim_outputs`, in the end."""
    with _claimed:
        yield


def claim_outputs(*outputs: Path | None, inputs: Iterable[Path] = ()) -> None:
    """Keep other processes from the files a command will write, until it ends.

    Raises
    ------
    FileError
        If one of them is an input, lies in a folder that is read and would be read with it, is
        another output, a folder, a device or a pipe, or if another process is writing it.
    """
    from harmface.io import claim
    from harmface.io.atomic import check_output
    from harmface.io.meshes import MESH_SUFFIXES
    from harmface.io.photo_folders import PHOTOGRAPH_SUFFIXES

    read = [Path(os.path.realpath(path)) for path in inputs]
    claimed: list[Path] = []
    for path in outputs:
        if path is None:
            continue
        target = check_output(path)
        among = target.suffix.lower() in (*MESH_SUFFIXES, *PHOTOGRAPH_SUFFIXES)
        if target in read or (among and not read_apart(target, read)):
            raise FileError(f"{path}: is read as well; give another name to write to")
        if target in claimed:
            raise FileError(f"{path}: is the name of two outputs; give each its own")
        claimed.append(target)
        _claimed.enter_context(claim(path))


def claim_store(out: Path, inputs: Iterable[Path]) -> None:
    """Keep other processes from a store that a command will write, until it ends.

    Raises
    ------
    FileError
        If it lies in a folder that is read, or another process is writing it.
    """
    from harmface.io import claim

    target = Path(os.path.realpath(out))
    read = [Path(os.path.realpath(path)) for path in inputs]
    if target in read or not read_apart(target, read):
        raise FileError(f"{out}: is read as well, or lies in what is; give another name")
    # The folder need not be there yet: its name is claimed, beside it.
    _claimed.enter_context(claim(out.with_name(f"{out.name}.store")))


@contextmanager
def working(workers: int | None, scheduler: str | None) -> Iterator["Engine"]:
    """Open where a command works, and say on stderr where that can be watched."""
    from harmface.scale import engine

    def tell(dashboard: str) -> None:
        errors.print(f"dashboard: {dashboard}", highlight=False, soft_wrap=True)

    with told(), engine(workers, scheduler, tell) as found:
        yield found


def read_apart(output: Path, inputs: Iterable[Path]) -> bool:
    """Return whether an output lies in none of the folders that are read; all as real paths."""
    return not any(folder in output.parents for folder in inputs)


def holds_photographs(sources: list[Path]) -> bool:
    """Return whether sources are one folder, with files in it of which none is a mesh."""
    from harmface.io.photo_folders import files_below

    return (
        len(sources) == 1
        and sources[0].is_dir()
        and not _meshes_in(sources[0])
        and next(files_below(sources[0]), None) is not None
    )


def mesh_files(given: list[Path]) -> dict[str, Path]:
    """Return the mesh files given, and those in the folders given, by subject."""
    files: list[Path] = []
    for path in given:
        if not path.exists():
            raise FileError(f"{path}: does not exist; check the name")
        inside = _meshes_in(path) if path.is_dir() else [path]
        if not inside:
            raise FileError(f"{path}: holds no mesh; give PLY, OBJ, GLB, glTF or STL files")
        files += inside
    named: dict[str, Path] = {}
    for path in files:
        if path.stem in named:
            raise FileError(f"{path}: is the second mesh of subject {path.stem!r}; rename one")
        named[path.stem] = path
    return named


def _meshes_in(folder: Path) -> list[Path]:
    from harmface.io.meshes import MESH_SUFFIXES

    return sorted(path for path in folder.iterdir() if path.suffix.lower() in MESH_SUFFIXES)


def rows_and_columns(text: str | None) -> tuple[int, int] | None:
    """Return what `--size HxW` says."""
    if text is None:
        return None
    rows, _, columns = text.partition("x")
    if not (rows.isdigit() and columns.isdigit() and int(rows) and int(columns)):
        raise ArgumentError(f"--size must be HxW, such as 48x42, got {text!r}")
    return int(rows), int(columns)


def rows_of_square(text: str) -> int:
    """Return what `--size N` says."""
    if not text.isdigit():
        raise ArgumentError(f"--size must be a whole number for meshes, got {text!r}")
    return checks.positive_integer("--size", int(text))


def read_subjects(
    folder: Path,
    size: tuple[int, int] | None,
    srgb: bool,
    skip_bad: bool,
    *,
    sessions: bool = False,
    unlabelled: bool = False,
    max_pixels: int | None = None,
) -> tuple[list["Photograph"], np.ndarray, list[FileError]]:
    """Return the photographs of a folder, their pixels, and the errors of those left out.

    Unless they may be `unlabelled` they must lie in a folder for each subject.
    """
    from harmface.io import find_photographs, read_photographs

    skipped: list[FileError] = []
    with told(), errors.status("reading"):
        kept, images = read_photographs(
            find_photographs(folder, sessions=sessions, unlabelled=unlabelled),
            srgb=srgb,
            size=size,
            max_pixels=pixel_limit(max_pixels),
            bad=skipped.append if skip_bad else None,
        )
    tell_skipped(skipped)
    return kept, images, skipped


def pixel_limit(max_pixels: int | None) -> int:
    """Return what `--max-pixels N` says."""
    from harmface.io import MAX_PIXELS

    return MAX_PIXELS if max_pixels is None else checks.positive_integer("--max-pixels", max_pixels)


def read_enrolled(
    folder: Path,
    gallery: str | None,
    shape: tuple[int, int] | None,
    srgb: bool,
    skip_bad: bool,
    *,
    sessions: bool = False,
    max_pixels: int | None = None,
) -> "Gallery":
    """Return the gallery of a folder's photographs that are to be enrolled."""
    from harmface.io import choose_gallery, read_image

    kept, images, skipped = read_subjects(
        folder, shape, srgb, skip_bad, sessions=sessions, max_pixels=max_pixels
    )
    chosen = np.ones(len(kept), bool) if gallery is None else choose_gallery(kept, gallery)
    facts = {
        "gallery": gallery or "all",
        "srgb": srgb,
        "resized": shape is not None,
        "skipped": [str(error) for error in skipped],
    }
    if shape is not None:
        with told():
            first = read_image(kept[0].path, max_pixels=pixel_limit(max_pixels))
        facts["rows_and_columns"] = list(first.shape[:2])
    return gallery_of_photographs(folder, kept, images, chosen, facts)


def gallery_of_photographs(
    folder: Path,
    kept: list["Photograph"],
    images: np.ndarray,
    chosen: np.ndarray,
    facts: dict[str, Any],
) -> "Gallery":
    """Return the gallery of those photographs of a folder that are chosen."""
    from harmface.recognition import Gallery, Photographs

    used = [photograph for photograph, wanted in zip(kept, chosen, strict=True) if wanted]
    lights = [photograph.light for photograph in used]
    files = [str(photograph.path.relative_to(folder)) for photograph in used]
    photographs = Photographs(np.array([each.subject for each in used]), images[chosen])
    return Gallery(
        photographs,
        photographs.everywhere,
        lights=None if None in lights else np.array(lights, dtype=np.float64),
        facts={"files": files, **facts},
    )


def fitted(
    gallery: "Gallery", method: str, learn_from: "Photographs | None" = None
) -> "SubjectClassifier":
    """Return the classifier of a gallery, with what the method needs beside it.

    Parameters
    ----------
    gallery
        What was read.
    method
        Its name.
    learn_from
        Photographs of other people; procedural ones if they are needed and none are given.
    """
    from harmface.enrollment import with_relit
    from harmface.recognition import SubjectClassifier, best_method, distance_named
    from harmface.recognition.gallery import RELIT
    from harmface.recognition.methods import BEST

    learns = gallery.harmonic is None if method == BEST else distance_named(method).learns
    if learns and gallery.others is None:
        gallery = with_others(gallery, learn_from)
    wanted = distance_named(best_method(gallery) if method == BEST else method)
    if wanted.source == RELIT and gallery.relit is None:
        with errors.status("recovering surfaces"):
            gallery = with_relit(gallery)
    with errors.status(method):
        return SubjectClassifier.from_gallery(gallery, method)


def with_others(gallery: "Gallery", learn_from: "Photographs | None") -> "Gallery":
    """Return the gallery with other people to learn from: procedural ones if none are given."""
    from harmface.recognition.framing import in_frame_of
    from harmface.reproduce.population import procedural_people

    if learn_from is None:
        with progress("rendering people to learn from, once") as report:
            learn_from = in_frame_of(gallery, procedural_people(report))
    return replace(gallery, others=learn_from)


def read_others(
    folder: Path | None, like: "Gallery", srgb: bool, max_pixels: int | None
) -> "Photographs | None":
    """Return photographs of other people, cropped and treated as a gallery's."""
    from harmface.recognition import Photographs

    if folder is None:
        return None
    shape = (like.mask.shape[0], like.mask.shape[1])
    kept, images, _ = read_subjects(folder, shape, srgb, False, max_pixels=max_pixels)
    return Photographs(np.array([photograph.subject for photograph in kept]), images)


def tell_skipped(skipped: list[FileError]) -> None:
    """Name on stderr every file that was left out, and count them."""
    for error in skipped:
        errors.print(f"skipped {error}", highlight=False, soft_wrap=True)
    if skipped:
        noun = "file" if len(skipped) == 1 else "files"
        errors.print(f"{len(skipped)} {noun} skipped", highlight=False)


def read_probes(
    paths: list[Path],
    mask: np.ndarray,
    srgb: bool,
    skip_bad: bool,
    *,
    like: tuple[int, int] | None,
    max_pixels: int | None = None,
) -> tuple[list[Path], np.ndarray, list[FileError]]:
    """Return the images that can be compared on a mask, and the errors of those left out.

    `like` says how many rows and columns the photographs of the gallery had before they were
    resized to the mask's, if they were: images are resized as they were.
    """
    from harmface.io.photo_sets import read_probe

    kept: list[Path] = []
    probes: list[np.ndarray] = []
    skipped: list[FileError] = []
    limit = pixel_limit(max_pixels)
    with told(), progress("reading") as report:
        for number, path in enumerate(paths):
            try:
                probes.append(read_probe(path, mask, like=like, srgb=srgb, max_pixels=limit))
                kept.append(path)
            except FileError as error:
                if not skip_bad:
                    raise
                skipped.append(error)
            report((number + 1) / len(paths))
    tell_skipped(skipped)
    if not kept:
        raise FileError("no image is left to recognise")
    return kept, np.stack(probes), skipped


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal's stderr; yields a function to be told the fraction done."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda done: bar.update(task, completed=done)


@contextmanager
def told() -> Iterator[Callable[[str], None]]:
    """Print what readers have to say of files as notes on stderr; yields how to add one."""

    def tell(text: str) -> None:
        errors.print(f"note: {text}", highlight=False, markup=False, soft_wrap=True)

    with warnings.catch_warnings():
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *rest: Any) -> None:
            if issubclass(category, FileWarning):
                tell(str(message))
            else:
                usual(message, category, *rest)

        warnings.simplefilter("always", FileWarning)
        warnings.showwarning = show  # type: ignore[assignment]
        yield tell
