"""Depth as a bicubic spline with a knot a pixel, over any mask.

`z(x, y) = sum_k c_k B(x - x_k) B(y - y_k)`, B the cubic B-spline: at a pixel the 3 x 3
coefficients about it count, with weights (1, 4, 1) / 6 for values and (-1, 0, 1) / 2 for slopes.
Slopes by central differences, or over cells, are wrong by the
surface's third derivatives, differently in x and y; between those of the spline there is an error
of the fifth only.

References
----------
.. [S03] Saad, Iterative Methods for Sparse Linear Systems, 2003, 4.1 and 13.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import block_array, coo_array, csr_array, diags_array, eye_array, vstack
from scipy.sparse.linalg import LinearOperator, cg, splu

COARSER = 8
"""Pixels between the coefficients of the coarse grid: few enough of them for a direct solver."""

SWEEPS = 2

OVERRELAXED = 1.5
"""Multiple of a Jacobi step by sums of absolute values; below 2 it converges."""

ACCURACY = 1e-3
"""Residual, relative to the right side, at which the conjugate gradients end."""

ITERATIONS = 200

ANCHOR = 1e-9
"""Share of the mean diagonal that fixes the free height of each connected part."""


@dataclass(frozen=True, eq=False)
class DepthSpline:
    """Linear maps from the coefficients of a depth.

    Parameters
    ----------
    shape
        Of the mask.
    places
        Row and column of each coefficient on the mask's grid with a margin of one.
    depth
        To z at the pixels of the mask.
    slopes
        To z_x at all pixels, then z_y, y upwards.
    bends
        To the second differences of the coefficients along x, along y, and sqrt(2) times those
        along both. Of a smooth z they are its second derivatives, but they also feel the
        checkerboards that no slope at a pixel does.
    coarse
        From coefficients on the coarse grid, interpolated linearly.
    """

    shape: tuple[int, int]
    places: Int[np.ndarray, "2 n"]
    depth: csr_array
    slopes: csr_array
    bends: csr_array
    coarse: csr_array

    def picture(self, coefficients: Float[np.ndarray, "n"]) -> Float[np.ndarray, "H2 W2"]:
        """Return coefficients on the mask's grid with a margin of one, zero where there is none."""
        grid = np.zeros((self.shape[0] + 2, self.shape[1] + 2))
        grid[tuple(self.places)] = coefficients
        return grid

    def minimiser(
        self,
        slope_weights: Float[np.ndarray, "p 2 2"],
        bend_weights: Float[np.ndarray, "k"],
        right: Float[np.ndarray, "n"],
    ) -> Float[np.ndarray, "n"]:
        """Return about the c of least `sum_p g' A g / 2 + sum_k w_k d_k^2 / 2 - c' right`.

        g are the slopes of a pixel and d_k the bends. Conjugate gradients, in a quarter of the
        memory that a direct solver needs for 300 000 pixels: Jacobi steps settle what changes
        quickly, a direct solution on the coarse grid the rest ([S03]_). That takes about twenty
        iterations, a hundred if bends weigh next to nothing, whatever the size of the mask; what
        they leave unfinished is still lower than c = 0.

        Parameters
        ----------
        slope_weights
            A of each pixel, symmetric and positive semidefinite.
        bend_weights
            Not negative.
        right
            Right side of the normal equations.
        """
        blocks = [[diags_array(slope_weights[:, i, j]) for j in (0, 1)] for i in (0, 1)]
        system = self.slopes.T @ (block_array(blocks) @ self.slopes)
        system = system + self.bends.T @ (diags_array(bend_weights) @ self.bends)
        anchor = ANCHOR * system.diagonal().mean() + np.finfo(np.float64).tiny
        system = (system + anchor * eye_array(len(right))).tocsr()
        # Sums of absolute values bound the matrix from above, so that no step overshoots.
        step = OVERRELAXED / abs(system).sum(axis=1)
        coarse = splu((self.coarse.T @ (system @ self.coarse)).tocsc())

        def smoothed(x: np.ndarray, towards: np.ndarray) -> np.ndarray:
            for _ in range(SWEEPS):
                x = x + step * (towards - system @ x)
            return x

        def nearly_solved(towards: np.ndarray) -> np.ndarray:
            x = smoothed(np.zeros_like(towards), towards)
            x = x + self.coarse @ coarse.solve(self.coarse.T @ (towards - system @ x))
            return smoothed(x, towards)

        preconditioner = LinearOperator(system.shape, nearly_solved, dtype=np.float64)
        found, _ = cg(system, right, M=preconditioner, rtol=ACCURACY, maxiter=ITERATIONS)
        return np.asarray(found)


