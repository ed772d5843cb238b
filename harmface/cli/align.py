"""`harmface align`: photographs of faces brought into one frame."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from harmface.cli.common import (
    JsonOption,
    MaxPixelsOption,
    SrgbOption,
    errors,
    output,
    pixel_limit,
    progress,
    read_apart,
    rows_and_columns,
)
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.enrollment.eyes import EyeFinder

POINTS, DETECTOR, SITTING = "points", "detector", "sitting"
"""What told where a face is."""


@dataclass
class Face:
    """A photograph, and where its face is.

    Parameters
    ----------
    path, target
        To read, and to write.
    eyes
        The left one in the picture first, if known.
    told_by
        One of the three above.
    matrix
        Map from the frame to the photograph, once it is known.
    """

    path: Path
    target: Path
    eyes: np.ndarray | None = None
    told_by: str = SITTING
    matrix: np.ndarray | None = None


def align(
    photographs: Annotated[
        Path, typer.Argument(help="Folder of photographs; a folder in it is one person's sitting.")
    ],
    out: Annotated[Path, typer.Option(help="Folder to make: PNG files, folders as they were.")],
    points: Annotated[
        Path | None,
        typer.Option(
            metavar="CSV",
            help="Eyes by hand: file,x,y,x,y in pixels from the top left corner, the eye on the "
            "left in the picture first.",
        ),
    ] = None,
    detector: Annotated[
        Path | None,
        typer.Option(
            metavar="ONNX",
            help="YuNet network for OpenCV's FaceDetectorYN; by default dlib, of the extra "
            "harmface[align].",
        ),
    ] = None,
    size: Annotated[
        str, typer.Option(metavar="HxW", help="Rows and columns of the pictures made.")
    ] = "192x168",
    srgb: SrgbOption = False,
    max_pixels: MaxPixelsOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find faces, and bring them into one frame: photographs are turned, scaled, moved and cut.

    The eyes come to lie at 20 and 80 % of the width and 27 % of the height, as in the crops of
    Extended Yale B; nothing is stretched, and edges are repeated where a photograph ends. Pictures
    are averaged in linear light, and encoded as their photographs were. Photographs in one folder
    below PHOTOGRAPHS are of one person in one sitting: they are registered to the best-lit of them,
    from which also those are placed in which no face is found. Photographs directly in PHOTOGRAPHS
    are each of their own. Eyes in --points are taken as they are.

    Example: harmface align uncropped --out aligned

    Example: harmface align uncropped --points eyes.csv --size 96x84 --out aligned
    """
    from harmface.enrollment.alignment import in_frame
    from harmface.io import output_folder, prepare_folder, write_image

    shape = rows_and_columns(size)
    assert shape is not None
    faces = _faces(photographs, out)
    top = sorted({face.target.relative_to(out).parts[0] for face in faces})
    if out.exists():
        prepare_folder(out, top)
    if points is not None:
        _read_points(points, photographs, faces)
    finder = None
    if any(face.eyes is None for face in faces):
        finder = _finder(detector)
    limit = pixel_limit(max_pixels)
    sittings: dict[Path, list[Face]] = {}
    for face in faces:
        alone = face.path.parent == photographs
        sittings.setdefault(face.path if alone else face.path.parent, []).append(face)
    with progress("finding faces") as report:
        for number, sitting in enumerate(sittings.values()):
            _place(sitting, finder, shape, srgb, limit)
            report((number + 1) / len(sittings))
    with output_folder(out, top), progress("writing") as report:
        for number, face in enumerate(faces):
            face.target.parent.mkdir(parents=True, exist_ok=True)
            values, encoding = _read(face.path, srgb, limit)
            assert face.matrix is not None
            write_image(face.target, in_frame(values, face.matrix, shape), **encoding)
            report((number + 1) / len(faces))
    if as_json:
        placed = [
            {"file": str(face.path), "told_by": face.told_by, "frame": face.matrix.tolist()}
            for face in faces
            if face.matrix is not None
        ]
        typer.echo(json.dumps({"rows_and_columns": list(shape), "photographs": placed}, indent=1))
        return
    blind = [face for face in faces if face.told_by == SITTING]
    for face in blind:
        errors.print(
            f"note: {face.path}: no face was found in it; it was placed as the best-lit of its "
            "folder",
            highlight=False,
            soft_wrap=True,
        )
    output.print(f"{len(faces)} photographs of {size} pixels in {out}", soft_wrap=True)


