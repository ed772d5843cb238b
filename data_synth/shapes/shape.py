"""The shape itself, and how grids of surface points become one."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

UNTEXTURED_ALBEDO = 0.8
"""Albedo of a shape before a texture is put on it: a matt white paint."""


@dataclass(frozen=True)
class Shape:
    """A triangle mesh of about unit size, centred at the origin, y up, seen from +z.

    Attributes
    ----------
    name : str
    vertices : (V, 3) float64
        Doubled along texture seams and creases, where they differ in `uvs` or `normals`.
    faces : (F, 3) int32
        Counter-clockwise seen from outside; none is degenerate.
    normals : (V, 3) float64, unit
        Of the exact surface, outward.
    uvs : (V, 2) float64 in [0, 1]
    albedo : (V, 3) float64 in [0, 1]
        Linear RGB.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    albedo: np.ndarray


class Patch(NamedTuple):
    """A piece of surface: points, unit normals and texture coordinates with equal rows."""

    vertices: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray
    faces: np.ndarray


def grid_patch(points: np.ndarray, normals: np.ndarray, uvs: np.ndarray) -> Patch:
    """Triangulate a grid of surface points, (rows, columns, 3), outward = d(column) x d(row).

    Quads that a collapsed row or column has made triangles become one triangle.
    """
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
    c, d = index[1:, 1:].ravel(), index[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    vertices = points.reshape(-1, 3)
    corners = vertices[faces]
    collapsed = (corners == np.roll(corners, 1, axis=1)).all(axis=2).any(axis=1)
    return Patch(vertices, normals.reshape(-1, 3), uvs.reshape(-1, 2), faces[~collapsed])


def assemble(name: str, *patches: Patch) -> Shape:
    """Join patches into one shape of uniform albedo, leaving out points that no face uses."""
    starts = np.cumsum([0, *(len(patch.vertices) for patch in patches[:-1])])
    faces = np.concatenate(
        [patch.faces + start for patch, start in zip(patches, starts, strict=True)]
    )
    used, faces = np.unique(faces, return_inverse=True)
    vertices, normals, uvs = (
        np.concatenate([patch[field] for patch in patches])[used] for field in range(3)
    )
    albedo = np.full_like(vertices, UNTEXTURED_ALBEDO)
    return Shape(name, vertices, faces.reshape(-1, 3).astype(np.int32), normals, uvs, albedo)


def full_turn(steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Sine and cosine of `steps + 1` azimuths around a circle, the last exactly the first."""
    azimuth = 2.0 * np.pi * (np.arange(steps + 1) % steps) / steps
    return np.sin(azimuth), np.cos(azimuth)


def normalised(vectors: np.ndarray) -> np.ndarray:
    """Divide each vector by its norm."""
    units: np.ndarray = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return units


def require_resolution(resolution: int, least: int = 8) -> None:
    """Refuse a resolution too coarse to show the shape."""
    if resolution < least:
        raise ValueError(
            f"resolution must be at least {least}, got {resolution}: 64 is a usual value"
        )


def require_positive(name: str, *values: float) -> None:
    """Refuse lengths that are not finite and above zero."""
    if not all(np.isfinite(value) and value > 0 for value in values):
        raise ValueError(
            f"{name} must be finite and above 0, got {values}: shapes are of about unit size"
        )
