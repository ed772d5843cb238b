"""Shapes turned about an axis: cylinder, cone, half-sphere, torus, vase."""

from typing import NamedTuple

import numpy as np

from data_synth.shapes.shape import (
    Patch,
    Shape,
    assemble,
    full_turn,
    grid_patch,
    require_positive,
    require_resolution,
)


class _Section(NamedTuple):
    """A smooth piece of profile, with the outside on its right: radius, height, unit normal."""

    radius: np.ndarray
    height: np.ndarray
    normal_radius: np.ndarray
    normal_height: np.ndarray


def cylinder(resolution: int = 64, radius: float = 0.55, height: float = 1.6) -> Shape:
    """Build a cylinder about the y axis, closed by two discs.

    Parameters
    ----------
    resolution : int
        Rows of faces along the side, at least 8; twice as many go around.
    radius, height : float
    """
    require_resolution(resolution)
    require_positive("radius and height", radius, height)
    half = height / 2
    base = _line((0.0, -half), (radius, -half), resolution // 4)
    side = _line((radius, -half), (radius, half), resolution)
    top = _line((radius, half), (0.0, half), resolution // 4)
    return assemble("cylinder", *_revolve([base, side, top], 2 * resolution))


def cone(resolution: int = 64, radius: float = 0.75, height: float = 1.6) -> Shape:
    """Build a cone about the y axis, its apex up, closed by a disc.

    A cone has no normal at its apex: each triangle there takes that of its own middle line.
    """
    require_resolution(resolution)
    require_positive("radius and height", radius, height)
    half = height / 2
    base = _line((0.0, -half), (radius, -half), resolution // 4)
    side = _line((radius, -half), (0.0, half), resolution)
    return assemble("cone", *_revolve([base, side], 2 * resolution))


def half_sphere(resolution: int = 64, radius: float = 1.0) -> Shape:
    """Build the half of a sphere that faces the viewer, z >= 0, open at its rim."""
    require_resolution(resolution)
    require_positive("radius", radius)
    arc = _arc((0.0, 0.0), radius, 0.0, np.pi / 2, resolution)
    arc.radius[-1] = 0.0
    return assemble("half_sphere", *map(_face_viewer, _revolve([arc], 2 * resolution)))


def torus(resolution: int = 64, radius: float = 0.68, tube: float = 0.3) -> Shape:
    """Build a torus with its hole towards the viewer.

    Parameters
    ----------
    resolution : int
        Rows of faces around the tube; twice as many go around the hole.
    radius, tube : float
        Of the circle in the middle of the tube, and of the tube, which is the smaller.
    """
    require_resolution(resolution)
    require_positive("radius and tube", radius, tube)
    if tube >= radius:
        raise ValueError(
            f"tube must be smaller than radius = {radius}, got {tube}: else the hole closes"
        )
    circle = _arc((radius, 0.0), tube, -np.pi, np.pi, resolution)
    return assemble("torus", *map(_face_viewer, _revolve([circle], 2 * resolution)))


def vase(resolution: int = 64, height: float = 1.8, wall: float = 0.06) -> Shape:
    """Build a hollow vase about the y axis: foot, belly, neck, rounded lip, open at the top.

    Its outer radius is a cosine series in the height, level at both ends, so that the lip, a
    half circle between the outer and the inner wall, joins both smoothly.

    Parameters
    ----------
    resolution : int
    height : float
    wall : float
        Thickness, in (0, 0.2].
    """
    require_resolution(resolution)
    require_positive("height", height)
    if not 0 < wall <= 0.2:
        raise ValueError(f"wall must be in (0, 0.2], got {wall}: else the neck closes")
    # Coefficients of cos(k pi s), s from foot to rim.
    series = np.array([0.46, 0.08, -0.1, -0.12])
    order = np.pi * np.arange(4)

    def wall_section(fractions: np.ndarray, inset: float, side: int) -> _Section:
        radius = np.cos(np.outer(fractions, order)) @ series - inset
        slope = -np.sin(np.outer(fractions, order)) @ (order * series) / height
        length = side * np.hypot(1.0, slope)
        return _Section(radius, height * (fractions - 0.5), 1.0 / length, -slope / length)

    outer = wall_section(np.linspace(0.0, 1.0, resolution + 1), 0.0, 1)
    inner = wall_section(np.linspace(1.0, wall / height, resolution + 1), wall, -1)
    lip = _arc(
        (outer.radius[-1] - wall / 2, outer.height[-1]), wall / 2, 0.0, np.pi, resolution // 4
    )
    foot = _line((0.0, outer.height[0]), (outer.radius[0], outer.height[0]), resolution // 4)
    floor = _line((inner.radius[-1], inner.height[-1]), (0.0, inner.height[-1]), resolution // 4)
    return assemble("vase", *_revolve([foot, outer, lip, inner, floor], 2 * resolution))


def _line(start: tuple[float, float], end: tuple[float, float], steps: int) -> _Section:
    radius, height = np.linspace(start, end, steps + 1).T
    along = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
    return _Section(radius, height, np.full(steps + 1, along[1]), np.full(steps + 1, -along[0]))


def _arc(
    centre: tuple[float, float], radius: float, start: float, stop: float, steps: int
) -> _Section:
    """Run an arc counter-clockwise in the plane of (radius, height), the outside around it."""
    angle = np.linspace(start, stop, steps + 1)
    cosine, sine = np.cos(angle), np.sin(angle)
    return _Section(centre[0] + radius * cosine, centre[1] + radius * sine, cosine, sine)


def _revolve(sections: list[_Section], columns: int) -> list[Patch]:
    """Turn a profile about the y axis; v runs along its length, u from +z by +x."""
    lengths = [
        np.concatenate([[0.0], np.hypot(np.diff(s.radius), np.diff(s.height)).cumsum()])
        for s in sections
    ]
    total = sum(length[-1] for length in lengths)
    starts = np.cumsum([0.0, *(length[-1] for length in lengths[:-1])])
    return [
        _turn(section, np.minimum((start + length) / total, 1.0), columns)
        for section, start, length in zip(sections, starts, lengths, strict=True)
    ]


def _turn(section: _Section, v: np.ndarray, columns: int) -> Patch:
    rows = len(section.radius)
    sine, cosine = (np.tile(wave, (rows, 1)) for wave in full_turn(columns))
    u = np.tile(np.linspace(0.0, 1.0, columns + 1), (rows, 1))
    points = _around(section.radius, section.height, sine, cosine)
    # A point on the axis belongs to one triangle a column: its u and normal are those of the
    # triangle's middle line, half a step after the first and before the last row's points.
    for row, half_step in ((0, 0.5), (-1, -0.5)):
        if section.radius[row] == 0.0:
            u[row] = np.clip(u[row] + half_step / columns, 0.0, 1.0)
            azimuth = 2.0 * np.pi * u[row]
            sine[row], cosine[row] = np.sin(azimuth), np.cos(azimuth)
    normals = _around(section.normal_radius, section.normal_height, sine, cosine)
    uvs = np.stack([u, np.broadcast_to(v[:, None], u.shape)], axis=-1)
    return grid_patch(points, normals, uvs)


def _around(
    radius: np.ndarray, height: np.ndarray, sine: np.ndarray, cosine: np.ndarray
) -> np.ndarray:
    tall = np.broadcast_to(height[:, None], sine.shape)
    return np.stack([radius[:, None] * sine, tall, radius[:, None] * cosine], axis=-1)


def _face_viewer(patch: Patch) -> Patch:
    """Turn the y axis to +z, the z axis to +x."""
    return patch._replace(
        vertices=np.roll(patch.vertices, 1, axis=1), normals=np.roll(patch.normals, 1, axis=1)
    )
