"""Scenes of lamps as TOML files."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, read_bytes
from harmface.io.meshes import read_mesh
from harmface.light import DiscLight, NearLight, PointLight, PolygonLight, SphereLight
from harmface.rendering import Scene, Surface

FRAMES = ("world", "object")

FARTHEST = 1e15
"""Lengths beyond it have squares that single precision does not hold."""

KEYS = {
    "polygon": ("vertices", "radiance"),
    "disc": ("center", "normal", "radius", "radiance"),
    "sphere": ("center", "radius", "radiance"),
    "point": ("position", "intensity"),
    "mesh": ("file", "radiance"),
}
"""What each kind of entry has, all of it needed."""


@dataclass(frozen=True)
class _Frame:
    """Where lengths of a file lie in the world."""

    origin: Float[np.ndarray, "3"]
    scale: float

    def point(self, values: Any) -> Float[np.ndarray, "*points 3"]:
        """Return places of a file in the world."""
        found = np.array(values, float)
        if found.shape[-1:] != (3,):
            raise ArgumentError(f"a place must have three coordinates, got shape {found.shape}")
        # Rays are cast in single precision, and areas are squares of lengths.
        if not (np.abs(found) < FARTHEST).all():
            raise ArgumentError(f"a place must lie within {FARTHEST:g} of the origin")
        return self.origin + self.scale * found


def read_scene(path: Path | str, mesh: Mesh) -> Scene:
    """Read the lamps and surfaces round a mesh.

    Entries are `[[polygon]]` (vertices, radiance), `[[disc]]` (center, normal, radius, radiance),
    `[[sphere]]` (center, radius, radiance), `[[point]]` (position, intensity) and `[[mesh]]` (file,
    radiance: zero for what only stands in the way). `frame = "object"` gives lengths in heights of
    the mesh's bounding box, from its middle; by default they are the mesh's own, "world".

    Parameters
    ----------
    path
        The file; meshes are found relative to its folder.
    mesh
        The object that the scene is round.

    Returns
    -------
    Scene
        In the mesh's coordinates, with three channels.

    Raises
    ------
    FileError
        If the file is missing, no TOML, has a key that is not known or lacks one, or a value is
        out of range.
    """
    path = Path(path)
    try:
        content = tomllib.loads(read_bytes(path, MAX_TEXT).decode())
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no TOML file ({excerpt(error)})") from None
    unknown = [key for key in content if key not in (*KEYS, "frame")]
    if unknown:
        raise FileError(
            f"{path}: has the unknown key {excerpt(unknown[0])}; there are frame, {', '.join(KEYS)}"
        )
    frame = content.get("frame", "world")
    if frame not in FRAMES:
        raise FileError(f"{path}: frame must be world or object, got {excerpt(frame)}")
    low, high = mesh.bounds
    lies = _Frame((low + high) / 2, float(high[1] - low[1]))
    if frame == "world":
        lies = _Frame(np.zeros(3), 1.0)
    lights: list[NearLight] = []
    surfaces: list[Surface] = []
    for kind, needed in KEYS.items():
        entries = content.get(kind, [])
        if not isinstance(entries, list):
            raise FileError(f"{path}: [{kind}] must be written [[{kind}]]: there may be several")
        for number, entry in enumerate(entries, 1):
            _check_keys(path, f"{kind} {number}", entry, needed)
            try:
                made = _made(kind, entry, lies, path.parent)
            except FileError:
                raise
            except PARSE_ERRORS as error:
                raise FileError(f"{path}: {kind} {number} is of no use: {excerpt(error)}") from None
            if isinstance(made, Surface):
                surfaces.append(made)
            else:
                lights.append(made)
    try:
        return Scene(tuple(lights), tuple(surfaces))
    except ArgumentError as error:
        raise FileError(f"{path}: {error}") from None


def _check_keys(path: Path, name: str, entry: Any, needed: tuple[str, ...]) -> None:
    if not isinstance(entry, dict):
        raise FileError(f"{path}: {name} must be a table with {', '.join(needed)}")
    for key in entry:
        if key not in needed:
            raise FileError(
                f"{path}: {name} has the unknown key {excerpt(key)}; it has {', '.join(needed)}"
            )
    for key in needed:
        if key not in entry:
            raise FileError(f"{path}: {name} lacks the key {key}")


def _made(kind: str, entry: dict[str, Any], frame: _Frame, folder: Path) -> NearLight | Surface:
    if kind == "point":
        intensity = _color("intensity", entry["intensity"]) * frame.scale**2
        return PointLight(frame.point(entry["position"]), intensity)
    radiance = _color("radiance", entry["radiance"])
    if kind == "polygon":
        return PolygonLight(frame.point(entry["vertices"]), radiance)
    if kind == "mesh":
        found = read_mesh(folder / entry["file"])
        return Surface(frame.point(found.vertices), found.faces, radiance)
    radius = frame.scale * float(entry["radius"])
    if kind == "sphere":
        return SphereLight(frame.point(entry["center"]), radius, radiance)
    normal = np.array(entry["normal"], float)
    if not (normal.any() and (np.abs(normal) < FARTHEST).all()):
        raise ArgumentError(f"normal must not be zero, and below {FARTHEST:g}")
    normal /= np.linalg.norm(normal)
    return DiscLight(frame.point(entry["center"]), normal, radius, radiance)


def _color(name: str, values: Any) -> Float[np.ndarray, "3"]:
    found = np.array(values, float)
    if found.shape not in ((), (3,)):
        raise ArgumentError(f"{name} must be one number, or red, green, blue, got {values!r}")
    if not (np.isfinite(found).all() and (found >= 0).all()):
        raise ArgumentError(f"{name} must be finite and not negative, got {values!r}")
    return np.broadcast_to(found, 3).copy()
