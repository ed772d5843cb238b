"""Procedural shapes with exact normals, texture coordinates and textured albedo."""

from collections.abc import Callable
from functools import partial

from data_synth.shapes.fields import height_field, hills, ripples
from data_synth.shapes.radial import bumpy_sphere, ellipsoid, sphere, superquadric
from data_synth.shapes.revolution import cone, cylinder, half_sphere, torus, vase
from data_synth.shapes.shape import Shape
from data_synth.shapes.textures import TEXTURES, textured

__all__ = [
    "SHAPES",
    "TEXTURES",
    "Shape",
    "bumpy_sphere",
    "cone",
    "cylinder",
    "ellipsoid",
    "half_sphere",
    "height_field",
    "hills",
    "ripples",
    "sphere",
    "superquadric",
    "textured",
    "torus",
    "vase",
]


def _showcase(build: Callable[[], Shape], texture: str) -> Shape:
    return textured(build(), texture)


SHAPES: dict[str, Callable[[], Shape]] = {
    "sphere": partial(_showcase, sphere, "checker"),
    "half_sphere": partial(_showcase, half_sphere, "spots"),
    "ellipsoid": partial(_showcase, ellipsoid, "noise"),
    "cylinder": partial(_showcase, cylinder, "checker"),
    "cone": partial(_showcase, cone, "noise"),
    "superquadric": partial(_showcase, superquadric, "spots"),
    "torus": partial(_showcase, torus, "checker"),
    "vase": partial(_showcase, vase, "noise"),
    "bumpy_sphere": partial(_showcase, bumpy_sphere, "spots"),
    "ripples": partial(_showcase, ripples, "checker"),
    "hills": partial(_showcase, hills, "noise"),
}
"""Every shape at its default size and resolution, textured."""
