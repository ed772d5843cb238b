"""The inside of a box, seen from a point within: walls, floor and ceiling of glowing paint."""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from data_synth.environments.environment import Environment, Rule
from data_synth.environments.layers import Layer
from data_synth.environments.rules import wall_rule


@dataclass(frozen=True)
class Wall:
    """A wall: its radiance, how much darker its edges are, and what is painted on it.

    Attributes
    ----------
    colour : (r, g, b)
        Radiance in the middle of the bare wall.
    layers : tuple of Layer
        From the lowest up.
    dusk : float
        Share of the radiance lost at an edge, in [0, 1).
    reach : float
        Distance from the edge over which the loss falls by e.
    """

    colour: tuple[float, float, float]
    layers: tuple[Layer, ...] = ()
    dusk: float = 0.3
    reach: float = 0.4


def box(
    name: str,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    walls: dict[str, Wall],
    nodes: int,
) -> Environment:
    """Build the environment inside a box around the origin.

    Parameters
    ----------
    name : str
    low, high : (x, y, z)
        Corners in metres, below and above zero.
    walls : dict
        A wall for each of "-x", "+x", "-y", "+y", "-z", "+z". On the walls across x, the
        coordinates (s, t) are (z, y), across y they are (x, z) and across z (x, y).
    nodes : int
        Of the quadrature rule in each panel.
    """
    if not all(a < 0 < b for a, b in zip(low, high, strict=True)):
        raise ValueError(
            f"low and high must enclose the origin, got {low} and {high}: the viewer is inside"
        )
    if set(walls) != set(_FACES):
        raise ValueError(
            f"walls must have the six keys {', '.join(_FACES)}, got {', '.join(walls) or 'none'}"
        )
    placed = [_PlacedWall(walls[key], low, high, *_FACES[key]) for key in _FACES]
    return Environment(name, partial(_radiance, placed), partial(_rule, placed), nodes)


# The axis across each wall, its side, and the axes of s and t.
_FACES = {
    "-x": (0, -1, 2, 1),
    "+x": (0, 1, 2, 1),
    "-y": (1, -1, 0, 2),
    "+y": (1, 1, 0, 2),
    "-z": (2, -1, 0, 1),
    "+z": (2, 1, 0, 1),
}


@dataclass(frozen=True)
class _PlacedWall:
    wall: Wall
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    axis: int
    side: int
    s_axis: int
    t_axis: int

    @property
    def distance(self) -> float:
        return abs(self.low[self.axis] if self.side < 0 else self.high[self.axis])

    def radiance(self, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        wall = self.wall
        light = np.ones_like(s)
        for x, axis in ((s, self.s_axis), (t, self.t_axis)):
            for edge in (x - self.low[axis], self.high[axis] - x):
                light *= 1.0 - wall.dusk * np.exp(-edge / wall.reach)
        painted: np.ndarray = light[:, None] * np.array(wall.colour)
        for layer, (s_low, s_high, t_low, t_high) in zip(wall.layers, self._extents, strict=True):
            at = np.flatnonzero((s >= s_low) & (s <= s_high) & (t >= t_low) & (t <= t_high))
            painted[at] = layer.paint(painted[at], s[at], t[at])
        return painted

    @cached_property
    def _extents(self) -> list[tuple[float, float, float, float]]:
        """Bounds along s and t of each layer: its outermost breaks."""
        return [
            (s.min(), s.max(), t.min(), t.max())
            for s, t in (layer.breaks() for layer in self.wall.layers)
        ]

    def rule(self, nodes: int) -> Rule:
        breaks = [self._breaks(axis) for axis in (self.s_axis, self.t_axis)]
        for layer in self.wall.layers:
            breaks = [np.concatenate(both) for both in zip(breaks, layer.breaks(), strict=True)]
        s_breaks, t_breaks = (
            np.clip(values, self.low[axis], self.high[axis])
            for values, axis in zip(breaks, (self.s_axis, self.t_axis), strict=True)
        )
        s, t, solid_angles = wall_rule(s_breaks, t_breaks, self.distance, nodes)
        points = np.empty((len(s), 3))
        points[:, self.axis] = self.side * self.distance
        points[:, self.s_axis], points[:, self.t_axis] = s, t
        return points / np.linalg.norm(points, axis=1, keepdims=True), solid_angles

    def _breaks(self, axis: int) -> np.ndarray:
        """Panels that grow with the distance from the viewer's foot point and from the edges."""
        low, high = self.low[axis], self.high[axis]
        reach = self.wall.reach * np.array([0.0, 2.0, 6.0])
        steps = self.distance * np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
        return np.concatenate([low + reach, high - reach, -steps, steps])


def _radiance(walls: list[_PlacedWall], directions: np.ndarray) -> np.ndarray:
    flat = directions.reshape(-1, 3)
    # How many times as far as a unit direction each of the three walls ahead lies; the nearest
    # is hit. Along a wall the distance is infinite, which is as it should be.
    limits = np.where(flat > 0, walls[0].high, walls[0].low)
    with np.errstate(divide="ignore"):
        distance = limits / np.where(flat == 0, 0.0, flat)
    distance[flat == 0] = np.inf
    axis = distance.argmin(axis=1)
    points = flat * np.take_along_axis(distance, axis[:, None], axis=1)
    result = np.empty((len(flat), 3))
    for wall in walls:
        hit = (axis == wall.axis) & (flat[:, wall.axis] * wall.side > 0)
        result[hit] = wall.radiance(points[hit, wall.s_axis], points[hit, wall.t_axis])
    return result.reshape(directions.shape)


def _rule(walls: list[_PlacedWall], nodes: int) -> Rule:
    rules = [wall.rule(nodes) for wall in walls]
    directions, solid_angles = (np.concatenate(part) for part in zip(*rules, strict=True))
    return directions, solid_angles
