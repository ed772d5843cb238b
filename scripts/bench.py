"""Speed as ratios within one run: against memory bandwidth, bare library calls, and peers.

Peers come with `pip install '.[bench]'`; one that is missing is left out and said. `--json` keeps
the ratios; `--compare` sets those of an earlier run, on the same kind of machine, beside them.
"""

import os

# Some machines pin an OpenBLAS kernel that is not their fastest; measure without.
os.environ.pop("OPENBLAS_CORETYPE", None)

import argparse
import importlib.util
import json
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_growth import print_growth
from rich.console import Console
from rich.table import Table
from sklearn.utils.extmath import randomized_svd

from data_synth.faces import head
from data_synth.lightings import mixed, yale64
from data_synth.shapes import bumpy_sphere, sphere
from harmface.geometry import frame_orthographic, gbuffer
from harmface.inverse import estimate_light
from harmface.light import DistantLight, EnvironmentMap, PolygonLight, project, published_probe
from harmface.light.polygon_light import EDGE_NODES
from harmface.moving import surface_from_film
from harmface.pca import analytic_pca, attached_shadow_pca
from harmface.recognition import (
    enroll,
    non_negative_distances,
    pixel_blocks,
    robust_distances,
    score_block,
    subject_photographs,
    subspace_distances,
)
from harmface.reflectance import Phong
from harmface.rendering import (
    harmonic_images,
    irradiance,
    irradiance_map,
    reflection_map,
    render,
    transfer,
)
from harmface.reproduce.datasets import Request, make_dataset
from harmface.reproduce.films import film_head, rendered_film, turns
from harmface.reproduce.moving import head_errors
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.sphere import (
    fibonacci_directions,
    random_directions,
    real_harmonics,
    stratified_directions,
)
from harmface.stereo import factorize, photometric_stereo

REPEATS = 7
DATASET_SUBJECTS = 16
"""Subjects rendered to tell the time of 100."""


def best(*calls: Callable[[], object], repeats: int = REPEATS) -> list[float]:
    """Return the least time of each call in seconds; they take turns, so that noise is shared."""
    times = np.empty((repeats, len(calls)))
    for row in times:
        for column, call in enumerate(calls):
            start = time.perf_counter()
            call()
            row[column] = time.perf_counter() - start
    return list(times.min(axis=0))


def peak(call: Callable[[], object]) -> int:
    """Return the most bytes that a call holds at a time."""
    tracemalloc.start()
    call()
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


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
    ours, bare, blocks = best(
        lambda: subspace_distances(probes, bases),
        lambda: probes @ flat.T,
        lambda: score_block(bases, probes, 5),
    )
    few, windows = bases[:128], pixel_blocks(np.ones((64, 64), bool))
    robust, plain = best(
        lambda: robust_distances(probes[:128], few, windows),
        lambda: subspace_distances(probes[:128], few),
    )
    heads = {str(seed): mesh_of(head(seed)) for seed in range(8)}
    gallery = enroll(heads, 64, cast_shadows=False)
    assert gallery.harmonic is not None
    images = gallery.harmonic[:, :, gallery.mask]
    lit = subject_photographs(heads["0"], light_of(yale64()), 64)[:, gallery.mask]
    lit = np.repeat(lit, 16, axis=0)
    seconds = best(lambda: non_negative_distances(lit, images))[0]
    del bases, flat, few

    def large() -> np.ndarray:
        return subspace_distances(probes, rng.random((10_000, 9, 64 * 64), dtype=np.float32) / 64)

    return [
        ("1000 probes x 1000 subjects, 9-D / matrix product", ours / bare, "at most 2"),
        ("the five nearest of a block, in float64 / all distances", blocks / ours, "at most 1.3"),
        ("robust distance, 9-D / plain", robust / plain, "at most 30"),
        (
            "microseconds for a pair, 9-D, non-negative light",
            1e6 * seconds / (len(lit) * len(images)),
            "at most 50",
        ),
        ("GB for 1000 probes x 10,000 subjects", peak(large) / 2**30, "at most 8"),
    ]


