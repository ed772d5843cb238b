"""`harmface enroll` and `harmface recognize`."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.table import Table

from harmface import checks
from harmface.cli.common import (
    JsonOption,
    LearnFromOption,
    MaxPixelsOption,
    MethodOption,
    SchedulerOption,
    SessionsOption,
    SkipBadOption,
    SrgbOption,
    WorkersOption,
    claim_outputs,
    claim_store,
    errors,
    fitted,
    holds_photographs,
    mesh_files,
    output,
    pixel_limit,
    progress,
    read_enrolled,
    read_others,
    read_probes,
    rows_and_columns,
    rows_of_square,
    tell_skipped,
    working,
)
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from harmface.recognition import Gallery, SubjectClassifier
    from harmface.recognition.registration import Motion

MOST_PICTURED = 40
"""Most probes in one figure."""


@with_options("mesh_reading", MeshReading)
def enroll(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="MESHES_OR_DIR...",
            help="Meshes, folders of them, or a folder of photographs: Yale B, or one a subject.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Gallery to write: .npz, or a store .zarr.")],
    method: MethodOption = "best",
    learn_from: LearnFromOption = None,
    size: Annotated[
        str | None,
        typer.Option(help="N rows and columns for meshes (64); HxW to resize photographs to."),
    ] = None,
    gallery: Annotated[
        str | None,
        typer.Option(
            help="Photographs to enroll: ninepoints, subset1, first:N of each, or a file of names; "
            "all by default."
        ),
    ] = None,
    srgb: SrgbOption = False,
    sessions: SessionsOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Enroll subjects from meshes, as harmonic images, or from photographs.

    A mesh's file name without the ending is its subject's name. Every mesh is seen from the front
    (along -z), orthographically, centred by its bounding box, its height filling 1/1.05 of the
    picture; images to be recognised must be framed alike, as `harmface render` does. A method of
    photographs, such as local, is given nine pictures of each mesh, under the nine points of light.

    Photographs must be cropped alike; those to be recognised are treated as they are (--srgb,
    --size). Of fewer than seven a person, what light does to faces is learned from other people:
    from procedural heads, rendered once and kept, or from --learn-from. Of more whose names tell
    the light, as of Extended Yale B, surfaces are recovered and shown under nine lights more.

    A gallery NAME.zarr, of subspaces, need not fit in memory.

    Example: harmface enroll faces --size 64 --out gallery.npz

    Example: harmface enroll Yale --gallery subset1 --size 48x42 --out people.npz

    Example: harmface enroll heads --method 9d --out big.zarr
    """
    from harmface.io import write_gallery
    from harmface.recognition import distance_named

    photographed = holds_photographs(sources)
    if photographed and mesh_reading != MeshReading():
        raise ArgumentError("options on how to read a mesh are for meshes, not photographs")
    if not photographed and (gallery is not None or srgb or sessions):
        raise ArgumentError("--gallery, --sessions and --srgb are for photographs, not meshes")
    if is_store(out):
        if learn_from is not None:
            raise ArgumentError("--learn-from is for gallery files (.npz), not for stores (.zarr)")
        _enroll_store(
            *(sources, out, method, size, gallery, srgb, sessions, max_pixels, skip_bad),
            *(workers, scheduler, mesh_reading),
        )
        return
    if workers is not None or scheduler is not None:
        raise ArgumentError("--workers and --scheduler are for galleries in stores (.zarr)")
    claim_outputs(out, inputs=[*sources, *filter(None, [mesh_reading.texture])])
    if method != "best":
        distance_named(method)  # names the methods there are before anything is read
    if photographed:
        enrolled = read_enrolled(
            *(sources[0], gallery, rows_and_columns(size), srgb, skip_bad),
            sessions=sessions,
            max_pixels=max_pixels,
        )
    else:
        enrolled = _from_meshes(sources, size, mesh_reading, skip_bad)
    others = read_others(learn_from, enrolled, srgb, max_pixels)
    classifier = fitted(enrolled, method, others)
    write_gallery(out, classifier)
    output.print(f"{enrolled.summary} in {out}, for {classifier.method}", soft_wrap=True)


