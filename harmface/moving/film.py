"""The surface, the albedo and the light of a film whose motion is known."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import Mesh
from harmface.moving.depth import Matches, RayGrid, match, projectors, seen_from, smooth_depth
from harmface.moving.hull import VisualHull, looked_up
from harmface.moving.shading import PointFit, light_turns, shading_basis
from harmface.moving.views import Views
from harmface.stereo.robust import cauchy_weights, robust_scale
from harmface.summaries import summary

CELLS = 96
"""Voxels along the longest side of the object."""

REACHES = (30.0, 20.0, 14.0, 10.0, 7.0, 7.0, 7.0, 7.0)
"""How far around the present depth each round looks, in pixels: from a quarter of a head that is
120 pixels wide to what a smoothed match is off by."""

SLOPES = (0.4, 0.3, 0.25, 0.2, 0.2, 0.2, 0.2, 0.2)
"""Standard deviation of the step between neighbouring rays in each round, in pixels: the error of
the slopes, from 20 degrees to 11."""

LEANINGS = (20.0, 15.0, 12.0, 10.0, 10.0, 10.0, 10.0, 10.0)
"""Standard deviation of a photometric normal from the surface's own in each round, degrees."""

HYPOTHESES = 25
"""Depths that are tried along a ray in one round."""

BLUR = 6.0
"""Pixels of the Gaussian that takes the edges off the visual hull, with which all begins."""

FEWEST = 8
"""Frames that must see a point to have a say: twice the unknowns of a point."""

DECIDING = 3000
"""Points that decide on the light."""

APART = 30.0
"""Degrees between the lines of sight of two frames whose depth is recovered."""

LEAST_TURN = 2.0
"""Degrees that the object must turn at least."""


@dataclass(frozen=True, eq=False)
class FilmSurface:
    """What a film tells of an object.

    Parameters
    ----------
    frame
        Number of the frame whose pixels the maps have.
    mask
        Its pixels of the object.
    normals
        Of the surface at each pixel, in the camera's frame: x right, y up, z towards the camera.
    albedo
        Its largest value is 1: the scale is not known.
    confidence
        In (0, 1]: share of the frames that see the point and are believed.
    depth
        Distance along the line of sight, in the object's unit of length.
    height
        Towards the camera, in pixels, mean zero; 0 outside the mask.
    mesh
        Closed surface in the object's coordinates, inside the visual hull, albedo at its vertices.
    lighting
        Harmonic coefficients of radiance in the camera's frame, for this albedo.
    residual
        Root mean square of what the light, the albedo and the photometric normals leave of the
        frames, relative to the frames' own.
    shading_error
        The same for the normals of the surface, before the fit.
    axes
        About how many axes the object turns.
    rays
        Of the frame.
    """

    frame: int
    mask: Bool[np.ndarray, "H W"]
    normals: Float[np.ndarray, "H W 3"]
    albedo: Float[np.ndarray, "H W"]
    confidence: Float[np.ndarray, "H W"]
    depth: Float[np.ndarray, "H W"]
    height: Float[np.ndarray, "H W"]
    mesh: Mesh
    lighting: Float[np.ndarray, "9"]
    residual: float
    shading_error: float
    axes: int
    rays: RayGrid

    __repr__ = summary


@dataclass(frozen=True, eq=False)
class _Shaded:
    """Light and scaled normals of the points of a surface."""

    seen: Bool[np.ndarray, "F p"]
    used: Bool[np.ndarray, "p"]
    weights: Float[np.ndarray, "F p"]
    lighting: Float[np.ndarray, "9"]
    scaled_normals: Float[np.ndarray, "p 3"]
    residual: float
    shading_error: float


