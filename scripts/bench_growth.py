"""How time and memory grow with size, and one large recognition from end to end.

`python scripts/bench.py --growth` prints the first; this script by itself makes a gallery of many
subjects in a store, and recognises probes in it by the command line, with its memory watched:
python scripts/bench_growth.py --subjects 100000 --probes 1000 --workers 2

Galleries are of 200 procedural heads. A larger one repeats them, each time with another albedo: a
smooth random field of 20 %. That makes many subjects of like faces, and no natural population.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.ndimage import gaussian_filter
from threadpoolctl import threadpool_limits

from data_synth.faces import head
from data_synth.lightings import mixed, yale64
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import create_store, open_store
from harmface.light import EnvironmentMap, project
from harmface.pca import analytic_pca
from harmface.recognition import orthonormal_basis, score_block
from harmface.recognition.meshes import subject_images
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.scale import Engine, Job, engine, fill_store
from harmface.stereo import photometric_stereo

HEADS, ROWS = 200, 64
SPREAD = 0.2
"""Standard deviation of the logarithm of a repeated head's albedo."""


def harmonic_images_of(number: int) -> np.ndarray:
    """Return the nine harmonic images of a procedural head."""
    return subject_images(mesh_of(head(number, n_vertices=5000)), ROWS, 2)


