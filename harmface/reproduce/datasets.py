"""Labelled data sets of rendered heads, made in parallel and made again byte for byte.

A subject is the unit of work: its folder is rendered whole and closed by a record, so that a run
that was killed redoes only the subjects without one. The manifest comes last.
"""

import json
import os
import shutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from multiprocessing import get_context, parent_process
from pathlib import Path
from threading import Thread

import numpy as np
from threadpoolctl import threadpool_limits

from data_synth.camera_noise import photograph
from data_synth.environments import ENVIRONMENTS, rasterise
from data_synth.faces import head
from data_synth.lightings import Lights, mixed, nine_points, yale64
from harmface import checks
from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError, HarmfaceError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import write_image, write_npz, write_ply
from harmface.io.datasets import VERSION
from harmface.io.folders import MANIFEST, job_folder, write_json
from harmface.light import EnvironmentMap
from harmface.rendering import box_average, render
from harmface.reproduce.synthetic import Progress, light_of, mesh_of, subject_seed
from harmface.scale import Engine

LIGHTINGS = ("yale64", "ninepoints", "mixed", "environments")
MIXTURES = 16
"""Images of a subject under random mixtures."""

ENVIRONMENT_ROWS, ENVIRONMENT_DIRECTIONS = 64, 384
SUPERSAMPLING = 2
BRIGHTEST = 0.9
"""Where the exposure puts an image's brightest pixel, as a share of white."""

RECORD = "record.json"


@dataclass(frozen=True)
class Request:
    """What a data set is made of; the same request gives the same bytes.

    Parameters
    ----------
    identities
        Number of subjects.
    lightings
        One of `LIGHTINGS`.
    size
        Rows and columns of the images.
    seed
        Of everything random.
    identity_scale
        0 makes clones of the mean face, 1 a natural population.
    noise
        Standard deviation of a white pixel's noise, as a share of white; 0 for none.
    cast_shadows
        Whether heads shadow themselves.
    meshes, gbuffers
        Whether to write each subject's mesh and G-buffer too.
    """

    identities: int
    lightings: str
    size: int = 96
    seed: int = 0
    identity_scale: float = 1.0
    noise: float = 0.0
    cast_shadows: bool = True
    meshes: bool = False
    gbuffers: bool = False

    def __post_init__(self) -> None:
        checks.positive_integer("identities", self.identities)
        checks.positive_integer("size", self.size)
        checks.integer("seed", self.seed, 0)
        if self.lightings not in LIGHTINGS:
            raise ArgumentError(
                f"lightings must be one of {', '.join(LIGHTINGS)}, got {self.lightings!r}"
            )
        if not 0 <= self.identity_scale <= 2:
            raise ArgumentError(f"identity_scale must lie in [0, 2], got {self.identity_scale}")
        if not 0 <= self.noise <= 0.5:
            raise ArgumentError(f"noise must lie in [0, 0.5], got {self.noise}")


def make_dataset(
    folder: Path,
    request: Request,
    progress: Progress = lambda done: None,
    workers: int = 2,
    engine: Engine | None = None,
) -> None:
    """Render a data set, or finish one that was stopped.

    Parameters
    ----------
    folder
        Made if missing. One that holds part of the same data set is completed; any other that is
        not empty is refused.
    request
        What to make.
    progress
        Told how much is done.
    workers
        Processes that render.
    engine
        Where to render instead, such as on a cluster, all of which must see the folder.

    Raises
    ------
    FileError
        If the folder is another's, or cannot be written to.
    """
    with job_folder(folder, asdict(request)):
        names = [_name(number) for number in range(request.identities)]
        missing = [n for n, name in enumerate(names) if not (folder / name / RECORD).exists()]
        done = len(names) - len(missing)
        if not (folder / MANIFEST).exists():
            if engine is None:
                rendered = _rendered(folder, request, missing, workers)
            else:
                rendered = engine.each(partial(_numbered, folder.absolute(), request), missing)
            for _ in rendered:
                done += 1
                progress(done / len(names))
            records = [json.loads((folder / name / RECORD).read_text()) for name in names]
            manifest = {
                "format": "harmface-dataset",
                "version": VERSION,
                "request": asdict(request),
                "subjects": records,
            }
            write_json(folder / MANIFEST, manifest)
        # The manifest holds all of it; a kill between the two steps leaves work for the next run.
        for name in names:
            (folder / name / RECORD).unlink(missing_ok=True)


def _name(number: int) -> str:
    return f"subject_{number:04d}"


def _numbered(folder: Path, request: Request, number: int) -> int:
    render_subject(folder / _name(number), request, number)
    return number


