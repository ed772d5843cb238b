"""What is painted on a wall: panes in a grid, glows, pointed windows; all with soft edges.

Coordinates (s, t) are metres on the wall. Every edge is soft over a small width, so that maps
and quadrature converge on it; `breaks` says where panels of a quadrature rule should end.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np


class Layer(Protocol):
    """Something that changes the radiance of a wall."""

    def paint(self, under: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Return the radiance (N, 3) at points s, t (N,) given that of the layers under it."""

    def breaks(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the values of s and of t where the layer is not smooth, or changes fast.

        The layer ends at the outermost of them.
        """


@dataclass(frozen=True)
class Panes:
    """A grid of equal rectangles, each of one colour: windows, lamps, pictures, planks.

    Attributes
    ----------
    s, t : (first, pitch)
        Lower edge of the first pane and distance to the next.
    size : (width, height)
        At most the pitch.
    colours : (rows, columns, 3)
        Radiance; rows run along t, columns along s.
    edge : float
        Width of the soft edge, inside the pane.
    """

    s: tuple[float, float]
    t: tuple[float, float]
    size: tuple[float, float]
    colours: np.ndarray
    edge: float = 0.03

    def paint(self, under: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Blend the pane's colour over what is under it."""
        rows, columns = self.colours.shape[:2]
        column, cover_s = _pane(s, self.s, self.size[0], columns, self.edge)
        row, cover_t = _pane(t, self.t, self.size[1], rows, self.edge)
        cover = (cover_s * cover_t)[:, None]
        painted: np.ndarray = under + cover * (self.colours[row, column] - under)
        return painted

    def breaks(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the inner and outer borders of all soft edges."""
        rows, columns = self.colours.shape[:2]
        return (
            _pane_breaks(self.s, self.size[0], columns, self.edge),
            _pane_breaks(self.t, self.size[1], rows, self.edge),
        )


@dataclass(frozen=True)
class Glow:
    """A Gaussian spot of added radiance: a lamp, or the light that one throws on a wall."""

    centre: tuple[float, float]
    sigma: tuple[float, float]
    colour: tuple[float, float, float]

    def paint(self, under: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Add the glow to what is under it."""
        distance = ((s - self.centre[0]) / self.sigma[0]) ** 2
        distance += ((t - self.centre[1]) / self.sigma[1]) ** 2
        painted: np.ndarray = under + np.exp(-distance / 2.0)[:, None] * np.array(self.colour)
        return painted

    def breaks(self) -> tuple[np.ndarray, np.ndarray]:
        """Return steps of two deviations, out to six."""
        steps = 2.0 * np.arange(-3, 4)
        return (
            self.centre[0] + self.sigma[0] * steps,
            self.centre[1] + self.sigma[1] * steps,
        )


@dataclass(frozen=True)
class Lancet:
    """A window with a pointed arch, its glass a smooth mixture of two colours in two tones.

    Attributes
    ----------
    centre : float
        Of the window along s.
    sill, spring : float
        Heights t of its lower edge and of the foot of its arch.
    half_width : float
        The arch is of two circles of radius `2 half_width`, each about the other's foot.
    colours : (2, 3)
    tones : float
        Panes of glass across the half width.
    edge : float
        Scale of the logistic profile of the soft border.
    """

    centre: float
    sill: float
    spring: float
    half_width: float
    colours: np.ndarray
    tones: float = 3.0
    edge: float = 0.05

    def paint(self, under: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Blend the glass over the wall, brightest at its middle."""
        across, up = np.abs(s - self.centre), t - self.spring
        arch = np.hypot(across + self.half_width, np.maximum(up, 0.0)) - 2.0 * self.half_width
        outside = np.maximum(arch, self.sill - t) / self.edge
        cover = 1.0 / (1.0 + np.exp(np.clip(outside, -40.0, 40.0)))
        wave = np.pi * self.tones / self.half_width
        mix = 0.5 + 0.25 * np.cos(wave * (s - self.centre)) + 0.25 * np.cos(wave * 0.7 * up)
        glass = self.colours[0] + mix[:, None] * (self.colours[1] - self.colours[0])
        painted: np.ndarray = under + cover[:, None] * (glass - under)
        return painted

    def breaks(self) -> tuple[np.ndarray, np.ndarray]:
        """Return a mesh over the window and its soft border, in steps of four scales."""
        top = self.spring + np.sqrt(3.0) * self.half_width
        margin = 12.0 * self.edge
        across = self._mesh(0.0, self.half_width + margin)
        return (
            np.concatenate([self.centre - across, self.centre + across]),
            np.concatenate(
                [
                    self._mesh(self.sill - margin, self.sill + margin),
                    self._mesh(self.sill + margin, self.spring),
                    self._mesh(self.spring, top + margin),
                ]
            ),
        )

    def _mesh(self, start: float, stop: float) -> np.ndarray:
        return np.linspace(start, stop, 1 + int(np.ceil((stop - start) / (4.0 * self.edge))))


def _smoothstep(fraction: np.ndarray) -> np.ndarray:
    fraction = np.clip(fraction, 0.0, 1.0)
    return fraction**2 * (3.0 - 2.0 * fraction)


def _pane(
    x: np.ndarray, place: tuple[float, float], size: float, count: int, edge: float
) -> tuple[np.ndarray, np.ndarray]:
    """Index of the nearest pane along one axis, and how far it covers each point."""
    first, pitch = place
    index = np.clip(np.floor((x - first + (pitch - size) / 2) / pitch), 0, count - 1).astype(int)
    inside = size / 2 - np.abs(x - first - pitch * index - size / 2)
    return index, _smoothstep(inside / edge)


def _pane_breaks(place: tuple[float, float], size: float, count: int, edge: float) -> np.ndarray:
    first, pitch = place
    starts = first + pitch * np.arange(count)[:, None]
    breaks: np.ndarray = starts + np.array([0.0, edge, size / 2, size - edge, size])
    return breaks.ravel()
