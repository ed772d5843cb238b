"""Albedo textures: checks over (u, v), smooth noise and spots over position."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from data_synth.shapes.shape import Shape, normalised


def textured(shape: Shape, kind: str, rng: np.random.Generator | int = 0) -> Shape:
    """Return the shape with a procedural albedo.

    Parameters
    ----------
    shape : Shape
    kind : str
        A name in `TEXTURES`: checker, noise or spots.
    rng : numpy Generator or seed
        Draws the two colours and the pattern.

    Returns
    -------
    Shape
        With albedo (V, 3) in [0.05, 0.95], linear RGB.
    """
    if kind not in TEXTURES:
        raise ValueError(f"kind must be one of {', '.join(TEXTURES)}, got {kind!r}")
    rng = np.random.default_rng(rng)
    dark, light = rng.uniform(0.05, 0.35, 3), rng.uniform(0.55, 0.95, 3)
    mix = TEXTURES[kind](shape, rng)[:, None]
    return replace(shape, albedo=(1.0 - mix) * dark + mix * light)


def checker(shape: Shape, _rng: np.random.Generator) -> np.ndarray:
    """Alternate 16 x 8 checks over (u, v)."""
    column, row = np.floor(shape.uvs * (16, 8)).T
    parity: np.ndarray = (column + row) % 2
    return parity


def noise(shape: Shape, rng: np.random.Generator) -> np.ndarray:
    """Sum plane waves through space, amplitude falling as 1 / frequency, squashed to (0, 1)."""
    frequency = np.geomspace(2.0, 20.0, 48)[:, None]
    waves = normalised(rng.standard_normal((48, 3))) * frequency
    phases = rng.uniform(0.0, 2.0 * np.pi, 48)
    amplitude = 1.0 / frequency[:, 0]
    total = np.cos(shape.vertices @ waves.T + phases) @ amplitude
    return 0.5 + 0.5 * np.tanh(2.0 * total / np.linalg.norm(amplitude))


def spots(shape: Shape, rng: np.random.Generator) -> np.ndarray:
    """Scatter 40 round soft-edged spots, centred on vertices drawn at random."""
    centres = shape.vertices[rng.integers(0, len(shape.vertices), 40)]
    radii = rng.uniform(0.06, 0.18, 40)
    cover = np.zeros(len(shape.vertices))
    for centre, radius in zip(centres, radii, strict=True):
        distance = np.linalg.norm(shape.vertices - centre, axis=1) / radius
        cover = np.maximum(cover, np.clip(2.5 * (1.0 - distance), 0.0, 1.0))
    return 1.0 - cover


TEXTURES: dict[str, Callable[[Shape, np.random.Generator], np.ndarray]] = {
    "checker": checker,
    "noise": noise,
    "spots": spots,
}
"""From a shape to the share (V,) in [0, 1] of the lighter of two colours."""
