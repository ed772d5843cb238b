"""`harmface evaluate`: recognisers on a set of photographs."""

import csv
import io
import json
import os
import platform
import time
from contextlib import ExitStack
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.table import Table

from harmface.cli.common import (
    JsonOption,
    LearnFromOption,
    MaxPixelsOption,
    ResizeOption,
    SchedulerOption,
    SessionsOption,
    SkipBadOption,
    SrgbOption,
    WorkersOption,
    fitted,
    gallery_of_photographs,
    output,
    read_apart,
    read_others,
    read_subjects,
    rows_and_columns,
    working,
)
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.io.parts import Parts
    from harmface.recognition import Gallery, Photographs
    from harmface.scale import Engine

SEED = 0
"""Of the bootstrap."""

SECONDS = "seconds_per_probe"

RESULTS, TABLE, FIGURE, TIMES = "results.json", "table.csv", "figure.png", "times.json"
FILES = [RESULTS, TABLE, FIGURE, TIMES]
PACKAGES = ("harmface", "numpy", "scipy", "scikit-learn", "scikit-image")
COLUMNS = ("method", "subset", "errors", "probes", "rate", "rate_low", "rate_high")
CURVE = 101
"""Points of the verification curve, at false-accept rates from 1 in 10,000 to all."""


def evaluate(
    folder: Annotated[
        Path, typer.Argument(help="Extended Yale B, or a folder of photographs for each subject.")
    ],
    gallery: Annotated[
        str,
        typer.Option(
            help="Which photographs are enrolled: ninepoints, subset1, first:N of each subject, "
            "or a text file of their names."
        ),
    ] = "ninepoints",
    methods: Annotated[
        str,
        typer.Option(
            help="Comma-separated: best, or other methods of `harmface enroll`, such as "
            "relit+local, robust or tan-triggs+nearest."
        ),
    ] = "best",
    learn_from: LearnFromOption = None,
    size: ResizeOption = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"Folder to make: {RESULTS} (protocol, all numbers), {TABLE}, {FIGURE}, {TIMES}."
        ),
    ] = None,
    srgb: SrgbOption = False,
    sessions: SessionsOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    as_json: JsonOption = False,
) -> None:
    """Measure recognisers on photographs: who is named wrongly, by lighting subset.

    What is not in the gallery is a probe, the same for all methods. Photographs must be cropped
    alike. Intervals hold 95 % of 2000 bootstrap samples, in which chance draws the subjects; where
    no probe is misnamed they are Clopper and Pearson's, as if probes were independent. With --out,
    a run that was stopped goes on with the method it was at when the same command is given again.

    Methods are compared with the first, probe by probe: which of the two is wrong alone. p is that
    of McNemar's exact test, which takes probes for independent; those of one subject are not, which
    only the interval of the difference allows for.

    Example: harmface evaluate CroppedYale --gallery subset1 --methods best,subspace --size 48x42

    Example: harmface evaluate CroppedYale --methods best,subspace,lbph --out report
    """
    from harmface.io import choose_gallery, output_folder, prepare_folder
    from harmface.io.parts import Parts, digest
    from harmface.recognition import best_method, distance_named

    shape = rows_and_columns(size)
    asked = list(dict.fromkeys(methods.split(",")))
    for name in asked:
        if name != "best":
            distance_named(name)  # names the methods there are before anything is read
    if out is not None:
        if not read_apart(Path(os.path.realpath(out)), [folder.resolve()]):
            raise FileError(f"{out}: lies in {folder}, which is read; give a folder elsewhere")
        if out.exists():
            prepare_folder(out, FILES)
    kept, images, skipped = read_subjects(
        folder, shape, srgb, skip_bad, sessions=sessions, max_pixels=max_pixels
    )
    enrolled = choose_gallery(kept, gallery)
    if enrolled.all():
        raise ArgumentError(f"gallery {gallery} holds every photograph, and leaves no probe")
    names = np.array([photograph.subject for photograph in kept])
    subsets = np.array([photograph.subset for photograph in kept])[~enrolled]
    known = gallery_of_photographs(folder, kept, images, enrolled, {})
    others = read_others(learn_from, known, srgb, max_pixels)
    best = best_method(known, learning=True)
    settings = {name: best if name == "best" else name for name in asked}
    with ExitStack() as held:
        engine = held.enter_context(working(workers, scheduler))
        parts = None
        if out is not None:
            held.enter_context(output_folder(out, FILES))
            request = {"settings": settings, "seed": SEED}
            data = {"images": images, "names": names, "subsets": subsets, "enrolled": enrolled}
            data |= {} if known.lights is None else {"lights": known.lights}
            data |= {} if others is None else {"others": others.images}
            parts = Parts(out, digest(request, data))
        files = [str(each.path.relative_to(folder)) for each in kept]
        probes = [file for file, in_gallery in zip(files, enrolled, strict=True) if not in_gallery]
        results = _results(
            *(settings, parts, known, others, images[~enrolled], names[~enrolled], subsets),
            *(probes, engine),
        )
        differences = _differences(results, np.array(probes), names[~enrolled])
        record = {
            "gallery": gallery,
            "images_enrolled": int(enrolled.sum()),
            "skipped": len(skipped),
            "methods": {
                name: {key: value for key, value in found.items() if key != SECONDS}
                for name, found in results.items()
            },
            "differences": differences,
            "protocol": {
                "folder": str(folder),
                "subjects": len(np.unique(names)),
                "rows_and_columns": list(images.shape[1:]),
                "srgb": srgb,
                "settings": settings,
                "enrolled": known.facts["files"],
                "skipped": [str(error) for error in skipped],
                "bootstrap_seed": SEED,
                "python": platform.python_version(),
                "versions": {package: version(package) for package in PACKAGES},
            },
        }
        if out is not None and parts is not None:
            _write(out, record, results)
            parts.clear()
    if as_json:
        typer.echo(json.dumps({**record, "methods": results}, indent=1))
        return
    _print(results)
    if differences:
        _print_differences(differences)
    if out is not None:
        output.print(f"{', '.join(FILES)} in {out}")


