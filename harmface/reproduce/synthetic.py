"""Where the synthetic world meets the package: heads become meshes, lamps become light."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from data_synth.camera_noise import photograph
from data_synth.environments import ENVIRONMENTS, Environment, quadrature, rasterise
from data_synth.faces import Head, head
from data_synth.lightings import Lights
from data_synth.shapes import SHAPES, Shape
from harmface.checks import integer, positive_integer
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.io import atomic_write, output_folder, write_environment_map, write_ply
from harmface.light import DistantLight
from harmface.rendering import box_average, render
from harmface.sphere import real_harmonics

Progress = Callable[[float], None]
"""Called with the fraction done."""

MANIFEST = "manifest.json"
COEFFICIENT_DEGREE = 4


def mesh_of(surface: Head | Shape) -> Mesh:
    """Return a synthetic head or shape as a mesh."""
    return Mesh(surface.vertices, surface.faces, surface.normals, surface.albedo)


def light_of(lights: Lights) -> DistantLight:
    """Return a set of synthetic lights as distant light, an image for each."""
    return DistantLight(lights.directions, lights.weights)


def subject_seed(seed: int, number: int) -> int:
    """Return the seed of one subject of a population."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])


def probe_images(
    mesh: Mesh, lights: Lights, size: int, rng: np.random.Generator, supersampling: int = 2
) -> np.ndarray:
    """Return photographs of a mesh by the oracle: cast shadows, antialiasing and camera noise.

    The exposure of each photograph puts its brightest pixel at 90 % of the full well.

    Parameters
    ----------
    mesh
        The subject.
    lights
        One photograph for each of its images.
    size
        Rows and columns.
    rng
        For the camera's noise.
    supersampling
        Samples along each side of a pixel.

    Returns
    -------
    numpy.ndarray
        (images, size, size), linear values in [0, 1].
    """
    view = gbuffer(mesh, frame_orthographic(mesh, size * supersampling))
    images = box_average(render(view, light_of(lights), caster=mesh), supersampling)
    peaks = images.max(axis=(1, 2), keepdims=True)
    return photograph(images / peaks, rng=rng, exposure=0.9, bits=8)


def synthesize_faces(
    folder: Path, count: int, seed: int, progress: Progress = lambda done: None
) -> None:
    """Write heads as PLY files with linear albedo as vertex colours, and a manifest.

    Parameters
    ----------
    folder
        Made if missing; a folder that holds other files is refused.
    count
        Number of subjects.
    seed
        Of the population: subject `i` of a seed is the same however many are made.
    progress
        Told how much is done.
    """
    count, seed = positive_integer("count", count), integer("seed", seed, 0)
    names = [f"face_{number:03d}.ply" for number in range(count)]
    subjects = []
    with output_folder(folder, [*names, MANIFEST]):
        for number, name in enumerate(names):
            each = subject_seed(seed, number)
            made = head(each)
            write_ply(folder / name, mesh_of(made))
            subjects.append({"file": name, "seed": each, "parameters": made.parameters})
            progress((number + 1) / count)
        write_manifest(folder, {"kind": "faces", "seed": seed, "subjects": subjects})


def synthesize_shapes(folder: Path, progress: Progress = lambda done: None) -> None:
    """Write the canonical shapes as PLY files, and a manifest."""
    names = {shape: f"{shape}.ply" for shape in SHAPES}
    with output_folder(folder, [*names.values(), MANIFEST]):
        for number, (shape, name) in enumerate(names.items()):
            write_ply(folder / name, mesh_of(SHAPES[shape]()))
            progress((number + 1) / len(names))
        write_manifest(folder, {"kind": "shapes", "files": list(names.values())})


def synthesize_environments(
    folder: Path, size: int, progress: Progress = lambda done: None
) -> None:
    """Write the procedural environments as lat-long maps, and a manifest with coefficients.

    Parameters
    ----------
    folder
        Made if missing; a folder that holds other files is refused.
    size
        Columns of the maps, even.
    progress
        Told how much is done.
    """
    if integer("size", size, 8) % 2:
        raise ArgumentError(f"size must be even, as a lat-long map is 2 x 1, got {size}")
    names = {environment: f"{environment}.hdr" for environment in ENVIRONMENTS}
    entries = []
    with output_folder(folder, [*names.values(), MANIFEST]):
        for number, (environment, name) in enumerate(names.items()):
            made = ENVIRONMENTS[environment]()
            write_environment_map(folder / name, rasterise(made, size // 2).astype(np.float32))
            entries.append({"file": name, "coefficients": environment_light(made).tolist()})
            progress((number + 1) / len(names))
        write_manifest(folder, {"kind": "environments", "environments": entries})


def environment_light(environment: Environment) -> np.ndarray:
    """Return the exact lighting coefficients of a procedural environment to degree 4, (3, 25)."""
    directions, solid_angles = quadrature(environment)
    radiance = environment.radiance(directions).T * solid_angles
    return radiance @ real_harmonics(directions, COEFFICIENT_DEGREE).T


def procedural_lights() -> dict[str, np.ndarray]:
    """Return the lighting coefficients of every procedural environment, by name."""
    return {
        name.replace("_", " "): environment_light(made()) for name, made in ENVIRONMENTS.items()
    }


def write_manifest(folder: Path, content: Mapping[str, Any]) -> None:
    """Write what a folder holds, readable without the package."""
    text = json.dumps(
        {"format": "harmface", "version": 1, "colours": "linear RGB, 8 bits", **content}, indent=1
    )
    with atomic_write(folder / MANIFEST) as file:
        file.write(text.encode() + b"\n")
