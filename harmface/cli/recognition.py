"""`harmface enroll` and `harmface recognize`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.table import Table

from harmface import checks
from harmface.cli.common import (
    JsonOption,
    MaxPixelsOption,
    SessionsOption,
    SkipBadOption,
    SrgbOption,
    claim_outputs,
    errors,
    holds_photographs,
    mesh_files,
    output,
    progress,
    read_enrolled,
    read_probes,
    rows_and_columns,
    rows_of_square,
    tell_skipped,
)
from harmface.cli.matchers import DEGREES, Matcher, matcher_of
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.io.galleries import Enrolled

MOST_PICTURED = 40
"""Most probes in one figure."""


@with_options("mesh_reading", MeshReading)
def enroll(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="MESHES_OR_DIR...",
            help="Mesh files, folders of them, or one folder of photographs: Extended Yale B, or "
            "a folder for each subject.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Gallery file (.npz) to write.")],
    method: Annotated[
        str | None,
        typer.Option(
            help="What the gallery is for. Meshes: 9d (default), 3d, 4d, 16d (more than 9d with "
            "--cast-shadows only), 25d, non-negative-4d, non-negative-9d, or any method of "
            "photographs. Photographs: local (default) or any other method of `evaluate`."
        ),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(help="N rows and columns for meshes (64); HxW to resize photographs to."),
    ] = None,
    gallery: Annotated[
        str | None,
        typer.Option(
            help="Which photographs to enroll: ninepoints, subset1, first:N of each subject, or a "
            "text file of their names; all by default."
        ),
    ] = None,
    cast_shadows: Annotated[
        bool,
        typer.Option(help="Cast rays for the shadows of a head on itself: slower and better."),
    ] = False,
    from_stereo: Annotated[
        bool,
        typer.Option(
            "--from-stereo",
            help="Recover surfaces from the photographs, whose names must tell the light, and "
            "enroll what they look like under the nine points of light besides.",
        ),
    ] = False,
    srgb: SrgbOption = False,
    sessions: SessionsOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Enroll subjects from meshes, as harmonic images, or from photographs.

    A mesh's file name without the ending is its subject's name. Every mesh is seen from the front
    (along -z), orthographically, centred by its bounding box, its height filling 1/1.05 of the
    picture; images to be recognised must be framed alike, as `harmface render` does. A method of
    photographs, such as local, is given nine pictures of each mesh, under the nine points of light.

    Photographs must be cropped alike; those to be recognised are treated as they are (--srgb,
    --size).

    Example: harmface enroll faces --size 64 --out gallery.npz

    Example: harmface enroll CroppedYale --gallery subset1 --size 48x42 --from-stereo --out g.npz
    """
    from harmface.io import write_gallery

    claim_outputs(out, inputs=[*sources, *filter(None, [mesh_reading.texture])])
    if holds_photographs(sources):
        if cast_shadows or mesh_reading != MeshReading():
            raise ArgumentError(
                "--cast-shadows and options on how to read a mesh are for meshes, not photographs"
            )
        how = {"sessions": sessions, "max_pixels": max_pixels}
        enrolled = _from_photographs(
            *(sources[0], method, gallery, size, srgb, skip_bad, from_stereo), how
        )
    else:
        if gallery is not None or srgb or from_stereo or sessions:
            raise ArgumentError(
                "--gallery, --from-stereo, --sessions and --srgb are for photographs, not meshes"
            )
        enrolled = _from_meshes(sources, method, size, cast_shadows, mesh_reading, skip_bad)
    write_gallery(out, enrolled)
    output.print(f"{enrolled.summary} in {out}, for {enrolled.method}", soft_wrap=True)


