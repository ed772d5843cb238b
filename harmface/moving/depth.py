"""One view's depth from all frames: what each hypothesis costs, and a smooth surface.

For a hypothesis of depth along a ray, the brightness where the other frames see that point is
compared with what the harmonic model can show there: the residual of the fit is the matching cost
[SFS03]_. A surface without texture still changes its brightness as it turns, which plain comparison
of colours takes for a mismatch and this model explains.

References
----------
.. [SFS03] Simakov, Frolova and Basri, Dense Shape Reconstruction of a Moving Object under
   Arbitrary, Unknown Lighting, ICCV 2003.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from harmface.geometry import Mesh, vertex_normals
from harmface.moving.hull import VisualHull, looked_up
from harmface.moving.shading import light_turns, shading_basis
from harmface.moving.views import Views
from harmface.stereo.robust import cauchy_weights, robust_scale

GRAZING = 0.25
"""Cosine between normal and line of sight below which a frame is not asked: 75 degrees."""

WINDOW = 1.5
"""Pixels over which costs are averaged, along the present surface: noise falls, detail stays."""

PIECE = 2**11
"""Rays treated at a time: 60 MB for 60 frames and 40 hypotheses."""


@dataclass(frozen=True, eq=False)
class RayGrid:
    """The rays of the pixels of one frame that see the object.

    Parameters
    ----------
    frame
        Number of the frame.
    mask
        Its silhouette.
    origins, directions
        Of every ray, in the object's coordinates.
    pixel
        Side of a pixel on the object.
    """

    frame: int
    mask: Bool[np.ndarray, "H W"]
    origins: Float[np.ndarray, "p 3"]
    directions: Float[np.ndarray, "p 3"]
    pixel: float

    @classmethod
    def of(
        cls, frame: int, mask: Bool[np.ndarray, "H W"], views: Views, hull: VisualHull
    ) -> "RayGrid":
        """Return the rays of one frame."""
        rows, columns = np.nonzero(mask)
        rays = views.rays(frame, np.stack([columns + 0.5, rows + 0.5], axis=1))
        across = hull.pixels_across(hull.points[np.argmax(hull.field)])
        return cls(frame, mask, *rays, 1 / across)

    def points(self, depth: Float[np.ndarray, "p"]) -> Float[np.ndarray, "p 3"]:
        """Return the points at distances along the rays."""
        return self.origins + depth[:, None] * self.directions

    def mesh(self, depth: Float[np.ndarray, "p"], steepest: float = np.inf) -> Mesh:
        """Return two triangles for each block of 2 x 2 rays, without steps of depth.

        Parameters
        ----------
        depth
            Along every ray.
        steepest
            Largest difference of depth within a block, in pixels.
        """
        index = np.full(self.mask.shape, -1)
        index[self.mask] = np.arange(len(depth))
        corners = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]], -1)
        corners = corners[(corners >= 0).all(axis=-1)]
        corners = corners[np.ptp(depth[corners], axis=1) <= steepest * self.pixel]
        a, b, c, d = corners.T
        faces = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
        points = self.points(depth)
        return Mesh(points, faces, vertex_normals(points, faces), np.ones_like(points))

    def averaged(self, values: Float[np.ndarray, "p h"], window: float) -> Float[np.ndarray, "p h"]:
        """Return means of values over neighbouring rays, with a Gaussian of `window` pixels."""
        cover = gaussian_filter(self.mask.astype(float), window)[self.mask]
        found = np.empty_like(values)
        picture = np.zeros(self.mask.shape)
        for column, target in zip(values.T, found.T, strict=True):
            picture[self.mask] = column
            target[:] = gaussian_filter(picture, window)[self.mask] / cover
        return found

    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the rays that are neighbours, across and down."""
        index = np.full(self.mask.shape, -1)
        index[self.mask] = np.arange(len(self.origins))
        found = []
        for near, far in (
            ((slice(None), slice(None, -1)), (slice(None), slice(1, None))),
            ((slice(None, -1), slice(None)), (slice(1, None), slice(None))),
        ):
            both = self.mask[near] & self.mask[far]
            found.append((index[near][both], index[far][both]))
        first, second = zip(*found, strict=True)
        return np.concatenate(first), np.concatenate(second)


@dataclass(frozen=True, eq=False)
class Matches:
    """What matching tells of each ray.

    Parameters
    ----------
    depth
        Where the cost is least, sub-pixel.
    precision
        How sharp the minimum is: the inverse variance of the depth, 0 where there is no minimum
        between the ends.
    """

    depth: Float[np.ndarray, "p"]
    precision: Float[np.ndarray, "p"]


def seen_from(
    mesh: Mesh, views: Views, points: Float[np.ndarray, "p 3"], normals: Float[np.ndarray, "p 3"]
) -> Bool[np.ndarray, "F p"]:
    """Return whether each frame sees each point of a surface, not too obliquely.

    Parameters
    ----------
    mesh
        What may stand in between.
    views
        The frames.
    points, normals
        Of the surface.
    """
    towards = views.towards_camera(points)
    facing = np.einsum("fpi,pi->fp", towards, normals)
    seen = facing > GRAZING
    frame, point = np.nonzero(seen)
    # Two pixels of a coarse mesh may lie before a point of the smooth surface.
    starts = points + 0.02 * mesh.rays.radius * normals
    blocked = mesh.rays.occluded(mesh.rays.local(starts)[point], towards[frame, point])
    seen[frame, point] = ~blocked
    return seen


