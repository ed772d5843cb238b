"""`harmface enroll` and `harmface recognize`."""

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from harmface import checks
from harmface.cli.common import (
    JsonOption,
    SizeOption,
    SrgbColorsOption,
    load_mesh,
    output,
    progress,
)
from harmface.errors import ArgumentError, FileError


def enroll(
    meshes: Annotated[
        list[Path], typer.Argument(metavar="MESHES_OR_DIR...", help="Mesh files, or folders.")
    ],
    out: Annotated[Path, typer.Option(help="Gallery file (.npz) to write.")],
    size: SizeOption = 64,
    cast_shadows: Annotated[
        bool,
        typer.Option(help="Cast rays for the shadows of a head on itself: slower and better."),
    ] = False,
    srgb_colors: SrgbColorsOption = False,
) -> None:
    """Enroll subjects from meshes: nine harmonic images each.

    A subject's name is its file's name without the ending. Every mesh is seen from the front
    (along -z), orthographically, centred by its bounding box, its height filling 1/1.05 of the
    picture; images to be recognised must be framed alike, as `harmface render` does.

    Example: harmface enroll faces --size 64 --out gallery.npz
    """
    from harmface.io import write_gallery
    from harmface.recognition.gallery import Gallery, subject_images

    checks.positive_integer("--size", size)
    files = _mesh_files(meshes)
    images = []
    with progress("enrolling") as report:
        for number, path in enumerate(files.values()):
            try:
                mesh = load_mesh(path, None, srgb_colors)
                images.append(subject_images(mesh, size, 2, cast_shadows))
            except ArgumentError as error:
                raise FileError(f"{path}: {error}") from None
            report((number + 1) / len(files))
    write_gallery(out, Gallery(tuple(files), np.stack(images)))
    output.print(f"{len(files)} subjects at {size} x {size} pixels in {out}")


def recognize(
    gallery: Annotated[Path, typer.Argument(help="Gallery file made by `harmface enroll`.")],
    images: Annotated[list[Path], typer.Argument(metavar="IMAGES...", help="Photographs.")],
    method: Annotated[str, typer.Option(help="Subspace: 9d, 4d or 3d.")] = "9d",
    top: Annotated[int, typer.Option(help="How many subjects to list for each image.")] = 5,
    srgb: Annotated[
        bool, typer.Option("--srgb", help="The images are sRGB-encoded: make them linear.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Rank the subjects of a gallery by the distance of each image to their subspace.

    Images must be linear (or --srgb given), framed as the gallery is, and of its size. Colour is
    turned to luminance. Distances are relative to the image's norm: 0 is a perfect fit.

    Example: harmface recognize gallery.npz probe.png --top 5
    """
    from harmface.io import read_gallery
    from harmface.recognition import HarmonicSubspaceClassifier

    checks.positive_integer("--top", top)
    subjects = read_gallery(gallery)
    probes = np.stack([_probe(path, subjects.mask, srgb) for path in images])
    classifier = HarmonicSubspaceClassifier.from_gallery(subjects, method)
    distances = classifier.distances(probes)
    order = distances.argsort(axis=1)[:, :top]
    rankings = [
        [{"subject": str(classifier.classes_[i]), "distance": float(row[i])} for i in best]
        for row, best in zip(distances, order, strict=True)
    ]
    if as_json:
        results = [
            {"image": str(path), "ranking": ranking}
            for path, ranking in zip(images, rankings, strict=True)
        ]
        typer.echo(json.dumps({"results": results}, indent=1))
        return
    for path, ranking in zip(images, rankings, strict=True):
        table = Table("rank", "subject", "distance", title=str(path))
        for rank, entry in enumerate(ranking, 1):
            table.add_row(str(rank), str(entry["subject"]), f"{entry['distance']:.4f}")
        output.print(table)


def _mesh_files(given: list[Path]) -> dict[str, Path]:
    """Return the mesh files given, and those in the folders given, by subject."""
    from harmface.io.meshes import MESH_SUFFIXES

    files: list[Path] = []
    for path in given:
        if path.is_dir():
            inside = sorted(p for p in path.iterdir() if p.suffix.lower() in MESH_SUFFIXES)
            if not inside:
                raise FileError(f"{path}: holds no mesh; give {', '.join(MESH_SUFFIXES)} files")
            files += inside
        else:
            files.append(path)
    named: dict[str, Path] = {}
    for path in files:
        if path.stem in named:
            raise FileError(f"{path}: is the second mesh of subject {path.stem!r}; rename one")
        named[path.stem] = path
    return named


def _probe(path: Path, mask: np.ndarray, srgb: bool) -> np.ndarray:
    """Return the pixels of an image that the gallery compares, in luminance."""
    from harmface.conventions import luminance
    from harmface.io import read_image

    image = read_image(path, srgb=srgb)
    if image.shape[:2] != mask.shape:
        raise FileError(
            f"{path}: has {image.shape[0]} x {image.shape[1]} pixels, the gallery has "
            f"{mask.shape[0]} x {mask.shape[1]}; resize it, or enroll with its --size"
        )
    pixels = (luminance(image) if image.ndim == 3 else image)[mask]
    if not pixels.any():
        raise FileError(f"{path}: is all black where faces are; give a photograph with light in it")
    return pixels
