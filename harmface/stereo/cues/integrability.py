"""Cue: scaled normals are those of a surface.

A surface z(x, y) has slopes `z_x = -b_x / b_z` and `z_y = -b_y / b_z` with equal mixed derivatives,
`d/dy (b_x / b_z) = d/dx (b_y / b_z)` ([YS97]_). Times b_z^2, with rows t_x, t_y, t_z of T,

    c = (b_z d_y b_x - b_x d_y b_z) - (b_z d_x b_y - b_y d_x b_z) = 0,

which is linear in the derivatives of v: `c = g_y . v_y + g_x . v_x` with `g_y = b_z t_x - b_x t_z`
and `g_x = b_y t_z - b_z t_y`. The least change of the derivatives that makes c vanish, relative to
what is expected of noise and of differences over a cell, is Sampson's residual

    r = c / sqrt((|g_x|^2 + |g_y|^2) (noise^2 + TWIST^2 |v_x v_y|^2)).

Unlike c itself it cannot be made small by a map that flattens everything or follows the noise. It
does not change under a bas-relief transformation, `b_x + mu b_z, b_y + nu b_z, lambda b_z`, so of
the nine numbers of T four are left, one of them a scale.

With d = 3, c is linear in the six numbers of `A = t_z x t_x` and `B = t_z x t_y`:
`c = A . (v x v_y) - B . (v x v_x)`; all of them are searched.

References
----------
.. [YS97] Yuille and Snow, Shape and Albedo from Multiple Images using Integrability, CVPR 1997.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from harmface.stereo.cues.cue import VOTES, Rows
from harmface.stereo.cues.field import StructureField

TWIST = 0.05
"""Relative error of derivatives that differences over a cell leave."""

TRIED = 2000
"""Random members of the six numbers: neighbours are some 25 degrees apart."""

IMPROVED = 6
"""Best of those tried that are improved: nearly all reach the same optimum."""


@dataclass(frozen=True, eq=False)
class Integrability:
    """Share of the derivatives of v that must change for the surface to be integrable.

    Parameters
    ----------
    v, along_x, along_y
        Structure of unit length and its derivatives, in each cell, in coordinates in which its
        noise is alike in all directions.
    size
        Expected error of the derivatives.
    back
        From these coordinates to those of the rows.
    """

    v: Float[np.ndarray, "c d"]
    along_x: Float[np.ndarray, "c d"]
    along_y: Float[np.ndarray, "c d"]
    size: Float[np.ndarray, "c"]
    back: Float[np.ndarray, "d d"]
    name: str = "integrability"
    # In units of what is expected of noise and differences.
    floor: float = 0.1
    believable: float = np.inf
    # Two: every part of the picture is seen along x and along y.
    votes: float = 2 * VOTES

    @classmethod
    def of(
        cls, seen: StructureField, whitening: Float[np.ndarray, "d d"] | None = None
    ) -> "Integrability":
        """Return the cue for a field.

        Parameters
        ----------
        seen
            The field.
        whitening
            Map to coordinates in which the noise is alike in all directions; none if not given.
        """
        root = np.eye(seen.middle.shape[1]) if whitening is None else whitening
        white = seen.middle @ root.T
        length = np.linalg.norm(white, axis=1)
        # Cells that no lamp reaches have derivatives of no size, and say nothing.
        length = np.maximum(length, np.finfo(np.float64).eps * length.max(initial=1e-300))
        v = white / length[:, None]

        def across(derivative: Float[np.ndarray, "c d"]) -> Float[np.ndarray, "c d"]:
            # Of v / |v|, so that edges of the albedo do not pass for bends.
            derivative = derivative @ root.T / length[:, None]
            return derivative - (v * derivative).sum(axis=1, keepdims=True) * v

        dx, dy = across(seen.along_x), across(seen.along_y)
        bend = ((dx**2).sum(axis=1) + (dy**2).sum(axis=1)) / 2
        variance = (seen.noise / length) ** 2 + TWIST**2 * bend
        return cls(v, dx, dy, np.sqrt(variance + np.finfo(np.float64).eps), np.linalg.inv(root))

    def residuals(self, rows: Rows) -> Float[np.ndarray, "c"]:
        """Return r of the module's text."""
        rows = rows @ self.back
        tx, ty, tz = rows
        bx, by, bz = rows @ self.v.T
        c = bz * (self.along_y @ tx) - bx * (self.along_y @ tz)
        c -= bz * (self.along_x @ ty) - by * (self.along_x @ tz)
        gram = rows @ rows.T
        squared = bz**2 * (gram[0, 0] + gram[1, 1]) + (bx**2 + by**2) * gram[2, 2]
        squared -= 2 * bz * (bx * gram[0, 2] + by * gram[1, 2])
        return c / np.sqrt(np.maximum(squared, np.finfo(np.float64).tiny)) / self.size

    def best_rows(self, rng: np.random.Generator) -> list[Rows]:
        """Return maps of three dimensions that are integrable, the best first.

        They are up to bas-relief transformations; t_x and t_y are orthogonal to t_z, of unit
        length.
        """
        wx, wy = np.cross(self.v, self.along_x), np.cross(self.v, self.along_y)

        def twisted(numbers: Float[np.ndarray, "m 6"]) -> Float[np.ndarray, "m c"]:
            a, b = numbers[:, :3], numbers[:, 3:]
            squared = (numbers**2).sum(axis=1)[:, None] - (a @ self.v.T) ** 2 - (b @ self.v.T) ** 2
            squared = np.maximum(squared, np.finfo(np.float64).tiny)
            return (a @ wy.T - b @ wx.T) / np.sqrt(squared) / self.size

        tried = rng.standard_normal((TRIED, 6))
        costs = np.log1p(twisted(tried) ** 2).sum(axis=1)
        found = []
        for start in tried[np.argsort(costs, kind="stable")[:IMPROVED]]:
            fit = least_squares(
                lambda numbers: twisted(numbers[None])[0],
                start / np.linalg.norm(start),
                loss="cauchy",
                max_nfev=50,
            )
            found.append((fit.cost, _rows(fit.x) @ np.linalg.inv(self.back)))
        return [rows for _, rows in sorted(found, key=lambda each: each[0])]


def _rows(numbers: Float[np.ndarray, "6"]) -> Rows:
    """Return t_x, t_y, t_z of A and B, see the module's text."""
    a, b = numbers[:3], numbers[3:]
    z = np.cross(a, b)
    z /= np.linalg.norm(z)
    rows = np.stack([np.cross(a, z), np.cross(b, z), z])
    rows[:2] /= np.sqrt((rows[:2] ** 2).sum() / 2)
    return rows