def surface_from_film(
    frames: Float[np.ndarray, "F H W"],
    masks: Bool[np.ndarray, "_ H W"],
    views: Views,
    *,
    shading: bool = True,
    progress: Callable[[float], None] = lambda done: None,
) -> FilmSurface:
    """Return surface, albedo and light of a moving object whose motion is known.

    The visual hull, its edges blurred, begins. In each round the surface tells which frames see
    its points, their brightness tells light, normals and albedo (degree 2, Cauchy's weights), and
    depth is matched along the rays of a frame and made smooth by these normals. Frames that look
    from elsewhere than the first one do the same; all depths are fused within the hull.

    Parameters
    ----------
    frames
        Linear brightness.
    masks
        The object.
    views
        How it stands in each frame.
    shading
        Whether the harmonic model explains how brightness changes; without it points are matched
        by their brightness alone, for comparison.
    progress
        Told the fraction done.

    Returns
    -------
    FilmSurface
        Maps are those of the frame that looks along the mean line of sight.

    Raises
    ------
    ArgumentError
        If shapes do not agree, the object does not turn, or the silhouettes do not meet.
    """
    frames = checks.finite("frames", frames).astype(np.float32)
    if frames.ndim != 3 or frames.shape != masks.shape or len(views) != len(frames):
        raise ArgumentError(
            f"frames, masks and views must be of one film, got {frames.shape}, {masks.shape} and "
            f"{len(views)} views"
        )
    if len(frames) < FEWEST:
        raise ArgumentError(f"frames must be at least {FEWEST}, got {len(frames)}")
    if not masks.any(axis=(1, 2)).all():
        raise ArgumentError("masks must show the object in every frame")
    _check_turn(views)
    hull = VisualHull(masks, views, CELLS)
    chosen = _chosen(views)
    depths = []
    for number, frame in enumerate(chosen):
        grid = RayGrid.of(frame, masks[frame], views, hull)
        first = _hull_depth(grid, hull)
        depth = grid.averaged(first[:, None], BLUR)[:, 0]
        for turn, (reach, slope, leaning) in enumerate(zip(REACHES, SLOPES, LEANINGS, strict=True)):
            depth = _improved(
                grid, depth, frames, masks, views, reach, slope, leaning, shading=shading
            )
            depth = np.maximum(depth, first)
            progress((number + (turn + 1) / len(REACHES)) / (len(chosen) + 1))
        depths.append((grid, depth))
    grid, depth = depths[0]
    mesh = fused(hull, depths)
    surface = grid.mesh(depth)
    shaded = _shaded(surface, frames, masks, views, LEANINGS[-1])
    size = np.linalg.norm(shaded.scaled_normals, axis=1)
    white = float(np.percentile(size, 99))
    rotation = views.rotations[grid.frame]

    def picture(values: np.ndarray) -> np.ndarray:
        filled = np.zeros((*grid.mask.shape, *values.shape[1:]))
        filled[grid.mask] = values
        return filled

    towards = (surface.vertices @ rotation[2]) / grid.pixel
    colour = _vertex_albedo(mesh, frames, masks, views, shaded.lighting) / white
    mesh = Mesh(
        mesh.vertices,
        mesh.faces,
        mesh.normals,
        np.repeat(np.clip(colour, 0, 1)[:, None], 3, axis=1),
    )
    progress(1.0)
    return FilmSurface(
        grid.frame,
        grid.mask,
        picture(surface.normals @ rotation.T),
        picture(np.clip(size / white, 0, 1)),
        picture(np.maximum(shaded.weights.mean(axis=0), 1 / len(frames))),
        picture(depth),
        picture(towards - towards.mean()),
        mesh,
        shaded.lighting * white,
        shaded.residual,
        shaded.shading_error,
        views.axes(),
        grid,
    )


def fused(hull: VisualHull, depths: list[tuple[RayGrid, np.ndarray]]) -> Mesh:
    """Return one closed surface from the depths of several frames, inside the visual hull.

    Signed distances to the surfaces along the lines of sight are averaged near each of them
    (Curless and Levoy, A Volumetric Method for Building Complex Models from Range Images, 1996).

    Parameters
    ----------
    hull
        The visual hull, whose grid is used.
    depths
        Rays and depths of each frame.

    Returns
    -------
    Mesh
        White.
    """
    points, reach = hull.points, 4 * hull.step
    total, count = np.zeros(len(points)), np.zeros(len(points))
    for grid, depth in depths:
        picture = np.zeros(grid.mask.shape)
        picture[grid.mask] = depth
        pixels = hull.views[np.arange(len(hull.views)) == grid.frame].pixels(points)[0]
        column, row = np.floor(pixels).astype(int).T
        rows, columns = grid.mask.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        inside[inside] = grid.mask[row[inside], column[inside]]
        index = np.full(grid.mask.shape, -1)
        index[grid.mask] = np.arange(len(depth))
        ray = index[row[inside], column[inside]]
        along = np.einsum("ni,ni->n", points[inside] - grid.origins[ray], grid.directions[ray])
        behind = along - depth[ray]
        near = behind < reach
        which = np.flatnonzero(inside)[near]
        total[which] += np.clip(behind[near], -reach, reach)
        count[which] += 1
    field = np.where(count > 0, total / np.maximum(count, 1), reach).reshape(hull.field.shape)
    across = hull.pixels_across(points[np.argmax(hull.field)])
    return hull.surface(np.minimum(field, hull.field / across))