def _rendered(folder: Path, request: Request, missing: list[int], workers: int) -> Iterator[int]:
    """Render subjects in parallel; yield each as it is finished."""
    if workers == 1 or len(missing) < 2:
        for number in missing:
            yield _numbered(folder, request, number)
        return
    # Spawned processes share no state with this one, whatever threads it runs.
    context = get_context("spawn")
    with ProcessPoolExecutor(workers, context, _exit_with_parent) as pool:
        jobs = [pool.submit(_numbered, folder, request, number) for number in missing]
        try:
            for job in as_completed(jobs):
                yield job.result()
        except BrokenProcessPool:
            raise HarmfaceError(
                f"{folder}: a process that renders it has ended, as happens when memory runs out; "
                "the same command goes on from there"
            ) from None
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _exit_with_parent() -> None:
    """Let a worker end as soon as the process that started it is gone, however it went.

    Otherwise workers of a killed run would go on writing where the next run writes too.
    """
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()


def render_subject(folder: Path, request: Request, number: int) -> None:
    """Render one subject under all its lights; its record is written last.

    Parameters
    ----------
    folder
        The subject's own; what a killed run left there is thrown away.
    request
        The data set.
    number
        Which subject.
    """
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        _render_subject(folder, request, number)


def _render_subject(folder: Path, request: Request, number: int) -> None:
    try:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
    except OSError as error:
        raise FileError(f"{folder}: cannot be made: {error.strerror}") from None
    seed = subject_seed(request.seed, number)
    # Streams of their own, so that neither noise nor lights depend on the other options.
    light_rng, noise_rng = np.random.default_rng([seed, 1]), np.random.default_rng([seed, 2])
    made = head(seed, identity_scale=request.identity_scale)
    mesh = mesh_of(made)
    lights = _lights(request.lightings, light_rng)
    camera = frame_orthographic(mesh, request.size * SUPERSAMPLING)
    view = gbuffer(mesh, camera)
    images = render(view, light_of(lights), caster=mesh if request.cast_shadows else None)
    images = box_average(images, SUPERSAMPLING)
    peaks = images.max(axis=(1, 2))
    exposures = BRIGHTEST / np.where(peaks > 0, peaks, 1)
    images *= exposures[:, None, None]
    if request.noise > 0:
        # Shot noise of N electrons is sqrt(N), a share 1 / sqrt(N) of the signal.
        images = photograph(images, rng=noise_rng, full_well=request.noise**-2)
    coarse = gbuffer(mesh, frame_orthographic(mesh, request.size), SUPERSAMPLING)
    write_image(folder / "mask.png", coarse.mask.astype(float), bits=8)
    files = [f"image_{k:03d}.png" for k in range(len(images))]
    for name, image in zip(files, images, strict=True):
        write_image(folder / name, image)
    if request.meshes:
        write_ply(folder / "mesh.ply", mesh)
    if request.gbuffers:
        arrays = {
            "normals": coarse.normals,
            "albedo": coarse.albedo,
            "depth": coarse.depth,
            "position": coarse.position,
            "mask": coarse.mask,
        }
        write_npz(folder / "gbuffer.npz", "gbuffer", 1, arrays)
    record = {
        "name": folder.name,
        "seed": seed,
        "parameters": made.parameters,
        "camera": {"center": camera.center, "height": camera.height},
        "directions": lights.directions.tolist(),
        "images": [
            {
                "file": name,
                "light": label,
                "subset": None if lights.subset is None else int(lights.subset[k]),
                "irradiances": _sparse(lights.weights[k]),
                "exposure": float(exposures[k]),
            }
            for k, (name, label) in enumerate(zip(files, lights.labels, strict=True))
        ],
    }
    write_json(folder / RECORD, record)


def _lights(name: str, rng: np.random.Generator) -> Lights:
    if name == "yale64":
        return yale64()
    if name == "ninepoints":
        return nine_points()
    if name == "mixed":
        return mixed(MIXTURES, rng)
    return environment_lights()


@lru_cache(maxsize=1)
def environment_lights() -> Lights:
    """Return every procedural environment as a grey light, one image each.

    Radiance is turned to luminance; each environment is gathered into directional lights of the
    same total.
    """
    directions, weights = [], []
    for make in ENVIRONMENTS.values():
        image = luminance(rasterise(make(), ENVIRONMENT_ROWS))
        gathered = EnvironmentMap.from_image(image).as_distant_light(ENVIRONMENT_DIRECTIONS)
        directions.append(gathered.directions)
        weights.append(gathered.irradiances / gathered.irradiances.sum())
    table = np.zeros((len(weights), sum(map(len, weights))))
    first = 0
    for row, own in zip(table, weights, strict=True):
        row[first : first + len(own)] = own
        first += len(own)
    return Lights("environments", np.concatenate(directions), table, tuple(ENVIRONMENTS))


def _sparse(weights: np.ndarray) -> dict[str, list[float] | list[int]]:
    """Return the lights that are on, by their number."""
    on = np.flatnonzero(weights)
    return {"direction": on.tolist(), "value": weights[on].tolist()}
