"""Photographs of a mirror sphere, many rays a pixel reflected one by one."""

import numpy as np

SHAPE, CENTRE, RADIUS = (100, 120), (52.3, 63.8), 40.0
FINE = 8


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def rays():
    """Return what each of FINE x FINE rays a pixel meets: on the sphere or not, and its normal."""
    rows, columns = (np.indices([FINE * side for side in SHAPE]) + 0.5) / FINE
    x, y = (columns - CENTRE[1]) / RADIUS, (CENTRE[0] - rows) / RADIUS
    squared = x**2 + y**2
    return squared < 1, np.stack([x, y, np.sqrt(np.maximum(1 - squared, 0))], axis=-1)


def pixels(fine):
    return fine.reshape(SHAPE[0], FINE, SHAPE[1], FINE).mean(axis=(1, 3))


def mirrored(lamps, degrees=4.0, bright=30.0, window=0.0, clip=1.0):
    """Return photographs of a mirror sphere in a dim room, clipped; lamps are discs."""
    on, n = rays()
    ray = np.array([0.0, 0.0, -1.0])
    seen = ray - 2 * (n @ ray)[..., None] * n
    shines = window * (seen @ unit(np.array([0.9, 0.1, 0.3])) > np.cos(np.radians(15)))
    images = [
        pixels(on * (0.03 + shines + bright * (seen @ lamp > np.cos(np.radians(degrees)))))
        for lamp in lamps
    ]
    return np.minimum(images, clip)
