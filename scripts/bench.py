"""Speed as ratios within one run: against memory bandwidth, bare library calls, and peers.

Peers come with `pip install '.[bench]'`; one that is missing is left out and said.
"""

import os

# Some machines pin an OpenBLAS kernel that is not their fastest; measure without.
os.environ.pop("OPENBLAS_CORETYPE", None)

import importlib.util
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from data_synth.shapes import sphere
from harmface.geometry import frame_orthographic, gbuffer
from harmface.recognition import subspace_distances
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import random_directions, real_harmonics

REPEATS = 7


def best(*calls: Callable[[], object]) -> list[float]:
    """Return the least time of each call in seconds; they take turns, so that noise is shared."""
    times = np.empty((REPEATS, len(calls)))
    for row in times:
        for column, call in enumerate(calls):
            start = time.perf_counter()
            call()
            row[column] = time.perf_counter() - start
    return list(times.min(axis=0))


def harmonics() -> list[tuple[str, float, str]]:
    """Measure nine harmonics at a million normals, and degree 10 against sphericart."""
    normals = random_directions(1_000_000, 0).astype(np.float32)
    source = np.zeros((9, len(normals)), np.float32)
    ours, copy = best(
        lambda: real_harmonics(normals, 2), lambda: np.copyto(np.empty_like(source), source)
    )
    rows = [("nine harmonics, 10^6 normals / writing the result", ours / copy, "at most 3")]
    name = "degree 10, 10^6 normals / sphericart"
    if importlib.util.find_spec("sphericart") is None:
        return [*rows, (name, np.nan, "sphericart is not installed")]
    import sphericart

    peer = sphericart.SphericalHarmonics(10)
    ours, theirs = best(lambda: real_harmonics(normals, 10), lambda: peer.compute(normals))
    return [*rows, (name, ours / theirs, "below 1")]


def rasterization() -> list[tuple[str, float, str]]:
    """Measure a G-buffer of 512 x 512 pixels on 40,000 vertices against the bare Embree call."""
    mesh = mesh_of(sphere(142))
    camera = frame_orthographic(mesh, 512)
    origins, directions = camera.rays()
    origins, directions = mesh.rays.local(origins), directions.astype(np.float32)
    ours, bare = best(
        lambda: gbuffer(mesh, camera), lambda: mesh.rays.first_hits(origins, directions)
    )
    return [(f"G-buffer 512^2, {len(mesh.vertices)} vertices / Embree", ours / bare, "at most 2.5")]


def recognition() -> list[tuple[str, float, str]]:
    """Measure a thousand probes against a thousand subjects, against the bare matrix product."""
    rng = np.random.default_rng(0)
    probes = rng.random((1000, 64 * 64), dtype=np.float32)
    bases = rng.standard_normal((1000, 9, 64 * 64), dtype=np.float32) / 64
    flat = bases.reshape(-1, 64 * 64)
    ours, bare = best(lambda: subspace_distances(probes, bases), lambda: probes @ flat.T)
    return [("1000 probes x 1000 subjects, 9-D / matrix product", ours / bare, "at most 2")]


def main() -> None:
    """Print a table of ratios."""
    table = Table("what / against", "ratio", "bar")
    for measure in (harmonics, rasterization, recognition):
        for what, ratio, bar in measure():
            table.add_row(what, f"{ratio:.2f}", bar)
    Console().print(table)


if __name__ == "__main__":
    main()