def _check_turn(views: Views) -> None:
    cosine = (np.einsum("ij,fij->f", views.rotations[0], views.rotations) - 1) / 2
    turn = float(np.degrees(np.arccos(np.clip(cosine, -1, 1)).max()))
    if turn < LEAST_TURN:
        raise ArgumentError(
            f"the object must turn between the frames, got {turn:.2g} degrees: moving without "
            "turning changes no brightness; give a film in which it turns"
        )


def _chosen(views: Views) -> list[int]:
    """Return frames whose lines of sight are apart, the one nearest to the mean first."""
    sight = views.rotations[:, 2]
    chosen = [int(np.argmax(sight @ sight.mean(axis=0)))]
    while True:
        nearest = (sight @ sight[chosen].T).max(axis=1)
        if nearest.min() > np.cos(np.radians(APART)):
            return chosen
        chosen.append(int(nearest.argmin()))


def _hull_depth(grid: RayGrid, hull: VisualHull) -> Float[np.ndarray, "p"]:
    """Return where each ray enters the visual hull, or passes it nearest."""
    mesh = hull.mesh()
    # From outside, wherever along the ray its origin is.
    middle = np.einsum("pi,pi->p", mesh.bounds.mean(axis=0) - grid.origins, grid.directions)
    starts = grid.points(middle - 2 * mesh.rays.radius)
    hits = mesh.rays.first_hits(mesh.rays.local(starts), grid.directions)
    met = hits.face >= 0
    weights = np.stack([1 - hits.u - hits.v, hits.u, hits.v], axis=1)[met]
    places = np.einsum("nc,nci->ni", weights, mesh.vertices[mesh.faces[hits.face[met]]])
    depth = middle
    depth[met] = np.einsum("ni,ni->n", places - grid.origins[met], grid.directions[met])
    return depth


def _improved(
    grid: RayGrid,
    depth: Float[np.ndarray, "p"],
    frames: Float[np.ndarray, "F H W"],
    masks: Bool[np.ndarray, "F H W"],
    views: Views,
    reach: float,
    slope: float,
    leaning: float,
    *,
    shading: bool,
) -> Float[np.ndarray, "p"]:
    """Return the depth after one round."""
    surface = grid.mesh(depth)
    shaded = _shaded(surface, frames, masks, views, leaning)
    normals = surface.normals
    if shading:
        explained = projectors(shaded.scaled_normals, shaded.lighting, views, shaded.weights)
        length = np.linalg.norm(shaded.scaled_normals, axis=1, keepdims=True)
        normals = shaded.scaled_normals / length
        weights = shaded.weights
    else:
        weights = shaded.seen * 1.0
        length = np.sqrt(np.maximum(weights.sum(axis=0), 1))
        explained = (weights / length)[..., None]
    offsets = np.linspace(-reach, reach, HYPOTHESES) * grid.pixel
    matches = match(grid, frames, views, depth, offsets, weights, explained)
    matches = Matches(matches.depth, np.where(shaded.used, matches.precision, 0))
    return smooth_depth(grid, depth, normals, matches, slope)