def population() -> list[tuple[str, float, str]]:
    """Measure heads, and data sets, in seconds: these bars are absolute."""
    head(0)
    each = best(lambda: head(1))[0]
    request = Request(DATASET_SUBJECTS, "yale64", size=96)
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        make_dataset(Path(folder, "set"), request, workers=2)
        took = (time.perf_counter() - start) * 100 / DATASET_SUBJECTS
    mesh = mesh_of(head(1))
    view = gbuffer(mesh, frame_orthographic(mesh, 192))
    light = light_of(yale64())
    lit, shadowed = best(lambda: render(view, light), lambda: render(view, light, caster=mesh))
    split = f"a subject: head {each:.2f}, shading {lit:.2f}, rays {shadowed - lit:.2f} s"
    return [
        ("heads of 20,000 vertices a second", 1 / each, "at least 10"),
        (
            "seconds for 100 identities x 64 lights, 96^2, cast shadows",
            took,
            f"at most 90; {split}",
        ),
    ]


def components() -> list[tuple[str, float, str]]:
    """Measure analytic PCA against 4,000 images, and against the bare Gram product."""
    mesh = mesh_of(head(0))
    normals = gbuffer(mesh, frame_orthographic(mesh, 512)).normals.astype(np.float32)
    harmonics = real_harmonics(normals[normals.any(axis=-1)], 8)
    ours, bare = best(lambda: analytic_pca(normals), lambda: harmonics @ harmonics.T)
    start = time.perf_counter()
    attached_shadow_pca(normals, fibonacci_directions(4000))
    images = time.perf_counter() - start
    return [
        ("PCA of 4,000 images / analytic PCA, 512^2, degree 8", images / ours, "at least 100"),
        ("analytic PCA, 512^2, degree 8 / bare Gram product", ours / bare, "at most 4"),
    ]


def stereo() -> list[tuple[str, float, str]]:
    """Measure rank-9 factorisation against a Gram product and scikit-learn; then whole methods."""
    rng = np.random.default_rng(0)
    light = rng.random((256, 9), dtype=np.float32)
    stack = light @ rng.random((9, 2**20), dtype=np.float32)
    for image in stack:
        image += 0.01 * rng.standard_normal(stack.shape[1], dtype=np.float32)
    ours, bare = best(lambda: factorize(stack, 9), lambda: stack @ stack.T)
    start = time.perf_counter()
    left, values, right = randomized_svd(stack, 9, random_state=0)
    theirs = time.perf_counter() - start
    found = factorize(stack, 9)
    residuals = residual(stack, found.light, found.structure), residual(stack, left * values, right)
    del stack, left, right, found
    mesh = mesh_of(bumpy_sphere())
    view = gbuffer(mesh, frame_orthographic(mesh, 256))
    images = render(view, light_of(mixed(64, 0, directions=256)))
    seconds = []
    for method in ("9d", "refined"):
        start = time.perf_counter()
        photometric_stereo(images, view.mask, method=method)
        seconds.append(time.perf_counter() - start)
    beside = peak(lambda: photometric_stereo(images, view.mask)) / images.nbytes
    same = f"residual {residuals[0] / residuals[1]:.6f} of its"
    return [
        ("rank 9 of 256 images, 2^20 pixels / bare Gram product", ours / bare, "at most 2.5"),
        ("scikit-learn's randomised SVD / the same", theirs / ours, f"at least 5; {same}"),
        ("seconds for 9-D stereo, 64 x 256^2", seconds[0], "at most 5"),
        ("seconds for refined stereo, 64 x 256^2", seconds[1], "at most 15"),
        ("memory of refined stereo, with the stack / the stack", 1 + beside, "at most 3"),
    ]


def residual(stack: np.ndarray, left: np.ndarray, right: np.ndarray) -> float:
    """Return the norm of what a factorisation leaves, image by image."""
    rows = zip(stack, left, strict=True)
    return float(np.sqrt(sum(np.sum((row - factor @ right) ** 2) for row, factor in rows)))


def moving() -> list[tuple[str, float, str]]:
    """Measure a surface from a film, its errors against matching by brightness, and its memory."""
    directions = fibonacci_directions(60)
    soft = np.maximum(0.3 + directions[:, 1] + directions[:, 0] / 2, 0)
    film = rendered_film(
        film_head(4, plain=True),
        turns("yaw:-30:30,pitch:-10:10", 30),
        DistantLight(directions, soft),
        96,
        noise=0.01,
        rng=0,
    )
    frames, masks, views = film.frames, film.masks, film.views
    start = time.perf_counter()
    _, depth = head_errors(film, surface_from_film(frames, masks, views))
    seconds = time.perf_counter() - start
    _, plain = head_errors(film, surface_from_film(frames, masks, views, shading=False))
    return [
        ("seconds for a surface from a film, 30 x 96^2", seconds, "at most 120"),
        (
            "depth error of the film by shading / by brightness",
            depth.mean() / plain.mean(),
            "at most 0.5",
        ),
    ]


