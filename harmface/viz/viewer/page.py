"""One page that shows an object under light that turns: a file, or a notebook's cell.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import light_direction
from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh
from harmface.io.atomic import atomic_write
from harmface.light import PUBLISHED_PROBES, EnvironmentMap, published_probe
from harmface.sphere import real_harmonics
from harmface.viz.viewer.scene import (
    LIGHT_DEGREE,
    colour_arrays,
    light_entry,
    map_texture,
    optics,
    packed,
    surface_arrays,
    transfer_arrays,
)

LAMP = (40.0, 20.0)
"""Where the lamp among the lights stands: degrees right of and above the viewing axis."""

FRAME_HEIGHT = 640
"""Pixels that the page takes of a notebook, from top to bottom."""

_SCRIPTS = ("harmonics.js", "renderer.js", "page.js", "controls.js")
_SHADERS = {
    "header": "fragment_header.glsl",
    "surfaceVertex": "surface.vert.glsl",
    "surfaceFragment": "surface.frag.glsl",
    "surroundingsVertex": "surroundings.vert.glsl",
    "surroundingsFragment": "surroundings.frag.glsl",
}


@dataclass(frozen=True, eq=False)
class Viewer:
    """A page with everything in it: no other file, no network, no server.

    Parameters
    ----------
    title
        What it shows.
    vertices
        How many vertices that has.
    html
        The page.
    """

    title: str
    vertices: int
    html: str

    def __repr__(self) -> str:
        size = len(self.html) / 1e6
        return f"Viewer({self.title!r}, {self.vertices} vertices, {size:.1f} MB)"

    def _repr_html_(self) -> str:
        """Return the page in a frame, as notebooks show it."""
        return (
            f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{FRAME_HEIGHT}" '
            'style="border: 0" allow="clipboard-write"></iframe>'
        )

    def write(self, path: Path | str) -> None:
        """Write the page, whole or not at all.

        Parameters
        ----------
        path
            The file to make or replace, `.html`.

        Raises
        ------
        FileError
            If the name has another ending or cannot be written.
        """
        if Path(path).suffix.lower() not in (".html", ".htm"):
            raise FileError(f"{path}: pages are written as HTML; give a name that ends in .html")
        with atomic_write(path) as file:
            file.write(self.html.encode())


def viewer(
    mesh: Mesh,
    light: EnvironmentMap | Float[np.ndarray, "*channels K"] | None = None,
    *,
    title: str = "object",
    light_name: str = "light",
    presets: Mapping[str, Float[np.ndarray, "..."]] | None = None,
    transfer: Float[np.ndarray, "*transferred J V"] | None = None,
    reference: Float[np.ndarray, "*found V"] | None = None,
    colours: Mapping[str, Float[np.ndarray, "V 3"]] | None = None,
    flat: bool = False,
) -> Viewer:
    """Return a page that shows a mesh under light that turns with the mouse, [RH01]_ 3.2.

    Irradiance is `E(n) = (n, 1)^T M (n, 1)`, [RH01]_ eq. 11, in every fragment. Light and object
    turn apart, sliders move the nine coefficients, and the light's numbers can be copied.

    Parameters
    ----------
    mesh
        The object: x right, y up, z towards the viewer, as everywhere. Its albedo is that of its
        vertices.
    light
        A map, which is shown behind the object too, or coefficients; Grace Cathedral if not
        given. Those of [RH01]_ and a lamp can always be chosen.
    title
        Heading of the page; any text.
    light_name
        What the light is called in the page.
    presets
        More lights, by name.
    transfer
        What a unit of each lighting coefficient adds to the irradiance of each vertex, of one
        channel or three, used up to degree 4: shadows and bounces under light that turns.
    reference
        Irradiance of every vertex under `light` found otherwise, `(V,)` or `(3, V)`, such as by
        brute force: what nine coefficients leave out can be shown.
    colours
        Colours of every vertex in [0, 1], encoded for the screen, by what they show.
    flat
        The mesh is a picture with transfer vectors in place of normals: only the light turns.

    Returns
    -------
    Viewer
        Notebooks show it as it is; `write` makes a file.

    Raises
    ------
    ArgumentError
        If the mesh has too many vertices, or an argument has another shape or range.

    Examples
    --------
    >>> from data_synth.shapes import sphere
    >>> ball = sphere(16)
    >>> viewer(Mesh(ball.vertices, ball.faces, ball.normals, ball.albedo), title="ball")
    Viewer('ball', 559 vertices, 0.1 MB)
    """
    count = len(mesh.vertices)
    if flat and transfer is None:
        raise ArgumentError("transfer must be given for a flat picture, got none")
    if reference is not None and light is None:
        raise ArgumentError("light must be given with a reference, which holds for it alone")
    lights = [] if light is None else [light_entry(light_name, light)]
    lamp = real_harmonics(light_direction(*LAMP), LIGHT_DEGREE)
    others = {
        **{name: published_probe(name) for name in PUBLISHED_PROBES},
        "lamp": lamp,
        **(presets or {}),
    }
    lights += [light_entry(name, own) for name, own in others.items()]
    scene: dict[str, Any] = {
        **surface_arrays(mesh),
        **optics(),
        "lights": lights,
        "colours": colour_arrays(colours or {}, count),
        "flat": flat,
        "shaders": {name: _template(file) for name, file in _SHADERS.items()},
    }
    if isinstance(light, EnvironmentMap):
        scene["map"] = map_texture(light)
    if transfer is not None:
        scene["transfer"] = transfer_arrays(transfer, count)
    if reference is not None:
        scene["reference"] = packed(_reference(reference, count).T, "<f4")
        lights[0]["reference"] = True
    return Viewer(title, count, _page(title, scene))


def _reference(reference: Float[np.ndarray, "*channels V"], count: int) -> Float[np.ndarray, "3 V"]:
    """Return irradiance of every vertex in three channels."""
    reference = np.atleast_2d(checks.finite("reference", reference))
    if reference.shape not in ((1, count), (3, count)):
        raise ArgumentError(
            f"reference must have shape ({count},) or (3, {count}), got {reference.shape}"
        )
    return np.broadcast_to(reference, (3, count))


def _page(title: str, scene: Mapping[str, Any]) -> str:
    """Return the template, filled; nothing in a title or a name can become a tag."""
    parts = {
        "title": escape(title),
        "style": _template("viewer.css"),
        # In JSON a < can stand in texts only, and there it may be written so.
        "scene": json.dumps(scene, separators=(",", ":")).replace("<", "\\u003c"),
        "script": "\n".join(map(_template, _SCRIPTS)),
    }
    return re.sub(r"@(\w+)@", lambda found: parts[found[1]], _template("viewer.html"))


def _template(name: str) -> str:
    return (files("harmface.viz.viewer") / name).read_text(encoding="utf-8")