def projectors(
    scaled_normals: Float[np.ndarray, "p 3"],
    lighting: Float[np.ndarray, "9"],
    views: Views,
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "F p 3"]:
    """Return what the model can show at a point, orthonormal under the weights' square root.

    The tangent of all its images at the present scaled normal; as they are homogeneous of degree
    1 in it, the image itself is among them.
    """
    lights = light_turns(views.rotations, 2) @ lighting
    _, slopes = shading_basis(scaled_normals, 2)
    tangent = np.einsum("fk,kpi->pfi", lights, slopes) * np.sqrt(weights.T)[..., None]
    return np.moveaxis(np.linalg.qr(tangent)[0], 1, 0)


def match(
    grid: RayGrid,
    frames: Float[np.ndarray, "F H W"],
    views: Views,
    depth: Float[np.ndarray, "p"],
    offsets: Float[np.ndarray, "h"],
    weights: Float[np.ndarray, "F p"],
    explained: Float[np.ndarray, "F p m"],
) -> Matches:
    """Return where along each ray what the frames show is explained best.

    Parameters
    ----------
    grid
        The rays.
    frames
        Brightness.
    views
        Of the frames.
    depth
        Present depth of every ray.
    offsets
        Hypotheses: what is added to it, evenly spaced.
    weights
        Of every frame at every ray.
    explained
        Orthonormal basis, times the weights' square root, of what the model can show.

    Returns
    -------
    Matches
        Depth and its precision, for residuals in units of their noise.
    """
    count = len(depth)
    cost = np.empty((count, len(offsets)))
    for first in range(0, count, PIECE):
        some = slice(first, min(first + PIECE, count))
        at = depth[some, None] + offsets
        points = grid.origins[some, None] + at[..., None] * grid.directions[some, None]
        shown = looked_up(frames, views.pixels(points.reshape(-1, 3)))
        shown = shown.reshape(len(frames), *at.shape)
        shown = shown * np.sqrt(weights[:, some]).astype(np.float32)[..., None]
        basis = explained[:, some].astype(np.float32)
        along = np.einsum("fpm,fph->pmh", basis, shown, optimize=True)
        square = np.einsum("fph,fph->ph", shown, shown)
        cost[some] = square - np.einsum("pmh,pmh->ph", along, along)
    freedom = np.maximum(weights.sum(axis=0) - explained.shape[-1] - 1, 1)
    cost = grid.averaged(cost, WINDOW)
    least = cost.argmin(axis=1)
    inner = np.clip(least, 1, len(offsets) - 2)
    each = np.arange(count)
    low, middle, high = (cost[each, inner + k] for k in (-1, 0, 1))
    bend = low + high - 2 * middle
    valid = (least == inner) & (bend > 0)
    shift = np.where(valid, (low - high) / np.where(valid, 2 * bend, 1), 0)
    step = offsets[1] - offsets[0]
    noise = np.maximum(middle / freedom, np.finfo(np.float32).tiny)
    # Half the cost's second derivative over the noise is the inverse variance.
    precision = np.where(valid, bend / (2 * step**2) / noise, 0)
    return Matches(depth + offsets[inner] + shift * step, precision)


def smooth_depth(
    grid: RayGrid,
    depth: Float[np.ndarray, "p"],
    normals: Float[np.ndarray, "p 3"],
    matches: Matches,
    slope_error: float,
    rounds: int = 4,
) -> Float[np.ndarray, "p"]:
    """Return the depth that fits the matches and the normals best.

    A neighbour lies in the tangent plane: `n . (x_j - x_i) = 0` with the mean normal of the two,
    linear in both depths. Matches count by their precision, normals by `slope_error`; Cauchy's
    weights let neither false matches nor steps of depth decide.

    Parameters
    ----------
    grid
        The rays.
    depth
        Present depth.
    normals
        Unit normals.
    matches
        Depths and their precisions.
    slope_error
        Standard deviation of the step between neighbours, in pixels.
    rounds
        Of reweighting.

    Returns
    -------
    numpy.ndarray
        Depth along every ray.
    """
    i, j = grid.pairs()
    normal = normals[i] + normals[j]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.maximum(-np.einsum("ei,ei->e", normal, grid.directions[i]), 0.1)
    near = -np.einsum("ei,ei->e", normal, grid.directions[i]) / along
    far = -np.einsum("ei,ei->e", normal, grid.directions[j]) / along
    rise = np.einsum("ei,ei->e", normal, grid.origins[j] - grid.origins[i]) / along
    each = np.arange(len(i))
    steps = coo_array(
        (
            np.concatenate([-near, far]),
            (np.concatenate([each, each]), np.concatenate([i, j])),
        ),
        shape=(len(i), len(depth)),
    ).tocsr()
    sigma = slope_error * grid.pixel / along
    for _ in range(rounds):
        misfit = (steps @ depth - rise) / sigma
        edge = cauchy_weights(misfit, max(robust_scale(misfit), 3.0)) / sigma**2
        error = (depth - matches.depth) * np.sqrt(matches.precision)
        used = matches.precision > 0
        spread = max(robust_scale(error[used]), 1.0) if used.any() else 1.0
        data = matches.precision * cauchy_weights(error, spread) / spread**2
        depth = _solved(steps, rise, edge, data, matches.depth, depth)
    return depth


def _solved(
    steps: csr_array,
    rise: Float[np.ndarray, "e"],
    edge: Float[np.ndarray, "e"],
    data: Float[np.ndarray, "p"],
    target: Float[np.ndarray, "p"],
    present: Float[np.ndarray, "p"],
) -> Float[np.ndarray, "p"]:
    weighted = steps.T @ diags_array(edge)
    # What neither matches nor neighbours say stays where it is.
    anchor = 1e-6 * float(edge.mean())
    normal = weighted @ steps + diags_array(data + anchor)
    factors = splu(
        normal.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.asarray(factors.solve(weighted @ rise + data * target + anchor * present))