def precomputed() -> list[tuple[str, float, str]]:
    """Measure transfer against the bare rays it needs, and polygon lights against harmonics."""
    mesh = mesh_of(bumpy_sphere(142))
    directions = stratified_directions(512, 0).reshape(-1, 3).astype(np.float32)
    some = np.arange(0, len(mesh.vertices), 20)
    direction, point = np.nonzero(directions @ mesh.normals[some].astype(np.float32).T > 0)
    off = mesh.vertices[some] + 1e-4 * mesh.rays.radius * mesh.normals[some]
    starts, rays = mesh.rays.local(off)[point], directions[direction]

    def bare() -> None:
        for _ in range(20):
            mesh.rays.occluded(starts, rays)

    ours, theirs = best(lambda: transfer(mesh, 4, samples=1024), bare)
    rng = np.random.default_rng(0)
    corners = rng.uniform(-1, 1, (100, 4, 3)) * [1, 1, 0] + [0, 0, 3]
    lamps = [PolygonLight(each[:3], np.ones(1)) for each in corners]
    # Those that would shine away from the points are turned round.
    lamps = [
        PolygonLight(lamp.vertices[:: int(-np.sign(lamp.area_vector[2]))], lamp.radiance)
        for lamp in lamps
    ]
    points = rng.uniform(-1, 1, (10_000, 3))
    nodes = random_directions(3 * EDGE_NODES * len(points), 0)

    def all_probes() -> None:
        for lamp in lamps:
            lamp.probes(points, 2)

    def all_harmonics() -> None:
        for _ in lamps:
            real_harmonics(nodes, 2)

    # One run of each: a hundred lamps are an average already.
    all_lamps, harmonics_alone = best(all_probes, all_harmonics, repeats=1)
    megabytes = peak(lambda: transfer(mesh, 4, samples=1024)) / 2**20
    return [
        (
            f"transfer, {len(mesh.vertices)} vertices, 1024 directions / Embree",
            ours / theirs,
            "at most 1.5",
        ),
        ("MB of the same, 8 of them the result", megabytes, "bounded by a block"),
        (
            "100 polygon lights x 10,000 points, gradients / harmonics of their nodes",
            all_lamps / harmonics_alone,
            "at most 30",
        ),
    ]


def maps() -> list[tuple[str, float, str]]:
    """Measure projection of maps against one sum over the pixels, and against peers."""
    rng = np.random.default_rng(0)
    latlong = EnvironmentMap.from_image(rng.random((512, 1024, 3), dtype=np.float32))
    start = time.perf_counter()
    project(latlong, 20)
    first = time.perf_counter() - start
    two, twenty, total = best(
        lambda: project(latlong, 2),
        lambda: project(latlong, 20),
        lambda: latlong.radiance.sum(),
    )
    cube = EnvironmentMap.from_image(rng.random((6, 256, 256, 3), dtype=np.float32), "cube")
    faces, by_numpy, nine = best(
        lambda: project(cube, 2),
        lambda: plain_projection(cube),
        lambda: irradiance_map(published_probe("grace"), "latlong", 256),
    )
    small = EnvironmentMap.from_image(rng.random((64, 128, 3)))
    normals = small.layout.directions(256)
    start = time.perf_counter()
    irradiance(normals, small.as_distant_light())
    brute = time.perf_counter() - start
    plain = best(lambda: plain_projection(latlong))[0]
    rows = [
        ("lat-long 1024 x 512 RGB to degree 2 / numpy sum", two / total, "at most 2.5"),
        ("the same to degree 20 / numpy sum", twenty / total, "at most 16"),
        ("first call / warm call, degree 20", first / twenty, "at most 20"),
        ("degree 2 / plain numpy projection", two / plain, "below 1"),
        ("cube 6 x 256^2, plain numpy / ours", by_numpy / faces, "at least 10"),
        ("256 x 512 irradiance map, brute force / ours", brute / nine, "at least 1000"),
    ]
    lobe = Phong(20)
    sharp = EnvironmentMap.from_image(rng.random((256, 512)))
    glossy = best(lambda: reflection_map(sharp, lobe, 64, accuracy=1e-3))[0]
    start = time.perf_counter()
    mirrored = sharp.layout.directions(64).reshape(-1, 3)
    power = (sharp.radiance * sharp.solid_angles).ravel()
    for some in np.array_split(mirrored, 64):
        np.maximum(some @ sharp.directions.reshape(-1, 3).T, 0) ** 20.0 @ power
    brute = time.perf_counter() - start
    row = "256 x 512 map prefiltered at 64 x 128, brute force / ours"
    rows.append((row, brute / glossy, "at least 100"))
    megabytes = max(peak(lambda m=m: project(m, 20)) for m in (latlong, cube)) / 2**20  # type: ignore[misc]
    rows.append(("MB beside the map, degree 20, lat-long or cube", megabytes, "at most 64"))
    for name, peer in sht_peers(latlong).items():
        theirs = best(peer)[0] if peer else np.nan
        rows.append((f"degree 2 / {name}", two / theirs, "below 1" if peer else "not installed"))
    return rows


