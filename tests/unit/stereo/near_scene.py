"""Surfaces under near lamps, the light computed point by point from its definition."""

from dataclasses import dataclass

import numpy as np

SIZE, LAMPS = 64, 16


@dataclass(frozen=True)
class Surface:
    """Points in widths of the mask, from the middle and the mean height, and their normals."""

    mask: np.ndarray
    points: np.ndarray
    normals: np.ndarray

    @property
    def albedo(self):
        return 0.5 + 0.3 * np.sin(9 * self.points[:, 0]) * np.sin(7 * self.points[:, 1])

    def photographs(self, positions, strengths, rng, noise=0.005):
        images = np.zeros((len(positions), *self.mask.shape))
        for image, position, strength in zip(images, positions, strengths, strict=True):
            towards = position - self.points
            distance = np.linalg.norm(towards, axis=1)
            cosine = np.sum(towards * self.normals, axis=1) / distance
            falloff = (np.linalg.norm(position) / distance) ** 2
            image[self.mask] = self.albedo * strength * falloff * np.maximum(cosine, 0)
        images += noise * np.percentile(images, 99) * rng.standard_normal(images.shape)
        return np.where(self.mask, np.maximum(images, 0), 0)


def surface(mask, x, y, z, normals):
    width = np.ptp(x[mask]) + 2 / SIZE
    points = np.stack([x, y, z - z[mask].mean()], axis=-1)[mask] / width
    return Surface(mask, points, normals[mask])


def grid():
    y, x = np.mgrid[SIZE - 1 : -SIZE : -2, 1 - SIZE : SIZE : 2] / SIZE
    return x, y


def sphere():
    x, y = grid()
    radius = 61 / SIZE
    mask = x**2 + y**2 < radius**2
    z = np.sqrt(np.maximum(radius**2 - x**2 - y**2, 0))
    return surface(mask, x, y, z, np.stack([x, y, z], axis=-1) / radius)


def relief():
    x, y = grid()
    z = 0.2 * np.sin(3 * x) * np.cos(2.5 * y)
    slopes = 0.6 * np.cos(3 * x) * np.cos(2.5 * y), -0.5 * np.sin(3 * x) * np.sin(2.5 * y)
    normals = np.stack([-slopes[0], -slopes[1], np.ones_like(x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return surface(np.ones(x.shape, bool), x, y, z, normals)


def lamps_around():
    """Return positions of lamps 15 to 60 degrees from the axis, 1.6 to 2.4 widths away."""
    rng = np.random.default_rng(0)
    azimuth = 2.4 * np.arange(LAMPS)
    polar = np.radians(15 + 45 * np.arange(LAMPS) / LAMPS)
    flat = np.sin(polar)
    directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(polar)], axis=-1)
    return directions * (2 + 0.4 * rng.uniform(-1, 1, LAMPS))[:, None]
