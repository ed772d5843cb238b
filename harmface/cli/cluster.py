"""`harmface cluster`: unlabelled photographs sorted by subject."""

import json
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from harmface.cli.common import (
    JsonOption,
    LearnFromOption,
    MaxPixelsOption,
    ResizeOption,
    SessionsOption,
    SkipBadOption,
    SrgbOption,
    errors,
    gallery_of_photographs,
    output,
    read_others,
    read_subjects,
    rows_and_columns,
    with_others,
)
from harmface.errors import ArgumentError, FileError

BEST = "whitened"
CONIC = "conic"
SHOWN = 3
"""Files, or labels, that the table names of a group."""


def cluster(
    folder: Annotated[
        Path,
        typer.Argument(help="Photographs of several people, cropped alike, or a folder of each."),
    ],
    count: Annotated[
        int | None,
        typer.Option(metavar="N", help="How many people there are; by default it is estimated."),
    ] = None,
    method: Annotated[
        str,
        typer.Option(
            help=f"What makes two photographs alike: best ({BEST}), {CONIC} (non-negative mixtures "
            "of others), or a method of `harmface enroll` that one photograph a person is enough "
            "for, such as tan-triggs+correlation."
        ),
    ] = "best",
    learn_from: LearnFromOption = None,
    size: ResizeOption = None,
    srgb: SrgbOption = False,
    sessions: SessionsOption = False,
    max_pixels: MaxPixelsOption = None,
    skip_bad: SkipBadOption = False,
    as_json: JsonOption = False,
) -> None:
    """Sort photographs by the person they show, whatever the light, without any names.

    Where a folder, or a name of Extended Yale B, tells who it is, that is used for nothing but the
    purity of the groups: the share of photographs that show whom most of their group show.
    k-means of the pixels is told beside it. An estimated number of people wants ten photographs or
    more of each, and about as many of each.

    Example: harmface cluster photographs --count 10 --size 48x42
    """
    from sklearn.metrics import adjusted_rand_score

    from harmface.recognition import clustering, distance_named

    distance = None if method == CONIC else distance_named(BEST if method == "best" else method)
    kept, images, skipped = read_subjects(
        folder,
        rows_and_columns(size),
        srgb,
        skip_bad,
        sessions=sessions,
        unlabelled=True,
        max_pixels=max_pixels,
    )
    if len(images) < 3:
        raise FileError(f"{folder}: holds {len(images)} photographs; give at least 3 to sort")
    if count is not None and not 2 <= count < len(images):
        raise ArgumentError(
            f"--count must be at least 2 and fewer than the {len(images)} photographs, got {count}"
        )
    everyone = np.ones(len(kept), bool)
    gallery = gallery_of_photographs(folder, kept, images, everyone, {})
    rows = images.reshape(len(images), -1)
    neighbours = clustering.neighbours_of(len(images), count)
    if distance is None:
        with errors.status(method):
            affinity = clustering.conic_affinity(rows)
    else:
        if distance.learns:
            gallery = with_others(gallery, read_others(learn_from, gallery, srgb, max_pixels))
        with errors.status(method):
            distances = clustering.mutual_distances(gallery, distance)
            affinity = clustering.neighbour_affinity(distances, neighbours)
    people = count or clustering.likely_subjects(affinity, neighbours + 1)
    found = clustering.cluster_subjects(affinity, people)
    plain = clustering.kmeans_subjects(rows, people)
    labels = np.array([photograph.subject for photograph in kept])
    labelled = bool(labels.all()) and len(np.unique(labels)) > 1
    names = [str(photograph.path.relative_to(folder)) for photograph in kept]
    kmeans: dict[str, Any] = {"agreement": float(adjusted_rand_score(plain, found))}
    record: dict[str, Any] = {
        "method": BEST if method == "best" else method,
        "count": people,
        "count_estimated": count is None,
        "groups": _groups(found, names, labels if labelled else None),
        "kmeans": kmeans,
        "skipped": [str(error) for error in skipped],
    }
    if labelled:
        for scores, groups in ((record, found), (kmeans, plain)):
            scores["purity"] = clustering.purity(groups, labels)
            scores["adjusted_rand"] = float(adjusted_rand_score(labels, groups))
    if as_json:
        typer.echo(json.dumps(record, indent=1))
        return
    _print(record)


def _groups(found: np.ndarray, names: list[str], labels: np.ndarray | None) -> list[dict[str, Any]]:
    """Return the files of every group, the largest first, and how many there are of each label."""
    groups = []
    for number in sorted(set(found.tolist()), key=lambda each: -int((found == each).sum())):
        own = np.flatnonzero(found == number)
        group: dict[str, Any] = {"photographs": [names[each] for each in own]}
        if labels is not None:
            group["labels"] = dict(Counter(labels[own].tolist()).most_common())
        groups.append(group)
    return groups


def _print(record: dict[str, Any]) -> None:
    labelled = "purity" in record
    table = Table("group", "photographs", "labels" if labelled else "of them")
    for number, group in enumerate(record["groups"], 1):
        files = group["photographs"]
        told = [f"{label} {many}" for label, many in group["labels"].items()] if labelled else files
        more = ", ..." if len(told) > SHOWN else ""
        table.add_row(str(number), str(len(files)), ", ".join(told[:SHOWN]) + more)
    output.print(table)
    if record["count_estimated"]:
        output.print(f"{record['count']} people, as estimated; give --count if you know better")
    kmeans = record["kmeans"]
    if labelled:
        output.print(f"purity {record['purity']:.3f}; k-means of the pixels {kmeans['purity']:.3f}")
    else:
        output.print(
            f"agreement with k-means of the pixels {kmeans['agreement']:.3f} (1: the same)"
        )