def plain_projection(environment: EnvironmentMap) -> np.ndarray:
    """Project as a script would: harmonics of every pixel, weighted, one product."""
    basis = real_harmonics(environment.directions.reshape(-1, 3), 2)
    weighted = basis * environment.solid_angles.reshape(-1)
    return environment.radiance.reshape(3, -1) @ weighted.T


def sht_peers(environment: EnvironmentMap) -> dict[str, Callable[[], object] | None]:
    """Return the same projection by other libraries, None for those not installed."""
    channels = [np.ascontiguousarray(channel, np.float64) for channel in environment.radiance]
    found: dict[str, Callable[[], object] | None] = {"ducc0": None, "pyshtools": None}
    if importlib.util.find_spec("ducc0"):
        from ducc0.sht import analysis_2d

        found["ducc0"] = lambda: [
            analysis_2d(map=channel[None], lmax=2, spin=0, geometry="F1", nthreads=2)
            for channel in channels
        ]
    if importlib.util.find_spec("pyshtools"):
        from pyshtools.expand import SHExpandDH

        found["pyshtools"] = lambda: [
            SHExpandDH(channel, sampling=2, lmax_calc=2) for channel in channels
        ]
    return found


def inverse_light() -> list[tuple[str, float, str]]:
    """Measure light from a megapixel in colour, against the bare product of basis and picture."""
    rng = np.random.default_rng(0)
    normals = random_directions(2**20, rng).reshape(1024, 1024, 3)
    normals[..., 2] = np.abs(normals[..., 2])
    basis = harmonic_images(normals, np.ones((1024, 1024)))
    light = np.eye(1, 9) * 4 + 0.3 * rng.standard_normal((3, 9))
    image = np.moveaxis(np.tensordot(light, basis, axes=1), 0, -1)
    image = image + 0.02 * rng.standard_normal(image.shape)
    flat, values = basis.reshape(9, -1), image.reshape(-1, 3)
    ours, bare = best(lambda: estimate_light(image, normals), lambda: flat @ values)
    return [("light, 1024^2 RGB to degree 2 / bare product", ours / bare, "at most 3")]


def main() -> None:
    """Print a table of ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="file to keep the ratios in")
    parser.add_argument("--compare", type=Path, help="what --json kept of an earlier run")
    parser.add_argument(
        "--growth", action="store_true", help="print how time and memory grow with size instead"
    )
    options = parser.parse_args()
    if options.growth:
        print_growth()
        return
    before = {}
    if options.compare is not None:
        rows = json.loads(options.compare.read_text())["rows"]
        before = {row["what"]: row["ratio"] for row in rows}
    table = Table("what / against", "ratio", "bar", *(["before", "change"] if before else []))
    kept = []
    for measure in (
        harmonics,
        rasterization,
        recognition,
        population,
        components,
        stereo,
        moving,
        precomputed,
        maps,
        inverse_light,
    ):
        for what, ratio, bar in measure():
            known = bool(np.isfinite(ratio))
            kept.append({"what": what, "ratio": float(ratio) if known else None, "bar": bar})
            cells = [what, f"{ratio:.2f}", bar]
            if (old := before.get(what)) and known:
                cells += [f"{old:.2f}", f"{ratio / old - 1:+.0%}"]
            table.add_row(*cells)
    Console().print(table)
    if options.json is not None:
        options.json.write_text(json.dumps({"rows": kept}, indent=1) + "\n")


if __name__ == "__main__":
    main()