def spline_over(mask: Bool[np.ndarray, "H W"]) -> DepthSpline:
    """Return the spline of all coefficients that count at some pixel of a mask."""
    row, column = np.nonzero(mask)
    # A column that holds no coefficient parts the end of a row from the start of the next.
    width = mask.shape[1] + 3
    around = np.add.outer(np.arange(3) * width, np.arange(3)).ravel()
    used, about = np.unique(np.add.outer(row * width + column, around), return_inverse=True)
    about = about.reshape(-1, 9)
    value, slope = np.array([1, 4, 1]) / 6, np.array([-1, 0, 1]) / 2

    def at_pixels(down: Float[np.ndarray, "3"], right: Float[np.ndarray, "3"]) -> csr_array:
        return _repeated(np.outer(down, right).ravel(), about, len(used))

    index = np.full((mask.shape[0] + 4) * width, -1)
    index[used] = np.arange(len(used))

    def differences(stencil: list[float], offsets: list[int]) -> csr_array:
        columns = index[np.add.outer(used, offsets)]
        return _repeated(np.array(stencil), columns[(columns >= 0).all(axis=1)], len(used))

    second = [1.0, -2.0, 1.0]
    mixed = [np.sqrt(2), -np.sqrt(2), -np.sqrt(2), np.sqrt(2)]
    # Rows run downwards, y upwards.
    slopes = [at_pixels(value, slope), at_pixels(-slope, value)]
    bends = [
        differences(second, [0, 1, 2]),
        differences(second, [0, width, 2 * width]),
        differences(mixed, [0, 1, width, width + 1]),
    ]
    places = np.stack([used // width, used % width])
    return DepthSpline(
        (mask.shape[0], mask.shape[1]),
        places,
        at_pixels(value, value),
        vstack(slopes).tocsr(),
        vstack(bends).tocsr(),
        _interpolation(places),
    )


def _repeated(
    stencil: Float[np.ndarray, "e"], columns: Int[np.ndarray, "p e"], size: int
) -> csr_array:
    """Return a matrix whose rows hold a stencil at different columns."""
    kept = stencil != 0
    columns, stencil = columns[:, kept], stencil[kept]
    ends = np.arange(len(columns) + 1) * len(stencil)
    return csr_array((np.tile(stencil, len(columns)), columns.ravel(), ends), (len(columns), size))


def _interpolation(places: Int[np.ndarray, "2 n"]) -> csr_array:
    """Return bilinear interpolation to rows and columns from a grid `COARSER` times wider."""
    corner, rest = places // COARSER, places % COARSER / COARSER
    width = int(corner[1].max()) + 2
    columns, shares = [], []
    for i, j in product((0, 1), repeat=2):
        columns.append((corner[0] + i) * width + corner[1] + j)
        shares.append(np.abs(1 - i - rest[0]) * np.abs(1 - j - rest[1]))
    share = np.concatenate(shares)
    kept = share > 0
    rows = np.tile(np.arange(places.shape[1]), 4)[kept]
    used, column = np.unique(np.concatenate(columns)[kept], return_inverse=True)
    return coo_array((share[kept], (rows, column)), (places.shape[1], len(used))).tocsr()