def _shaded(
    surface: Mesh,
    frames: Float[np.ndarray, "F H W"],
    masks: Bool[np.ndarray, "F H W"],
    views: Views,
    leaning: float,
) -> _Shaded:
    """Return light and scaled normals of the vertices of a surface."""
    points, normals = surface.vertices, surface.normals
    pixels = views.pixels(points)
    inside = looked_up(masks.astype(np.float32), pixels) > 0.99
    seen = seen_from(surface, views, points, normals) & inside
    brightness = looked_up(frames, pixels).astype(np.float64)
    used = seen.sum(axis=0) >= FEWEST
    if not used.any():
        raise ArgumentError(f"no point is seen in {FEWEST} frames; check the poses or cameras")
    turns = light_turns(views.rotations, 2)
    some = np.flatnonzero(used)[:: -(-int(used.sum()) // DECIDING)]
    weights = seen.astype(np.float64)
    few, lean = brightness[:, some], normals[some]
    lighting, albedo = _light(few, weights[:, some], lean, turns)
    for _ in range(3):
        left = _left(few, lean, albedo, turns @ lighting)
        believed = weights[:, some] * cauchy_weights(left, robust_scale(left[seen[:, some]]))
        lighting, albedo = _light(few, believed, lean, turns)
    shown = (turns @ lighting) @ shading_basis(normals, 2)[0]
    along = (weights * shown * brightness).sum(axis=0)
    square = (weights * shown**2).sum(axis=0)
    bright = np.where(used, along / np.maximum(square, np.finfo(float).tiny), 0.5)
    bright = np.maximum(bright, 1e-3)
    scaled = bright[:, None] * normals
    left = _left(brightness, normals, bright, turns @ lighting)
    own = float(np.sqrt((brightness[:, used][seen[:, used]] ** 2).mean()))
    shading_error = float(np.sqrt((left[:, used][seen[:, used]] ** 2).mean())) / own
    noise = robust_scale(left[:, used][seen[:, used]])
    weights[:, used] *= cauchy_weights(left[:, used], noise)
    weights[:, ~used] = 0
    fit = PointFit(brightness[:, used], turns, 2)
    stiff = (noise / bright[used] / np.radians(leaning)) ** 2
    scaled[used] = fit.points(
        scaled[used], lighting, weights[:, used], steps=8, near=(normals[used], stiff)
    )
    left = fit.residual(scaled[used], lighting)
    residual = float(np.sqrt((left[seen[:, used]] ** 2).mean())) / own
    return _Shaded(seen, used, weights, lighting, scaled, residual, shading_error)


def _left(
    brightness: Float[np.ndarray, "F p"],
    normals: Float[np.ndarray, "p 3"],
    albedo: Float[np.ndarray, "p"],
    lights: Float[np.ndarray, "F 9"],
) -> Float[np.ndarray, "F p"]:
    return brightness - albedo * (lights @ shading_basis(normals, 2)[0])


def _light(
    brightness: Float[np.ndarray, "F p"],
    weights: Float[np.ndarray, "F p"],
    normals: Float[np.ndarray, "p 3"],
    turns: Float[np.ndarray, "F 9 9"],
    rounds: int = 15,
) -> tuple[Float[np.ndarray, "9"], Float[np.ndarray, "p"]]:
    """Return light and albedo under known normals, each in turn linear in the other."""
    basis = shading_basis(normals, 2)[0]
    albedo = np.full(len(normals), 0.5)
    lighting = np.zeros(9)
    # Sums over frames and points of products of `D_t` and `f`, for any albedo at once.
    shown = np.einsum("kp,fkj->fpj", basis, turns, optimize=True)
    squares = np.einsum("fp,fpi,fpj->pij", weights, shown, shown, optimize=True)
    along = np.einsum("fp,fpi->pi", weights * brightness, shown, optimize=True)
    for _ in range(rounds):
        system = np.einsum("p,pij->ij", albedo**2, squares)
        system += 1e-6 * np.trace(system) * np.eye(9)
        lighting = np.linalg.solve(system, albedo @ along)
        square = np.einsum("i,pij,j->p", lighting, squares, lighting)
        albedo = np.maximum(along @ lighting / np.maximum(square, np.finfo(float).tiny), 1e-3)
        albedo *= 0.5 / albedo.mean()
    return lighting, albedo


def _vertex_albedo(
    mesh: Mesh,
    frames: Float[np.ndarray, "F H W"],
    masks: Bool[np.ndarray, "F H W"],
    views: Views,
    lighting: Float[np.ndarray, "9"],
) -> Float[np.ndarray, "V"]:
    """Return the albedo of vertices: of all frames that see one; the mean's where none does."""
    pixels = views.pixels(mesh.vertices)
    seen = seen_from(mesh, views, mesh.vertices, mesh.normals)
    seen &= looked_up(masks.astype(np.float32), pixels) > 0.5
    shown = (light_turns(views.rotations, 2) @ lighting) @ shading_basis(mesh.normals, 2)[0]
    shown = np.maximum(shown, 0) * seen
    square = (shown**2).sum(axis=0)
    albedo = (shown * looked_up(frames, pixels)).sum(axis=0)
    known = square > 0
    albedo[known] /= square[known]
    albedo[~known] = np.median(albedo[known]) if known.any() else 0.5
    return albedo
