"""A hill with a knob that differs from one subject to the next, and Lambert's images of it."""

from dataclasses import dataclass

import numpy as np
import pytest

ROWS, COLUMNS = 24, 20


@dataclass(frozen=True)
class Hill:
    """Height, exact slopes `(-dz/dx, -dz/dy)` and albedo over the pixels; x right and y up."""

    depth: np.ndarray
    slopes: np.ndarray
    albedo: np.ndarray

    @property
    def normals(self):
        n = np.stack([*self.slopes, np.ones((ROWS, COLUMNS))], axis=-1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    def images(self, lights):
        """Nothing on so gentle a hill casts a shadow on another part of it."""
        return self.albedo * np.maximum(np.tensordot(lights, self.normals, axes=(1, 2)), 0)


@pytest.fixture(scope="session")
def hill():
    """Make a hill, its knob so high."""

    def make(knob, seed=0):
        x = np.arange(COLUMNS) + 0.5 - COLUMNS / 2
        y = ROWS / 2 - np.arange(ROWS)[:, None] - 0.5
        depth, slopes = np.zeros((ROWS, COLUMNS)), np.zeros((2, ROWS, COLUMNS))
        for height, east, north, width in ((8.0, 0.0, 0.0, 9.0), (knob, 3.0, -4.0, 3.0)):
            bump = height * np.exp(-((x - east) ** 2 + (y - north) ** 2) / (2 * width**2))
            depth += bump
            slopes += bump / width**2 * np.stack(np.broadcast_arrays(x - east, y - north))
        albedo = np.random.default_rng(seed).uniform(0.4, 0.8, (ROWS, COLUMNS))
        return Hill(depth, slopes, albedo)

    return make


@pytest.fixture(scope="session")
def around():
    """Make a light on the viewing axis and six on a circle about it, at some degrees."""

    def make(degrees):
        turn = 2 * np.pi * np.arange(6) / 6
        polar = np.radians(degrees)
        ring = [
            np.sin(polar) * np.cos(turn),
            np.sin(polar) * np.sin(turn),
            np.full(6, np.cos(polar)),
        ]
        return np.concatenate([[[0.0, 0.0, 1.0]], np.stack(ring, axis=1)])

    return make