def recognize(
    gallery: Annotated[Path, typer.Argument(help="Gallery file made by `harmface enroll`.")],
    images: Annotated[list[Path], typer.Argument(metavar="IMAGES...", help="Photographs.")],
    method: Annotated[
        str | None,
        typer.Option(
            help="How to compare; by default what the gallery was enrolled for. Harmonic images "
            "serve 3d, 4d, 9d, 16d, 25d, non-negative-4d, non-negative-9d; photographs serve "
            "local and every other method of `evaluate`."
        ),
    ] = None,
    top: Annotated[int, typer.Option(help="How many subjects to list for each image.")] = 5,
    reject: Annotated[
        float | None,
        typer.Option(
            metavar="RATE",
            help="Tell strangers, taking this share of them for somebody: such as 0.01.",
        ),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(help="PNG: each image, how the two nearest subjects explain it, the light."),
    ] = None,
    srgb: SrgbOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    as_json: JsonOption = False,
) -> None:
    """Rank the subjects of a gallery by how well each explains an image, whatever the light.

    Images must be linear (or --srgb given), and framed as the gallery is. Colour is turned to
    luminance. Distances are the method's own; for subspaces they are relative to the image's
    norm, 0 being a perfect fit. The margin is how much nearer the first subject is than the
    second: 0 is a tie. The probability takes the image for one of somebody enrolled; it and the
    threshold of --reject are estimated from photographs of the gallery (of a mesh: pictures under
    nine lights).

    Example: harmface recognize gallery.npz probe.png --top 5

    Example: harmface recognize gallery.npz *.png --reject 0.01 --figure why.png
    """
    from harmface.io import read_gallery
    from harmface.recognition import margins, posteriors
    from harmface.recognition.evaluation import independence

    checks.positive_integer("--top", top)
    claim_outputs(figure, inputs=[gallery, *images])
    enrolled = read_gallery(gallery)
    matcher = matcher_of(enrolled, method or enrolled.method, gallery)
    facts = enrolled.facts
    paths, probes, skipped = read_probes(
        *(images, enrolled.mask, srgb or facts.get("srgb") is True, skip_bad),
        like=_stored_size(enrolled),
        max_pixels=max_pixels,
    )
    if figure is not None and len(paths) > MOST_PICTURED:
        raise ArgumentError(
            f"--figure shows {MOST_PICTURED} images at most, got {len(paths)}; give fewer at a time"
        )
    with errors.status("comparing"):
        distances = matcher.distances(probes)
        rejection = None if reject is None else _rejection(matcher, reject, gallery)
        several = len(enrolled.names) > 1
        held_out = matcher.held_out if several else None
    margin = margins(distances) if several else None
    chances = None if held_out is None else posteriors(distances, independence(*held_out))
    results = []
    for row, path in enumerate(paths):
        nearest = distances[row].argsort(kind="stable")[:top]
        ranking = [
            {
                "subject": enrolled.names[i],
                "distance": float(distances[row, i]),
                "probability": None if chances is None else float(chances[row, i]),
            }
            for i in nearest
        ]
        result: dict[str, Any] = {"image": str(path), "ranking": ranking, "margin": None}
        if margin is not None:
            result["margin"] = float(margin[row])
        if rejection is not None:
            result["known"] = result["margin"] > rejection["least_margin"]
        results.append(result)
    if figure is not None:
        _draw(figure, matcher, paths, probes, distances)
    if as_json:
        record = {
            "method": matcher.method,
            "content": enrolled.content,
            "subjects": len(enrolled.names),
            "rejection": rejection,
            "skipped": len(skipped),
            "results": results,
        }
        typer.echo(json.dumps(record, indent=1))
        return
    for result in results:
        _print_answer(result, rejection)


def _stored_size(enrolled: "Enrolled") -> tuple[int, int] | None:
    """Return the rows and columns of a gallery's photographs before they were resized, if so."""
    if enrolled.facts.get("resized") is not True:
        return None
    found = enrolled.facts.get("rows_and_columns", enrolled.mask.shape)
    if not (
        isinstance(found, list | tuple)
        and len(found) == 2
        and all(isinstance(side, int) and side > 0 for side in found)
    ):
        raise FileError("the gallery's rows_and_columns are not two numbers; enroll again")
    return found[0], found[1]


def _from_photographs(
    folder: Path,
    method: str | None,
    gallery: str | None,
    size: str | None,
    srgb: bool,
    skip_bad: bool,
    from_stereo: bool,
    how: dict[str, Any],
) -> "Enrolled":
    from harmface.enrollment import with_nine_points
    from harmface.io.galleries import LabelledPhotographs, enrolled_photographs
    from harmface.io.photo_sets import yale_light
    from harmface.recognition.baselines import METHODS, recognizer

    shape = rows_and_columns(size)
    method = method or METHODS[0]
    if method in DEGREES:
        raise ArgumentError(
            f"--method {method} needs meshes, {folder} holds none; photographs serve "
            f"{', '.join(METHODS)}"
        )
    recognizer(method, (1, 1), 1)  # names the methods there are before anything is read
    photographs, facts = read_enrolled(folder, gallery, shape, srgb, skip_bad, **how)
    if from_stereo:
        lights = [yale_light(Path(name).name) for name in facts["files"]]
        taken = np.array(photographs.subjects)
        images, subjects = with_nine_points(photographs.images, taken, lights)
        photographs = LabelledPhotographs(tuple(subjects.tolist()), images)
    facts["from_stereo"] = from_stereo
    return enrolled_photographs(photographs, method, facts=facts)