def recognize(
    gallery: Annotated[Path, typer.Argument(help="Gallery made by `harmface enroll`.")],
    images: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGES...", help="Photographs; with a gallery in a store, a store of `pack`."
        ),
    ],
    method: Annotated[
        str | None,
        typer.Option(help="Another method than the gallery was enrolled for, see `enroll`."),
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
    first_pass: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Of stores: compare with the N subjects that are nearest in 256 dimensions only.",
        ),
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    as_json: JsonOption = False,
) -> None:
    """Rank the subjects of a gallery by how well each explains an image, whatever the light.

    Images must be linear (or --srgb given), and framed as the gallery is. Colour is turned to
    luminance. Distances are the method's own; for subspaces they are relative to the image's
    norm, 0 being a perfect fit. The margin is how much nearer the first subject is than the
    second: 0 is a tie. The probability takes the image for one of somebody enrolled; it and the
    threshold of --reject are estimated from photographs of the gallery (of a mesh: pictures under
    nine lights). An image that is farther from everybody than photographs that were held out is
    named in a note: it may show no face.

    Of stores (.zarr) neither the gallery nor the probes need fit in memory. There is no probability
    then, and the images are compared as they lie. With --first-pass 100 a large gallery takes a
    fraction of the time, and who is nearest may be missed.

    Example: harmface recognize gallery.npz probe.png --top 5

    Example: harmface recognize gallery.npz *.png --reject 0.01 --figure why.png

    Example: harmface recognize big.zarr probes.zarr --workers 2 --top 5 --json
    """
    from harmface.io import read_gallery
    from harmface.recognition import margins

    checks.positive_integer("--top", top)
    if is_store(gallery):
        if method is not None or reject is not None or figure is not None or srgb or skip_bad:
            raise ArgumentError(
                "of a store there are --top, --first-pass, --json, --workers and --scheduler only"
            )
        _recognize_stores(gallery, images, top, first_pass, as_json, workers, scheduler)
        return
    if workers is not None or scheduler is not None or first_pass is not None:
        raise ArgumentError(
            "--first-pass, --workers and --scheduler are for galleries in stores (.zarr)"
        )
    claim_outputs(figure, inputs=[gallery, *images])
    classifier = read_gallery(gallery)
    if method not in (None, classifier.method):
        classifier = fitted(classifier.gallery_, method)
    enrolled = classifier.gallery_
    paths, probes, skipped = read_probes(
        *(images, enrolled.mask, srgb or enrolled.facts.get("srgb") is True, skip_bad),
        like=_stored_size(enrolled),
        max_pixels=max_pixels,
    )
    if figure is not None and len(paths) > MOST_PICTURED:
        raise ArgumentError(
            f"--figure shows {MOST_PICTURED} images at most, got {len(paths)}; give fewer at a time"
        )
    with errors.status("comparing"):
        distances, motions = classifier.placed(probes.reshape(len(probes), -1))
        rejection, in_place = None, None
        if reject is not None:
            rejection = asdict(classifier.rejection(reject))
            in_place = margins(classifier.distances_in_place(probes.reshape(len(probes), -1)))
    names = [str(name) for name in classifier.classes_]
    margin = margins(distances) if len(names) > 1 else None
    chances = classifier.probabilities(distances) if classifier.calibrated else None
    results = []
    for row, path in enumerate(paths):
        nearest = distances[row].argsort(kind="stable")[:top]
        ranking = [
            {
                "subject": names[i],
                "distance": float(distances[row, i]),
                "probability": None if chances is None else float(chances[row, i]),
            }
            for i in nearest
        ]
        result: dict[str, Any] = {"image": str(path), "ranking": ranking, "margin": None}
        if margin is not None:
            result["margin"] = float(margin[row])
        if motions is not None:
            result["framing"] = asdict(motions[row])
            _tell_framing(path, motions[row], enrolled.mask.shape[0])
        farthest = classifier.farthest_held_out
        result["far_from_all"] = None
        if farthest is not None:
            result["far_from_all"] = bool(distances[row].min() > farthest)
            _tell_far(path, float(distances[row].min()), farthest)
        if rejection is not None and in_place is not None:
            result["margin_in_place"] = float(in_place[row])
            result["known"] = result["margin_in_place"] > rejection["least_margin"]
        results.append(result)
    if figure is not None:
        _draw(figure, classifier, paths, probes, distances)
    if as_json:
        record = {
            "method": classifier.method,
            "subjects": len(names),
            "rejection": rejection,
            "skipped": len(skipped),
            "results": results,
        }
        typer.echo(json.dumps(record, indent=1))
        return
    for result in results:
        _print_answer(result, rejection)


