"""Photometric stereo on rendered sets and real photographs: one table of errors, told and true.

The rendered sets are made here; `--data DIR` adds folders of real photographs that are laid out as
`harmface stereo` reads them. The truth of a real set is `truth/normals.npy` or
`truth/approximate_normals.npy` where there is one, and else what its lamps give, if they are known.
"""

import argparse
import json
import time
import tracemalloc
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.stats import spearmanr

from data_synth.faces import head
from data_synth.lightings import mixed, uniform_directional
from data_synth.shapes import SHAPES
from harmface.geometry import GBuffer, frame_orthographic, gbuffer
from harmface.io import read_capture
from harmface.light import DistantLight
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.sphere import fibonacci_directions
from harmface.stereo import (
    angular_errors,
    object_mask,
    photometric_stereo,
    without_bas_relief,
    without_linear_map,
)

SIZE = 128
NOISE = 0.01
FITTED = 4000
"""Pixels that the best maps to the truth are fitted to."""


COLUMNS = [
    "set", "images", "method", "error", "bas-relief", "linear", "median", "told", "rank corr.",
    "cues believed", "s", "memory",
]  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One method on one set; errors are mean angles in degrees."""

    set: str
    images: int
    pixels: int
    method: str
    error: float
    after_bas_relief: float
    after_linear_map: float
    median_error: float
    median_told: float
    rank_correlation: float
    cues: str
    seconds: float
    memory: float


def main() -> None:
    """Measure, print the table, and write it as JSON if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, help="folder of real sets")
    parser.add_argument(
        "--methods", default="refined", help="for the rendered sets, by commas; empty for none"
    )
    parser.add_argument("--only", default="", help="sets whose names contain this")
    parser.add_argument("--json", type=Path, help="file to write the rows to")
    parser.add_argument("--markdown", type=Path, help="file to write the table to")
    arguments = parser.parse_args()
    methods = arguments.methods.split(",") if arguments.methods else []
    made = rendered(arguments.only) if methods else iter(())
    rows = [measured(*each, method) for each in made for method in methods]
    rows += [measured(*each, "refined") for each in real(arguments.data, arguments.only)]
    table = Table(*COLUMNS)
    for row in rows:
        table.add_row(*shown(row))
    Console(width=150).print(table)
    if arguments.markdown is not None:
        lines = [COLUMNS, ["---"] * len(COLUMNS), *(shown(row) for row in rows)]
        arguments.markdown.write_text("".join(f"| {' | '.join(line)} |\n" for line in lines))
    if arguments.json is not None:
        arguments.json.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n")


def shown(row: Row) -> list[str]:
    """Return the fields of a row that the table shows."""
    values = [value for name, value in asdict(row).items() if name != "pixels"]
    return [f"{value:.2f}" if isinstance(value, float) else str(value) for value in values]


def measured(
    name: str,
    images: np.ndarray,
    mask: np.ndarray | None,
    saturated: np.ndarray | None,
    truth: np.ndarray,
    method: str,
) -> Row:
    """Return a method's errors on a set, with time and memory (the stack is one)."""
    start = time.perf_counter()
    found = photometric_stereo(images, mask, method=method, saturated=saturated)
    seconds = time.perf_counter() - start
    tracemalloc.start()
    photometric_stereo(images, mask, method=method, saturated=saturated)
    memory = 1 + tracemalloc.get_traced_memory()[1] / images.nbytes
    tracemalloc.stop()
    believed = ", ".join(cue.name for cue in found.report.cues if cue.accepted)
    told = found.expected_error
    truth = truth.astype(np.float64)  # scans come in half precision
    true = np.linalg.norm(truth, axis=-1)
    used = found.mask & (true > 0.5)
    target = truth[used] / true[used, None]
    normals = found.normals[used]
    angles = angular_errors(normals, target)
    some = slice(None, None, max(1, len(target) // FITTED))
    after_bas_relief, after_linear_map = (
        float(angular_errors(best(normals[some], target[some]), target[some]).mean())
        for best in (without_bas_relief, without_linear_map)
    )
    rank = float(spearmanr(angles, told[used]).statistic)
    return Row(
        set=name,
        images=len(images),
        pixels=int(found.mask.sum()),
        method=method,
        error=float(angles.mean()),
        after_bas_relief=after_bas_relief,
        after_linear_map=after_linear_map,
        median_error=float(np.median(angles)),
        median_told=float(np.median(told[found.mask])),
        rank_correlation=rank,
        cues=believed,
        seconds=seconds,
        memory=memory,
    )


Set = tuple[str, np.ndarray, np.ndarray | None, np.ndarray | None, np.ndarray]


def rendered(only: str) -> Iterator[Set]:
    """Make the rendered sets of the objects asked for: attached shadows, noise in pixels."""
    makers = {name: SHAPES[name] for name in SHAPES}
    meshes = {name: mesh_of(make()) for name, make in makers.items()}
    meshes |= {f"head {seed}": mesh_of(head(seed)) for seed in (1, 2)}
    for number, (name, mesh) in enumerate(meshes.items()):
        if only.split(":")[0] not in name:
            continue
        view = gbuffer(mesh, frame_orthographic(mesh, SIZE))
        rng = np.random.default_rng(number)
        for kind, images in lit(view, rng).items():
            images = images + NOISE * images.mean() * rng.standard_normal(images.shape)
            images = np.maximum(images, 0).astype(np.float32)
            yield f"{name}: {kind}", images, view.mask, None, view.normals


def lit(view: GBuffer, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return a view under single lamps, equal and not, several lamps, and mixed light."""
    lamps = light_of(uniform_directional(64, rng, max_polar=70))
    single = render(view, lamps)
    found = {"equal lamps": single}
    for count in (12, 48):
        strengths = np.exp(0.5 * rng.standard_normal(count))
        found[f"unequal lamps ({count})"] = strengths[:, None, None] * single[:count]
    grid = fibonacci_directions(256)
    weights = np.full((64, len(grid)), 0.3 / len(grid))
    for image in weights:
        points = rng.integers(len(grid), size=rng.integers(1, 5))
        image[points] += rng.uniform(0.3, 1.0, len(points))
    found["points in a room"] = render(view, DistantLight(grid, weights))
    found["mixed"] = render(view, light_of(mixed(64, rng, directions=256)))
    return found


def real(folder: Path | None, only: str) -> Iterator[Set]:
    """Read the real sets below a folder that are asked for, and whose truth or lamps are known."""
    if folder is None:
        return
    places = {path.parent for path in folder.rglob("*.png") if "truth" not in path.parts}
    for place in sorted(places):
        name = str(place.relative_to(folder))
        if only not in name:
            continue
        capture = read_capture([place])
        mask = object_mask(capture.images) if capture.mask is None else capture.mask
        truth = next(
            (np.load(file) for file in sorted((place / "truth").glob("*normals.npy"))), None
        )
        if truth is None and capture.lights is not None:
            known = photometric_stereo(
                capture.images, mask, method="known-lights",
                light=capture.lights, strengths=np.ones(len(capture.lights)),
                saturated=capture.saturated,
            )  # fmt: skip
            truth = known.normals
        if truth is not None:
            yield name, capture.images, mask, capture.saturated, truth


if __name__ == "__main__":
    main()