def _faces(folder: Path, out: Path) -> list[Face]:
    """Return the photographs of a folder, without the places of their faces."""
    from harmface.io.photo_folders import PHOTOGRAPH_SUFFIXES, files_below

    if not folder.is_dir():
        raise FileError(f"{folder}: is not a folder; give one of photographs")
    if out.resolve() == folder.resolve() or not read_apart(out.resolve(), [folder.resolve()]):
        raise FileError(f"{out}: lies in {folder}, which is read; give a folder elsewhere")
    paths = [path for path in files_below(folder) if path.suffix.lower() in PHOTOGRAPH_SUFFIXES]
    if not paths:
        raise FileError(f"{folder}: holds no photographs; give PNG, TIFF, PGM or JPEG files")
    faces: list[Face] = []
    named: dict[Path, Path] = {}
    for path in paths:
        target = out / path.relative_to(folder).with_suffix(".png")
        if target in named:
            raise FileError(
                f"{path}: would be written to the same file as {named[target]}; rename one"
            )
        named[target] = path
        faces.append(Face(path, target))
    return faces


def _read_points(table: Path, folder: Path, faces: list[Face]) -> None:
    """Enter the eyes that a table tells."""
    from harmface.io.tables import read_table

    found = read_table(table)
    if found.rows is None or found.numbers.shape[1] != 4:
        raise FileError(f"{table}: must hold file,x,y,x,y in each line: the two eyes of a file")
    by_name = {face.path.relative_to(folder).as_posix(): face for face in faces}
    for name, numbers in zip(found.rows, found.numbers, strict=True):
        matches = [by_name[name]] if name in by_name else _named(by_name, name)
        if len(matches) != 1:
            what = "no photograph" if not matches else f"{len(matches)} photographs"
            raise FileError(f"{table}: {name} names {what} in {folder}; give the path below it")
        if matches[0].eyes is not None:
            raise FileError(f"{table}: {name} is named twice; leave one of its lines out")
        matches[0].eyes, matches[0].told_by = numbers.reshape(2, 2), POINTS


def _named(by_name: dict[str, Face], name: str) -> list[Face]:
    return [face for path, face in by_name.items() if path.endswith("/" + name)]


def _finder(detector: Path | None) -> "EyeFinder":
    from harmface.enrollment import eyes

    return eyes.dlib_eyes() if detector is None else eyes.yunet_eyes(detector)


def _place(
    sitting: list[Face],
    finder: "EyeFinder | None",
    shape: tuple[int, int],
    srgb: bool,
    limit: int,
) -> None:
    """Find where the faces of one sitting are."""
    from harmface.conventions import luminance
    from harmface.enrollment.alignment import place_sitting

    images = []
    for face in sitting:
        values, _ = _read(face.path, srgb, limit)
        images.append(luminance(values) if values.ndim == 3 else values)
        rows, columns = values.shape[:2]
        if face.eyes is not None and not (
            (face.eyes >= 0).all() and (face.eyes <= [columns, rows]).all()
        ):
            raise FileError(
                f"{face.path}: has {rows} x {columns} pixels, but an eye outside: "
                f"{', '.join(f'{each:g}' for each in face.eyes.ravel())}; correct --points"
            )
        if face.eyes is None and finder is not None:
            face.eyes = finder(images[-1])
            face.told_by = SITTING if face.eyes is None else DETECTOR
    try:
        found = place_sitting(
            images,
            [face.eyes for face in sitting],
            shape,
            [face.told_by == POINTS for face in sitting],
        )
    except ArgumentError as error:
        raise FileError(f"{sitting[0].path.parent}: {error}") from None
    for face, matrix in zip(sitting, found, strict=True):
        if matrix is None:
            raise FileError(
                f"{face.path}: shows no face that can be found; give its eyes by --points, or "
                "leave it out"
            )
        face.matrix = matrix


def _read(path: Path, srgb: bool, limit: int) -> tuple[np.ndarray, dict[str, Any]]:
    """Return the linear values of a photograph, and how to encode them as they were."""
    from harmface.enrollment.alignment import LARGEST
    from harmface.io.pictures import read_picture

    picture = read_picture(path, limit)
    values = picture.linear(unstated=srgb)
    if max(values.shape[:2]) > LARGEST:
        raise FileError(f"{path}: has more than {LARGEST} rows or columns; make it smaller")
    if values.min() < 0 or values.max() > 1:
        raise FileError(f"{path}: holds values outside 0 to 1; scale it")
    encoded = srgb if picture.srgb is None else picture.srgb
    return values, {"bits": 8 if picture.bits == 8 else 16, "srgb": encoded}