def pack(
    images: Annotated[
        list[Path], typer.Argument(metavar="IMAGES_OR_DIR...", help="Photographs, folders of them.")
    ],
    like: Annotated[Path, typer.Option(metavar="GALLERY", help="Store of the gallery (.zarr).")],
    out: Annotated[Path, typer.Option(help="Store of probes (.zarr) to make, or to finish.")],
    srgb: SrgbOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> None:
    """Put photographs into a store of probes, to be recognised by a gallery in a store.

    They are resized and cut as the gallery's were. Where a run was stopped the same command goes
    on.

    Example: harmface pack photographs --like big.zarr --workers 2 --out probes.zarr
    """
    from harmface.io import find_photographs, open_store
    from harmface.scale import Job, pack_probes

    if not is_store(out):
        raise ArgumentError(f"--out must end in .zarr, got {out}")
    claim_store(out, [like, *images])
    gallery = open_store(like, "gallery")
    files: list[Path] = []
    for path in images:
        found = find_photographs(path, unlabelled=True) if path.is_dir() else None
        files += [path] if found is None else [photograph.path for photograph in found]
    with working(workers, scheduler) as engine, progress("packing") as report:
        job = Job(engine, report, skip_bad)
        store, skipped = pack_probes(
            out, files, gallery, srgb, job, max_pixels=pixel_limit(max_pixels)
        )
    tell_skipped(skipped)
    output.print(f"{len(store.names)} probes in {out}", soft_wrap=True)


def is_store(path: Path) -> bool:
    """Return whether a name is that of a store."""
    return path.suffix == ".zarr"


def _enroll_store(
    sources: list[Path],
    out: Path,
    method: str,
    size: str | None,
    gallery: str | None,
    srgb: bool,
    sessions: bool,
    max_pixels: int | None,
    skip_bad: bool,
    workers: int | None,
    scheduler: str | None,
    mesh_reading: MeshReading,
) -> None:
    """Enroll subjects in a store."""
    from harmface.io import choose_gallery, find_photographs
    from harmface.scale import Job, enroll_meshes, enroll_photographs

    claim_store(out, sources)
    photographs = None
    if holds_photographs(sources):
        shape = rows_and_columns(size)
        photographs = find_photographs(sources[0], sessions=sessions)
        if gallery is not None:
            chosen = choose_gallery(photographs, gallery)
            photographs = [each for each, one in zip(photographs, chosen, strict=True) if one]
    with working(workers, scheduler) as engine, progress("enrolling") as report:
        job = Job(engine, report, skip_bad)
        if photographs is None:
            side = rows_of_square(size or "64")
            files = mesh_files(sources)
            store, skipped = enroll_meshes(out, files, mesh_reading.load, side, method, job)
        else:
            store, skipped = enroll_photographs(
                *(out, photographs, method, shape, srgb, job), max_pixels=pixel_limit(max_pixels)
            )
    tell_skipped(skipped)
    rows, columns = store.mask.shape
    output.print(
        f"{len(store.names)} subjects at {rows} x {columns} pixels in {out}, for "
        f"{store.facts['method']}",
        soft_wrap=True,
    )


def _recognize_stores(
    gallery: Path,
    images: list[Path],
    top: int,
    first_pass: int | None,
    as_json: bool,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Recognise a store of probes in a store of subjects; answers are printed as they come."""
    from harmface.io import open_store
    from harmface.scale import recognize as ranked

    if len(images) != 1 or not is_store(images[0]):
        raise ArgumentError(
            f"{gallery}: is a store, for which probes must be one too; see `harmface pack`"
        )
    subjects, probes = open_store(gallery, "gallery"), open_store(images[0], "probes")
    results: list[dict[str, Any]] = []
    with working(workers, scheduler) as engine, progress("comparing") as report:
        # The margin tells the first from the second.
        for found in ranked(subjects, probes, max(top, 2), engine, first_pass):
            for near, far in zip(found.subjects, found.distances, strict=True):
                results.append(_answer(probes.names[len(results)], subjects.names, near, far, top))
            report(len(results) / len(probes.names))
    if as_json:
        record = {
            "method": subjects.facts["method"],
            "subjects": len(subjects.names),
            "rejection": None,
            "skipped": 0,
            "results": results,
        }
        typer.echo(json.dumps(record, indent=1))
        return
    for result in results:
        _print_answer(result, None)


def _answer(
    image: str, names: "Sequence[str]", near: np.ndarray, far: np.ndarray, top: int
) -> dict[str, Any]:
    """Return what is printed of a probe of a store."""
    margin = float((far[1] - far[0]) / far[1]) if np.isfinite(far[1]) and far[1] > 0 else None
    ranking = [
        {"subject": names[subject], "distance": float(distance), "probability": None}
        for subject, distance in zip(near[:top], far[:top], strict=True)
        if subject >= 0
    ]
    return {"image": image, "ranking": ranking, "margin": margin}


def _stored_size(enrolled: "Gallery") -> tuple[int, int] | None:
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


def _from_meshes(
    sources: list[Path], size: str | None, mesh_reading: MeshReading, skip_bad: bool
) -> "Gallery":
    """Return the gallery of mesh files."""
    from harmface.recognition.meshes import gallery_of_meshes, subject_models

    side = rows_of_square(size or "64")
    files = mesh_files(sources)
    models, skipped = {}, []
    with progress("enrolling") as report:
        for number, (name, path) in enumerate(files.items()):
            try:
                models[name] = subject_models(mesh_reading.load(path), side)
            except (ArgumentError, FileError) as error:
                found = error if isinstance(error, FileError) else FileError(f"{path}: {error}")
                if not skip_bad:
                    raise found from None
                skipped.append(found)
            report((number + 1) / len(files))
    tell_skipped(skipped)
    if not models:
        raise FileError("no mesh could be read")
    facts = {
        "files": [str(files[name]) for name in sorted(models)],
        "skipped": [str(error) for error in skipped],
    }
    return gallery_of_meshes(models, facts)


def _tell_framing(path: Path, motion: "Motion", rows: int) -> None:
    from harmface.recognition.framed import misframed

    if misframed(motion, rows):
        errors.print(
            f"note: {path}: is framed otherwise than the gallery, {motion.right:+.1f} pixels to "
            f"the right, {motion.down:+.1f} down, turned by {motion.rotation:+.1f} degrees and "
            f"{motion.scale:.2f} times as large; it was moved",
            highlight=False,
            soft_wrap=True,
        )


def _tell_far(path: Path, distance: float, farthest: float) -> None:
    if distance > farthest:
        errors.print(
            f"note: {path}: is {distance:.3f} from the nearest subject, photographs that were held "
            f"out at most {farthest:.3f}: it shows no face framed as the gallery, or one in harder "
            "light; crop it as the gallery is, see `harmface align`",
            highlight=False,
            soft_wrap=True,
        )


def _draw(
    path: Path,
    classifier: "SubjectClassifier",
    paths: list[Path],
    probes: np.ndarray,
    distances: np.ndarray,
) -> None:
    from harmface.viz import Explanation, explanation_figure, write_figure

    nearest = distances.argsort(axis=1, kind="stable")[:, :2]
    found = [classifier.explained(probes, column) for column in nearest.T]
    light, names = found[0][1], classifier.classes_
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
    write_figure(path, explanation_figure(explanations, classifier.gallery_.mask))


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
            f"({rejection['false_accept_rate']:.2%} of strangers are expected to exceed "
            f"{rejection['least_margin']:.1%}, by {rejection['strangers']} images)"
        )
    if result["margin"] is not None:
        margin = result.get("margin_in_place", result["margin"])
        output.print(f"margin {margin:.1%}{verdict}", highlight=False, soft_wrap=True)