def _results(
    settings: dict[str, str],
    parts: "Parts | None",
    gallery: "Gallery",
    others: "Photographs | None",
    probes: np.ndarray,
    names: np.ndarray,
    subsets: np.ndarray,
    files: list[str],
    engine: "Engine",
) -> dict[str, dict[str, Any]]:
    """Return the figures of every method; what a stopped run found is taken from its parts."""
    from harmface.scale import distances_on

    rows = probes.reshape(len(probes), -1)
    results: dict[str, dict[str, Any]] = {}
    for name, setting in settings.items():
        kept = None if parts is None else parts.load(setting)
        if kept is not None:
            results[name] = kept[1]
            continue
        classifier = fitted(gallery, setting, others)
        gallery = classifier.gallery_
        start = time.perf_counter()
        distances = distances_on(engine, classifier, rows)
        seconds = (time.perf_counter() - start) / len(rows)
        truth = np.searchsorted(classifier.classes_, names)
        chances = classifier.probabilities(distances) if classifier.calibrated else None
        named = classifier.classes_[distances.argmin(axis=1)]
        misnamed = {
            file: str(given)
            for file, given, own in zip(files, named, names, strict=True)
            if given != own
        }
        figures = _figures(distances, truth, subsets, chances)
        results[name] = {**figures, "misnamed": misnamed, SECONDS: seconds}
        if parts is not None:
            parts.save(setting, {}, results[name])
    return results


def _figures(
    distances: np.ndarray, truth: np.ndarray, subsets: np.ndarray, chances: np.ndarray | None
) -> dict[str, Any]:
    """Return how many probes were misnamed, and the curves."""
    from harmface.recognition import evaluation

    wrong = evaluation.misnamed(distances, truth)

    def interval(some: np.ndarray) -> list[float]:
        return list(evaluation.bootstrap_interval(wrong[some], truth[some], SEED))

    by_subset = evaluation.errors_by_subset(distances, truth, subsets)
    rates = np.geomspace(1e-4, 1, CURVE)
    curves = {
        name: np.interp(rates, *evaluation.receiver_operating(measured, truth)).tolist()
        for name, measured in (
            ("true_accepts", distances),
            ("true_accepts_relative", evaluation.relative_distances(distances)),
        )
    }
    return {
        "subsets": {
            str(number): {
                "errors": rate.errors,
                "probes": rate.probes,
                "interval": interval(subsets == number),
            }
            for number, rate in by_subset.items()
        },
        "errors": int(wrong.sum()),
        "probes": len(wrong),
        "interval": interval(np.ones_like(wrong)),
        "cumulative_match": evaluation.cumulative_match(distances, truth).tolist(),
        "roc": {"false_accepts": rates.tolist(), **curves},
        "reliability": None if chances is None else _reliability(chances, truth),
    }


