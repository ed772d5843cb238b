"""`harmface evaluate`: recognisers on a set of photographs."""

import json
import time
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from harmface.cli.common import JsonOption, errors, output
from harmface.errors import ArgumentError, FileError

BEST = "local"


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
            help="Comma-separated: best (= local), subspace, correlation, nearest, eigenfaces, "
            "eigenfaces-3, fisherfaces, gradient-direction, lbph; with equalized+, "
            "self-quotient+ or tan-triggs+ before one."
        ),
    ] = "best",
    size: Annotated[
        str | None, typer.Option(metavar="HxW", help="Resize to rows x columns, such as 48x42.")
    ] = None,
    srgb: Annotated[
        bool, typer.Option("--srgb", help="The photographs are sRGB-encoded: make them linear.")
    ] = False,
    skip_bad: Annotated[
        bool, typer.Option("--skip-bad", help="Go on without files that cannot be read.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Measure recognisers on photographs: who is named wrongly, by lighting subset.

    What is not in the gallery is a probe. Photographs must be cropped alike.

    Example: harmface evaluate CroppedYale --gallery subset1 --methods best,subspace --size 48x42
    """
    from harmface.io import choose_gallery, find_photographs, read_photographs
    from harmface.recognition.baselines import recognizer
    from harmface.recognition.evaluation import errors_by_subset

    shape = _size(size)
    unread: list[FileError] = []
    with errors.status("reading"):
        kept, images = read_photographs(
            find_photographs(folder),
            srgb=srgb,
            size=shape,
            bad=unread.append if skip_bad else None,
        )
    for error in unread:
        errors.print(f"skipped {error}", highlight=False, soft_wrap=True)
    enrolled = choose_gallery(kept, gallery)
    flat = images.reshape(len(images), -1)
    names = np.array([photograph.subject for photograph in kept])
    subsets = np.array([photograph.subset for photograph in kept])
    each = int(np.unique(names[enrolled], return_counts=True)[1].min())
    probes, truth_names = flat[~enrolled], names[~enrolled]
    results: dict[str, dict[str, object]] = {}
    for name in methods.split(","):
        method = recognizer(BEST if name == "best" else name, images.shape[1:], each)
        method.fit(flat[enrolled], names[enrolled])
        start = time.perf_counter()
        # Normalisers stand before the last step, which alone knows distances.
        distances = method[-1].distances(
            method[:-1].transform(probes) if len(method) > 1 else probes
        )
        seconds = (time.perf_counter() - start) / len(probes)
        truth = np.searchsorted(method.classes_, truth_names)
        by_subset = errors_by_subset(distances, truth, subsets[~enrolled])
        results[name] = {
            "subsets": {
                str(number): {"errors": rate.errors, "probes": rate.probes}
                for number, rate in by_subset.items()
            },
            "errors": sum(rate.errors for rate in by_subset.values()),
            "probes": len(probes),
            "seconds_per_probe": seconds,
        }
    if as_json:
        record = {
            "gallery": gallery,
            "images_enrolled": int(enrolled.sum()),
            "skipped": len(unread),
            "methods": results,
        }
        typer.echo(json.dumps(record, indent=1))
        return
    numbers = [int(number) for number in np.unique(subsets[~enrolled])]
    table = Table("method", *(f"subset {n}" if n else "errors" for n in numbers), "ms / probe")
    for name, found in results.items():
        rates = found["subsets"]
        assert isinstance(rates, dict)
        cells = [
            f"{rates[str(n)]['errors'] / rates[str(n)]['probes']:.1%} of {rates[str(n)]['probes']}"
            for n in numbers
        ]
        table.add_row(name, *cells, f"{1000 * float(str(found['seconds_per_probe'])):.2f}")
    output.print(table)


def _size(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    rows, _, columns = text.partition("x")
    if not (rows.isdigit() and columns.isdigit() and int(rows) and int(columns)):
        raise ArgumentError(f"--size must be HxW, such as 48x42, got {text!r}")
    return int(rows), int(columns)