@lru_cache(maxsize=1)
def heads(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the harmonic images of all heads, and the pixels that they share."""
    images = np.load(file)
    return images, (images[:, 0] > 0).all(axis=0)


def subject(file: Path, number: int) -> np.ndarray:
    """Return the harmonic images of a subject on the mask."""
    images, mask = heads(file)
    field = gaussian_filter(np.random.default_rng([1, number]).standard_normal(mask.shape), 1)
    albedo = np.exp(SPREAD * field / field.std())
    return (images[number % len(images)] * albedo)[:, mask].astype(np.float32)


def basis(file: Path, number: int) -> np.ndarray:
    """Return the subspace of a subject."""
    return orthonormal_basis(subject(file, number), 9)


def probe(file: Path, total: int, number: int) -> np.ndarray:
    """Return a photograph of some subject in random light, with noise of 1 %."""
    rng = np.random.default_rng([2, number])
    image = (np.eye(1, 9)[0] + 0.4 * rng.standard_normal(9)) @ subject(file, owner(total, number))
    return image + 0.01 * np.abs(image).max() * rng.standard_normal(image.shape)


def owner(total: int, number: int) -> int:
    """Return which of a number of subjects a probe shows."""
    return int(np.random.default_rng([3, number]).integers(total))


def make_stores(folder: Path, subjects: int, probes: int, at: Engine) -> tuple[Path, Path]:
    """Make a gallery and its probes in a folder, or finish them."""
    file = folder / "heads.npy"
    if not file.exists():
        np.save(file, np.stack(list(at.each(harmonic_images_of, range(HEADS)))))
    mask = heads(file)[1]
    pixels = int(mask.sum())
    gallery = create_store(
        *(folder / "big.zarr", "gallery", [f"subject_{k:06d}" for k in range(subjects)], mask),
        *((9, pixels), {"method": "9d"}),
    )
    fill_store(gallery, partial(basis, file), range(subjects), Job(at))
    packed = create_store(
        *(folder / "probes.zarr", "probes", [f"probe_{k:06d}" for k in range(probes)], mask),
        *((pixels,), {}),
    )
    fill_store(packed, partial(probe, file, subjects), range(probes), Job(at))
    return gallery.path, packed.path


def growth() -> list[tuple[str, list[int], list[float], list[float]]]:
    """Return, for each kind of work, four sizes, the seconds and the bytes that each takes."""
    images = np.stack([harmonic_images_of(k) for k in range(4)])
    mask = (images[:, 0] > 0).all(axis=0)
    bases = orthonormal_basis(images[..., mask], 9)
    rng = np.random.default_rng(0)
    surface = mesh_of(head(0))

    def recognition(subjects: int) -> Callable[[], object]:
        gallery = np.resize(bases, (subjects, *bases.shape[1:])).astype(np.float32)
        gallery += 0.01 * rng.standard_normal(gallery.shape, dtype=np.float32)
        probes = rng.random((500, gallery.shape[2]), dtype=np.float32)
        return lambda: score_block(gallery, probes, 5)

    def rendering(side: int) -> Callable[[], object]:
        view, light = gbuffer(surface, frame_orthographic(surface, side)), light_of(yale64())
        return lambda: render(view, light, caster=surface)

    def projection(rows: int) -> Callable[[], object]:
        sky = EnvironmentMap.from_image(rng.random((rows, 2 * rows, 3), dtype=np.float32))
        return lambda: project(sky, 4)

    def stereo(side: int) -> Callable[[], object]:
        view = gbuffer(surface, frame_orthographic(surface, side))
        pictures = render(view, light_of(mixed(16, 0, directions=64)))
        return lambda: photometric_stereo(pictures, view.mask, method="9d")

    def components(side: int) -> Callable[[], object]:
        normals = gbuffer(surface, frame_orthographic(surface, side)).normals
        return lambda: analytic_pca(normals)

    kinds = (
        ("recognition, 500 probes, by subjects", recognition, [500, 1000, 2000, 4000], 1),
        ("rendering, 64 lamps, cast shadows, by pixels", rendering, [32, 64, 128, 256], 2),
        ("projection to degree 4, by pixels", projection, [128, 256, 512, 1024], 2),
        ("stereo, 9d, 16 images, by pixels", stereo, [32, 64, 128, 256], 2),
        ("analytic PCA, by pixels", components, [64, 128, 256, 512], 2),
    )
    found = []
    for name, make, sides, power in kinds:
        seconds, memory = [], []
        for side in sides:
            call = make(side)
            call()  # what is made once is made
            times = []
            for _ in range(3):
                start = time.perf_counter()
                call()
                times.append(time.perf_counter() - start)
            seconds.append(min(times))
            tracemalloc.start()
            call()
            memory.append(float(tracemalloc.get_traced_memory()[1]))
            tracemalloc.stop()
        found.append((name, [side**power for side in sides], seconds, memory))
    return found


def exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Return the power of the size by which values grow, by least squares of logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def print_growth() -> None:
    """Print a table of how time and memory grow, and what Dask adds to a minute of work."""
    table = Table("work", "seconds at four sizes", "exponent", "MB", "exponent")
    for name, sizes, seconds, memory in growth():
        table.add_row(
            name,
            " ".join(f"{each:.3f}" for each in seconds),
            f"{exponent(sizes, seconds):.2f}",
            " ".join(f"{each / 2**20:.0f}" for each in memory),
            f"{exponent(sizes, memory):.2f}",
        )
    Console().print(table)
    alone, shared = dask_overhead()
    Console().print(
        f"heads rendered in this process: {alone:.0f} s, by two workers of a Dask cluster: "
        f"{shared:.0f} s, which is {2 * shared / alone - 1:+.0%} beside half of it"
    )


def dask_overhead() -> tuple[float, float]:
    """Return the seconds of about a minute of work here and on two workers, cluster included."""
    with threadpool_limits(1):
        start = time.perf_counter()
        harmonic_images_of(0)
        each = time.perf_counter() - start
        items = range(int(60 / each))
        start = time.perf_counter()
        with engine() as at:
            list(at.each(harmonic_images_of, items))
        alone = time.perf_counter() - start
    start = time.perf_counter()
    with engine(2) as at:
        list(at.each(harmonic_images_of, items))
    return alone, time.perf_counter() - start


def memory_of(process: int) -> int:
    """Return the bytes of a process and all that it started, pages they share counted in parts."""
    total = 0
    try:
        for line in Path(f"/proc/{process}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                total = 1024 * int(line.split()[1])
        children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
        threads = Path(f"/proc/{process}/task").iterdir()
        children = [c for t in threads for c in (t / "children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return total
    return total + sum(memory_of(int(child)) for child in children)


def watched(command: list[str], output: Path) -> tuple[float, float, int]:
    """Run a command; return its seconds, those of all processors, and the most memory it had."""
    most, start, before = 0, time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    with output.open("wb") as file:
        process = subprocess.Popen(command, stdout=file)
        while process.poll() is None:
            most = max(most, memory_of(process.pid))
            time.sleep(0.1)
    if process.returncode:
        sys.exit(process.returncode)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, busy, most


def main() -> None:
    """Print how long a large recognition takes, its memory, and how many it names rightly."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--subjects", type=int, default=100_000)
    parser.add_argument("--probes", type=int, default=1000)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--first-pass", type=int, help="subjects that a first pass leaves")
    parser.add_argument("--folder", type=Path, help="where the stores are, or are to be kept")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(exist_ok=True)
        start = time.perf_counter()
        with engine(options.workers) as at:
            paths = make_stores(folder, options.subjects, options.probes, at)
        print(
            f"stores: {time.perf_counter() - start:.1f} s, {open_store(paths[0], 'gallery').shape}"
        )
        local = [] if options.workers is None else ["--workers", str(options.workers)]
        if options.first_pass is not None:
            local += ["--first-pass", str(options.first_pass)]
        command = [
            str(Path(sys.executable).with_name("harmface")),
            "recognize",
            *map(str, paths),
            *local,
        ]
        seconds, busy, most = watched([*command, "--top", "5", "--json"], folder / "answers.json")
        found = json.loads((folder / "answers.json").read_text())["results"]
    right = sum(
        each["ranking"][0]["subject"] == f"subject_{owner(options.subjects, k):06d}"
        for k, each in enumerate(found)
    )
    print(f"recognize: {seconds:.1f} s, of processors {busy:.1f} s, {most / 2**30:.2f} GiB")
    print(f"named rightly: {right} of {len(found)}")


if __name__ == "__main__":
    main()