def _from_meshes(
    sources: list[Path],
    method: str | None,
    size: str | None,
    cast_shadows: bool,
    mesh_reading: MeshReading,
    skip_bad: bool,
) -> "Enrolled":
    """Enroll harmonic images, or what photographs under the nine points of light would show."""
    from harmface.io.galleries import Enrolled, LabelledPhotographs, enrolled_photographs
    from harmface.light import DistantLight
    from harmface.recognition import Gallery, nine_points, subject_images, subject_photographs
    from harmface.recognition.baselines import recognizer

    method = method or "9d"
    if method not in DEGREES:
        try:
            recognizer(method, (1, 1), 1)
        except ArgumentError as error:
            raise ArgumentError(f"{error}; for meshes also {', '.join(DEGREES)}") from None
    side = rows_of_square(size or "64")
    light = DistantLight(nine_points(), np.eye(9))
    files = mesh_files(sources)
    names, images, photographs, skipped = [], [], [], []
    with progress("enrolling") as report:
        for number, (name, path) in enumerate(files.items()):
            try:
                mesh = mesh_reading.load(path)
                degree = max(2, DEGREES[method]) if method in DEGREES else 0
                harmonic = subject_images(mesh, side, degree, cast_shadows and degree > 0)
                nine = subject_photographs(mesh, light, side)
                if not nine.any(axis=(1, 2)).all():
                    raise ArgumentError("is black under some light; give it some albedo")
            except (ArgumentError, FileError) as error:
                found = error if isinstance(error, FileError) else FileError(f"{path}: {error}")
                if not skip_bad:
                    raise found from None
                skipped.append(found)
                continue
            names.append(name)
            images.append(harmonic)
            # An exposure for each, as a camera sets it.
            photographs.append(nine / nine.max(axis=(1, 2), keepdims=True))
            report((number + 1) / len(files))
    tell_skipped(skipped)
    if not names:
        raise FileError("no mesh could be read")
    gallery = Gallery(tuple(names), np.stack(images))
    facts = {
        "files": [str(files[name]) for name in names],
        "cast_shadows": cast_shadows,
        "skipped": [str(error) for error in skipped],
    }
    trials = LabelledPhotographs(tuple(np.repeat(names, 9).tolist()), np.concatenate(photographs))
    if method in DEGREES:
        return Enrolled(gallery, method, trials, gallery.mask, True, facts)
    return enrolled_photographs(trials, method, mask=gallery.mask, aligned=True, facts=facts)


def _rejection(matcher: Matcher, rate: float, path: Path) -> dict[str, float]:
    from harmface.recognition.evaluation import rejection_by_margin

    subjects, tried = len(matcher.enrolled.names), matcher.tried
    if tried is None or subjects < 3:
        raise ArgumentError(
            f"--reject needs three subjects and photographs of them to estimate from; {path} has "
            f"{subjects} and {'none' if tried is None else len(tried[0])}; enroll more"
        )
    found = rejection_by_margin(*tried, rate)
    return {
        "least_margin": 1 - found.threshold,
        "false_accept_rate": found.false_accept_rate,
        "strangers": found.strangers,
    }


def _draw(
    path: Path, matcher: Matcher, paths: list[Path], probes: np.ndarray, distances: np.ndarray
) -> None:
    from harmface.viz import Explanation, explanation_figure, write_figure

    nearest = distances.argsort(axis=1, kind="stable")[:, :2]
    found = [matcher.reconstructions(probes, column) for column in nearest.T]
    light, names = found[0][1], matcher.enrolled.names
    explanations = [
        Explanation(
            each.name,
            probes[row],
            [
                (f"{names[subject]} ({distances[row, subject]:.3f})", pictures[row])
                for subject, (pictures, _) in zip(nearest[row], found, strict=True)
            ],
            None if light is None else light[row],
        )
        for row, each in enumerate(paths)
    ]
    write_figure(path, explanation_figure(explanations, matcher.mask))


def _print_answer(result: dict[str, Any], rejection: dict[str, float] | None) -> None:
    table = Table("rank", "subject", "distance", "probability", title=result["image"])
    for rank, entry in enumerate(result["ranking"], 1):
        chance = entry["probability"]
        shown = "-" if chance is None else f"{chance:.1%}"
        table.add_row(str(rank), entry["subject"], f"{entry['distance']:.4f}", shown)
    output.print(table)
    verdict = ""
    if rejection is not None:
        verdict = (
            f": {'accepted' if result['known'] else 'rejected as a stranger'} "
            f"({rejection['false_accept_rate']:.2%} of {rejection['strangers']} strangers exceed "
            f"{rejection['least_margin']:.1%})"
        )
    if result["margin"] is not None:
        output.print(f"margin {result['margin']:.1%}{verdict}", highlight=False, soft_wrap=True)