def _differences(
    results: dict[str, dict[str, Any]], files: np.ndarray, names: np.ndarray
) -> list[dict[str, Any]]:
    """Return how the errors of every other method differ from those of the first."""
    from harmface.recognition.paired import difference

    wrong = {name: np.isin(files, list(found["misnamed"])) for name, found in results.items()}
    against, *others = wrong
    return [
        {
            "method": name,
            "against": against,
            **asdict(difference(wrong[name], wrong[against], names, SEED)),
        }
        for name in others
    ]


def _reliability(chances: np.ndarray, truth: np.ndarray) -> dict[str, Any]:
    from harmface.recognition.evaluation import reliability

    found = reliability(chances, truth)
    return {
        "claimed": found.claimed.tolist(),
        "right": found.right.tolist(),
        "count": found.count.tolist(),
        "expected_error": found.expected_error,
    }


def _rates(results: dict[str, dict[str, Any]]) -> list[list[Any]]:
    """Return a row for each method and subset: errors, and their rate with its interval."""
    return [
        [
            *(name, subset, rate["errors"], rate["probes"], rate["errors"] / rate["probes"]),
            *rate["interval"],
        ]
        for name, found in results.items()
        for subset, rate in _by_subset(found).items()
    ]


def _by_subset(found: dict[str, Any]) -> dict[str, Any]:
    """Return the rates of the subsets that are known, and of all probes."""
    known = {number: rate for number, rate in found["subsets"].items() if number != "0"}
    return {**known, "all": found}


def _print(results: dict[str, dict[str, Any]]) -> None:
    subsets = _by_subset(next(iter(results.values())))
    heads = [f"{subset}\nof {rate['probes']}" for subset, rate in subsets.items()]
    title = "errors by lighting subset, %, and their 95 % intervals"
    table = Table("method", *heads, "ms /\nprobe", title=title)
    for name, found in results.items():
        cells = [
            f"{_percent(rate['errors'] / rate['probes'])}\n"
            f"{'-'.join(_percent(end) for end in rate['interval'])}"
            for rate in _by_subset(found).values()
        ]
        table.add_row(name, *cells, f"{1000 * found[SECONDS]:.2f}")
    output.print(table)


def _print_differences(differences: list[dict[str, Any]]) -> None:
    title = f"errors on the same probes, against {differences[0]['against']}"
    table = Table("method", "wrong\nalone", "right\nalone", "difference, %", "p", title=title)
    for found in differences:
        rate, low, high = (100 * each for each in (found["rate"], *found["interval"]))
        table.add_row(
            found["method"],
            str(found["only_first"]),
            str(found["only_second"]),
            f"{rate:+.1f} ({low:+.1f} to {high:+.1f})",
            f"{found['p_value']:.2g}",
        )
    output.print(table)


def _percent(rate: float) -> str:
    return f"{100 * rate:.1f}" if rate < 0.1 else f"{100 * rate:.0f}"


def _write(folder: Path, record: dict[str, Any], results: dict[str, dict[str, Any]]) -> None:
    """Write the files; only the times differ when all is done again."""
    from harmface.io import atomic_write
    from harmface.viz import evaluation_figure, write_figure

    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([COLUMNS, *_rates(results)])
    times = {SECONDS: {name: found[SECONDS] for name, found in results.items()}}
    for name, content in (
        (TABLE, text.getvalue()),
        (TIMES, json.dumps(times, indent=1) + "\n"),
        (RESULTS, json.dumps(record, indent=1) + "\n"),
    ):
        with atomic_write(folder / name) as file:
            file.write(content.encode())
    write_figure(folder / FIGURE, evaluation_figure(results))
