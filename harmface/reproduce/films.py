"""Films of turning heads by the oracle, with the true surface and poses."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.camera_noise import photograph
from data_synth.faces import head
from harmface import checks
from harmface.conventions import luminance
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, OrthographicCamera, gbuffer
from harmface.geometry.camera import frame_box
from harmface.io import output_folder, write_image, write_npz, write_ply, write_poses
from harmface.light import DistantLight, EnvironmentMap
from harmface.moving import Views, views_from_poses
from harmface.rendering import render
from harmface.reproduce.synthetic import Progress, mesh_of, write_manifest

DIRECTIONS = 192
SUPERSAMPLING = 2
BRIGHTEST = 0.9
"""Where the exposure puts the brightest hundredth of the head; eyes and teeth may be clipped."""

PLAIN = 0.6
"""Albedo of a head without texture."""

_TURN = re.compile(r"(yaw|pitch):(-?\d+(?:\.\d+)?):(-?\d+(?:\.\d+)?)")


@dataclass(frozen=True, eq=False)
class Film:
    """A rendered film.

    Parameters
    ----------
    frames
        Linear grey in [0, 1].
    masks
        Pixels of the head.
    views
        How it stands in each.
    mesh
        The true surface, in the pose of no rotation.
    camera
        That all frames are seen by.
    """

    frames: np.ndarray
    masks: np.ndarray
    views: Views
    mesh: Mesh
    camera: OrthographicCamera


def turns(text: str, frames: int) -> np.ndarray:
    """Return the rotations of a head that turns to and fro and nods twice as often.

    Parameters
    ----------
    text
        Such as "yaw:-30:30,pitch:-10:10", degrees; an axis that is not named stays at 0.
    frames
        Number of rotations.

    Returns
    -------
    numpy.ndarray
        (frames, 3, 3): a turn about the vertical of the head, then a nod.

    Raises
    ------
    ArgumentError
        If the text says anything else.
    """
    ranges = {"yaw": (0.0, 0.0), "pitch": (0.0, 0.0)}
    for part in text.split(","):
        found = _TURN.fullmatch(part.strip())
        if not found:
            raise ArgumentError(f"turn must be such as yaw:-30:30,pitch:-10:10, got {text!r}")
        ranges[found[1]] = (float(found[2]), float(found[3]))
    phase = 2 * np.pi * np.arange(frames) / frames
    angles = [
        (low + high) / 2 + (high - low) / 2 * np.sin(rate * phase + start)
        for (low, high), rate, start in zip(ranges.values(), (1, 2), (0, np.pi / 4), strict=True)
    ]
    return Rotation.from_euler("yx", np.stack(angles, axis=1), degrees=True).as_matrix()


def rendered_film(
    mesh: Mesh,
    rotations: np.ndarray,
    light: DistantLight,
    size: int,
    *,
    noise: float,
    rng: np.random.Generator | int,
    progress: Progress = lambda done: None,
) -> Film:
    """Render a film by the oracle: fixed camera and light, cast shadows, one exposure.

    Parameters
    ----------
    mesh
        The head.
    rotations
        One a frame.
    light
        Grey, in the camera's frame.
    size
        Rows and columns.
    noise
        Standard deviation of a white pixel's noise, as a share of white; 0 for none.
    rng
        For the noise.
    progress
        Told how much is done.

    Returns
    -------
    Film
        Frames and truth.
    """
    turned = [mesh.rotated(rotation) for rotation in rotations]
    bounds = np.array([each.bounds for each in turned])
    box = np.stack([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])
    camera = frame_box(box, (size, size))
    frames, masks = [], []
    for number, each in enumerate(turned):
        view = gbuffer(each, camera, SUPERSAMPLING)
        frames.append(render(view, light, caster=each))
        masks.append(view.mask)
        progress((number + 1) / len(turned))
    film = np.array(frames)
    film *= BRIGHTEST / np.percentile(film[np.array(masks)], 99)
    if noise > 0:
        film = photograph(film, rng=rng, full_well=noise**-2)
    scale = size / camera.height
    place = size / 2 + scale * np.array([-camera.center[0], camera.center[1]])
    views = views_from_poses(rotations, np.tile(place, (len(film), 1)), np.full(len(film), scale))
    return Film(film, np.array(masks), views, mesh, camera)


def film_light(environment: EnvironmentMap) -> DistantLight:
    """Return the grey light of a map, gathered into few directions."""
    light = environment.as_distant_light(DIRECTIONS)
    grey = light.irradiances
    if grey.ndim == 2:
        grey = luminance(np.moveaxis(grey, 0, -1))
    return DistantLight(light.directions, grey)


def film_head(seed: int, *, plain: bool = False) -> Mesh:
    """Return a head to be filmed; a plain one has one albedo everywhere."""
    mesh = mesh_of(head(seed))
    if not plain:
        return mesh
    return Mesh(mesh.vertices, mesh.faces, mesh.normals, np.full_like(mesh.albedo, PLAIN))


def synthesize_film(
    folder: Path,
    environment: EnvironmentMap,
    *,
    seed: int = 0,
    frames: int = 60,
    turn: str = "yaw:-30:30,pitch:-10:10",
    size: int = 160,
    noise: float = 0.01,
    plain: bool = False,
    progress: Progress = lambda done: None,
) -> None:
    """Write a film of a turning head, its masks and poses, and the true surface.

    Parameters
    ----------
    folder
        Made if missing; a folder that holds other files is refused.
    environment
        Light, in the camera's frame.
    seed
        Of the head and the noise.
    frames
        How many.
    turn
        See `turns`.
    size
        Rows and columns.
    noise
        Of a white pixel, as a share of white.
    plain
        Whether the head has one albedo everywhere.
    progress
        Told how much is done.

    Raises
    ------
    ArgumentError
        If a number is out of range or `turn` cannot be read.
    FileError
        If the folder holds other files.
    """
    seed, frames = checks.integer("seed", seed, 0), checks.integer("frames", frames, 2)
    size = checks.integer("size", size, 16)
    if not 0 <= noise <= 0.5:
        raise ArgumentError(f"noise must lie in [0, 0.5], got {noise}")
    rotations = turns(turn, frames)
    names = [f"frame_{number:03d}.png" for number in range(frames)]
    with output_folder(folder, [*names, "masks", "truth", "poses.csv", "manifest.json"]):
        film = rendered_film(
            film_head(seed, plain=plain),
            rotations,
            film_light(environment),
            size,
            noise=noise,
            rng=np.random.default_rng([seed, 2]),
            progress=progress,
        )
        with output_folder(folder / "masks", names):
            for name, frame, mask in zip(names, film.frames, film.masks, strict=True):
                write_image(folder / name, frame)
                write_image(folder / "masks" / name, mask.astype(float), bits=8)
        with output_folder(folder / "truth", ["mesh.ply", "frontal.npz"]):
            write_ply(folder / "truth" / "mesh.ply", film.mesh)
            view = gbuffer(film.mesh, film.camera, SUPERSAMPLING)
            arrays = {name: getattr(view, name) for name in ("normals", "position", "mask")}
            arrays["albedo"] = luminance(view.albedo)
            write_npz(folder / "truth" / "frontal.npz", "gbuffer", 1, arrays)
        write_poses(folder / "poses.csv", film.views, names)
        about = {"kind": "film", "seed": seed, "turn": turn, "noise": noise, "plain": plain}
        write_manifest(folder, {**about, "frames": names})
