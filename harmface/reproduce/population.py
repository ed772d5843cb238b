"""Procedural people under many lights, for what is learned of faces as a class."""

import os
from pathlib import Path

import numpy as np

from data_synth.camera_noise import photograph
from data_synth.faces import head
from harmface.errors import FileError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_npz, write_npz
from harmface.light import DistantLight
from harmface.recognition.gallery import Photographs
from harmface.rendering import box_average, render
from harmface.reproduce.synthetic import Progress, mesh_of, subject_seed
from harmface.sphere import fibonacci_directions

PEOPLE, SIZE, SEED = 24, 112, 78
LIGHTS = 40
"""Directions over the whole sphere; those before the face are used, and one from the front."""

KIND, VERSION = "procedural people", 1


def procedural_people(progress: Progress = lambda done: None) -> Photographs:
    """Return photographs of procedural heads, rendered once and then kept.

    They are kept in the user's folder for such things, `$XDG_CACHE_HOME/harmface` or
    `~/.cache/harmface`; where that cannot be written they are rendered every time.

    Parameters
    ----------
    progress
        Told how much is done.
    """
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    path = Path(home) / "harmface" / f"people-{VERSION}.npz"
    try:
        arrays, _ = read_npz(path, KIND, VERSION)
        return Photographs(arrays["subjects"], arrays["images"] / np.float32(255))
    except (FileError, KeyError):
        pass  # not there yet, or damaged: it is made again
    codes = np.concatenate([_codes(number, progress) for number in range(PEOPLE)])
    subjects = np.repeat(np.arange(PEOPLE), len(codes) // PEOPLE)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_npz(path, KIND, VERSION, {"subjects": subjects, "images": codes})
    except (FileError, OSError):
        pass  # a folder that cannot be written costs time only
    return Photographs(subjects, codes / np.float32(255))


def _codes(number: int, progress: Progress) -> np.ndarray:
    """Return 8-bit photographs of one head, of one exposure, the first from the front."""
    directions = fibonacci_directions(LIGHTS)
    directions = np.concatenate([[[0.0, 0.0, 1.0]], directions[directions[:, 2] > 0]])
    mesh = mesh_of(head(subject_seed(SEED, number)))
    view = gbuffer(mesh, frame_orthographic(mesh, 2 * SIZE))
    lamps = DistantLight(directions, np.eye(len(directions)))
    images = box_average(render(view, lamps, caster=mesh), 2)
    frontal = images[0][images[0] > 0]
    images = images / np.percentile(frontal, 95)
    taken = photograph(images, rng=np.random.default_rng([SEED, number]), exposure=0.8, bits=8)
    progress((number + 1) / PEOPLE)
    return np.rint(255 * taken).astype(np.uint8)
