"""Surfaces of many alike subjects from a few photographs each, under known light.

Frontal photographs say little of how a surface leans: their lights are a few degrees apart. Two
things help. All faces are alike, so that the photographs of all subjects together give a generic
surface from which each departs by as much as its own photographs insist on, as [RS01]_ has all
objects of a class share one shape. And a surface has one unknown a pixel, its depth, where
normals have two.

References
----------
.. [RS01] Shashua and Riklin-Raviv, The Quotient Image: Class-Based Re-Rendering and Recognition
   with Varying Illuminations, PAMI 2001.
"""

import numpy as np
from jaxtyping import Float
from scipy.sparse import csr_array, diags_array, eye_array, kron
from scipy.sparse.linalg import spsolve

from harmface.enrollment.shading import (
    SlopeEquations,
    brightness,
    evenly_exposed,
    shading,
    slope_equations,
    usable,
)

ROUNDS = 5
"""Solutions in turn, for slopes, brightness, exposures and outliers to settle."""

DEPARTURE = 0.2
"""Weight of the squared slopes between a subject and the generic surface, against the squared
misfits of its photographs as fractions of their brightness."""

FLATNESS = 0.001
"""Weight of the generic surface's own squared slopes, and of every depth itself by a millionth:
they decide what no photograph does."""


class Grid:
    """Heights over the pixels of an image.

    Parameters
    ----------
    shape
        Rows and columns, at least two of each.
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        (high, wide), each = (eye_array(n) for n in shape), [np.eye(n) for n in shape]
        # Central differences within, one-sided at the rim; rows count downwards and y upwards.
        rows, columns = (csr_array(np.gradient(unit, axis=0)) for unit in each)
        self.along = kron(high, columns).tocsr()
        self.up = -kron(rows, wide).tocsr()
        rows, columns = (csr_array(np.diff(unit, axis=0)) for unit in each)
        steps = [kron(high, columns).tocsr(), kron(rows, wide).tocsr()]
        self.roughness = sum(step.T @ step for step in steps)
        """Quadratic form that sums the squared steps between neighbours."""

    def slopes(self, depth: Float[np.ndarray, "m"]) -> Float[np.ndarray, "2 m"]:
        """Return `(-dz/dx, -dz/dy)`."""
        return -np.stack([self.along @ depth, self.up @ depth])

    def depth(
        self, equations: SlopeEquations, near: Float[np.ndarray, "m"], weight: float
    ) -> Float[np.ndarray, "m"]:
        """Return the heights whose slopes fit best, while their steps stay near those given."""
        (a, b), (_, c) = (map(diags_array, row) for row in equations.matrix)
        normal = self.along.T @ (a @ self.along + b @ self.up)
        normal += self.up.T @ (b @ self.along + c @ self.up) + weight * self.roughness
        normal += 1e-6 * FLATNESS * eye_array(len(near))
        right = weight * (self.roughness @ near)
        right -= self.along.T @ equations.right[0] + self.up.T @ equations.right[1]
        return np.asarray(spsolve(normal.tocsc(), right, permc_spec="MMD_AT_PLUS_A"))


def depths_near_generic(
    photographs: list[Float[np.ndarray, "_ H W"]], lights: list[Float[np.ndarray, "_ 3"]]
) -> tuple[Float[np.ndarray, "N H W"], Float[np.ndarray, "N H W"]]:
    """Return every subject's height in pixels, and its brightness `g = albedo n_z`.

    In turn, `slope_equations` are taken at present slopes, and solved first for a generic surface,
    from the mean of all subjects', and then for each subject's own, near the generic one.

    Parameters
    ----------
    photographs
        Of each subject, framed alike.
    lights
        Unit direction to the light of each photograph.
    """
    shape = photographs[0].shape[1:]
    grid = Grid(shape)
    images = [own.reshape(len(own), -1).astype(np.float64) for own in photographs]
    pixels = shape[0] * shape[1]
    depths = np.zeros((len(images), pixels))
    slopes = [np.zeros((2, pixels)) for _ in images]
    for number in range(ROUNDS):
        each = [
            slope_equations(*subject, robust=number > 0)
            for subject in zip(images, lights, slopes, strict=True)
        ]
        generic = grid.depth(SlopeEquations.mean(each), np.zeros(pixels), FLATNESS)
        depths = np.stack([grid.depth(own, generic, DEPARTURE) for own in each])
        slopes = [grid.slopes(depth) for depth in depths]
        images = [evenly_exposed(*subject) for subject in zip(images, lights, slopes, strict=True)]
    bright = [
        brightness(own, usable(own), shading(light, slope))
        for own, light, slope in zip(images, lights, slopes, strict=True)
    ]
    return depths.reshape(-1, *shape), np.stack(bright).reshape(-1, *shape)
