"""Every command that writes, on small input."""

from pathlib import Path

import numpy as np
from PIL import Image

COMMANDS = {
    "synth faces": "synth faces --count 2 --seed 3 --out out",
    "synth shapes": "synth shapes --out out",
    "synth environments": "synth environments --size 16 --out out",
    "synth dataset": "synth dataset --identities 2 --lightings ninepoints --size 12 --out out",
    "basis": "basis ball.ply --size 16 --out b.npz --figure b.png",
    "render": "render ball.ply --light 40,20 --size 16 --out r.png",
    "light": "light photographs/00.png --mesh ball.ply --out l.json --figure l.png",
    "light convert": "light convert nine.json --from harmface --to deca --out d.npy",
    "relight": "relight photographs/00.png --mesh ball.ply --light 40,20 --out r.png",
    "view": "view ball.ply --environment sky.hdr --reference --out v.html",
    "transfer": "transfer ball.ply --degree 1 --samples 128 --out t.npz",
    "synth scene": "synth scene --out s.toml",
    "nearlight": "nearlight ball.ply --scene scene.toml --size 16 --figure f.png --out n.png",
    "align": "align people --points eyes.csv --size 8x7 --out out",
    "enroll meshes": "enroll ball.ply --size 16 --out g.npz",
    "enroll photographs": "enroll people --method nearest --out g.npz",
    "enroll store": "enroll people --method subspace --out g.zarr",
    "envmap project": "envmap project skies --out out",
    "recognize": "recognize people.npz people/a/0.png --figure why.png",
    "pca": "pca ball.ply --size 16 --figure modes.png",
    "envmap irradiance": "envmap irradiance sky.hdr --size 8 --out i.hdr",
    "envmap convert": "envmap convert sky.hdr --to cube --size 4 --out c.exr",
    "envmap rotate": "envmap rotate sky.hdr --azimuth 30 --out r.pfm",
    "envmap show": "envmap show sky.hdr --out s.png",
    "evaluate": "evaluate people --gallery first:2 --methods nearest,correlation --out out",
    "stereo": "stereo photographs --method 4d --mesh-format obj --out out",
    "reproduce": "reproduce --only energy-by-degree worst-pixel-error --out out",
}

UNREPEATABLE = ("times.json",)
"""Files of what differs from run to run."""


def prepare(folder: Path) -> None:
    """Make the input of all commands."""
    from harmface.geometry import Mesh
    from harmface.io import (
        write_coefficients,
        write_environment_map,
        write_gallery,
        write_ply,
    )
    from harmface.recognition import Gallery, Photographs, SubjectClassifier

    rng = np.random.default_rng(0)
    write_environment_map(folder / "sky.hdr", rng.random((8, 16, 3), np.float32))
    (folder / "skies").mkdir()
    for name in "ab":
        write_environment_map(folder / "skies" / f"{name}.hdr", rng.random((8, 16, 3), np.float32))
    write_coefficients(folder / "nine.json", np.eye(3, 9) + np.eye(1, 9))
    # A fan of triangles over a disc, bent to half a ball.
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rings = [np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1) for r in (0.3, 0.6, 0.9)]
    plane = np.concatenate([np.zeros((1, 2)), *rings])
    normals = np.column_stack([plane, np.sqrt(1 - (plane**2).sum(axis=1))])
    faces = [(0, 1 + k, 1 + (k + 1) % 24) for k in range(24)]
    for ring in (0, 24):
        for k in range(24):
            a, b = 1 + ring + k, 1 + ring + (k + 1) % 24
            faces += [(a, a + 24, b), (b, a + 24, b + 24)]
    ball = Mesh(normals, np.array(faces), normals, np.full(normals.shape, 0.5))
    write_ply(folder / "ball.ply", ball)
    (folder / "scene.toml").write_text("[[point]]\nposition = [0, 1, 3]\nintensity = 5\n")
    own = rng.random((3, 1, 12, 10))
    people = 0.7 * own + 0.3 * rng.random((3, 5, 12, 10))
    for name, stack in zip("abc", people, strict=True):
        (folder / "people" / name).mkdir(parents=True)
        for number, image in enumerate(stack):
            _save(folder / "people" / name / f"{number}.png", image)
    eyes = [f"{name}/{number}.png,2,4,8,4\n" for name in "abc" for number in range(5)]
    (folder / "eyes.csv").write_text("".join(eyes))
    photographs = Photographs(np.repeat(list("abc"), 5), people.reshape(15, 12, 10))
    gallery = Gallery(photographs, photographs.everywhere)
    write_gallery(folder / "people.npz", SubjectClassifier.from_gallery(gallery, "nearest"))
    _photographs(folder / "photographs")


def _photographs(folder: Path) -> None:
    """Write photographs of a ball under twelve lights."""
    folder.mkdir()
    y, x = np.mgrid[1:-1:24j, -1:1:24j]
    inside = x**2 + y**2 < 0.9
    normals = np.stack([x, y, np.sqrt(np.where(inside, 1 - x**2 - y**2, 1))], axis=-1)
    turns = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    tilts = np.tile([0.3, 0.7], 6)
    lights = np.stack(
        [np.sin(tilts) * np.cos(turns), np.sin(tilts) * np.sin(turns), np.cos(tilts)], axis=1
    )
    for number, light in enumerate(lights):
        _save(folder / f"{number:02d}.png", np.maximum(normals @ light, 0) * inside * 0.9)
    _save(folder / "mask.png", inside.astype(float))


def _save(path: Path, image: np.ndarray) -> None:
    Image.fromarray((255 * image).astype(np.uint8)).save(path)
