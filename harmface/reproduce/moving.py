"""Claims on a moving object under light that stands still."""

import numpy as np

from data_synth.environments import ENVIRONMENTS, rasterise
from harmface.light import EnvironmentMap
from harmface.moving import Views, fit_tracks, surface_from_film
from harmface.moving.film import FilmSurface
from harmface.moving.shading import shading_basis, turned_light
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.films import Film, film_head, film_light, rendered_film, turns
from harmface.stereo import angular_errors

TWO_AXES = "yaw:-30:30,pitch:-10:10"
ONE_AXIS = "yaw:-60:60"
POINTS, FRAMES = 100, 30
HEAD, SIZE, HEAD_FRAMES = 4, 96, 30


def _points(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return albedos and unit normals of points that look towards the camera."""
    normals = rng.standard_normal((POINTS, 3))
    normals[:, 2] = np.abs(normals[:, 2]) + 0.3
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return rng.uniform(0.2, 1, POINTS), normals


def light_degree_1() -> Measurement:
    """Recover normals of tracked points from exact images of degree 1, light unknown."""
    rng = np.random.default_rng(0)
    rotations = turns(TWO_AXES, FRAMES)
    worst, conditions = 0.0, []
    for _ in range(5):
        albedo, normals = _points(rng)
        lighting = np.array([2.0, *(0.4 * rng.standard_normal(3))])
        shown = turned_light(lighting, rotations) @ shading_basis(albedo[:, None] * normals, 1)[0]
        found = fit_tracks(shown, rotations, max_degree=1, robust=False)
        conditions.append(found.condition)
        length = np.linalg.norm(found.scaled_normals, axis=1, keepdims=True)
        worst = max(worst, float(angular_errors(found.scaled_normals / length, normals).max()))
    return Measurement(
        [worst],
        f"{POINTS} points, {FRAMES} frames that turn by {TWO_AXES}, five lights drawn at random; "
        f"condition numbers {min(conditions):.0f} to {max(conditions):.0f}.",
    )


def one_axis() -> Measurement:
    """Show two surfaces whose films are the same where the object turns about one axis."""
    rng = np.random.default_rng(0)
    albedo, normals = _points(rng)
    rotations = turns(ONE_AXIS, FRAMES)
    lighting = np.array([2.0, *(0.4 * rng.standard_normal(3))])
    shown = turned_light(lighting, rotations) @ shading_basis(albedo[:, None] * normals, 1)[0]
    # The axis is y: boost (albedo, b_y), and what l0 and l1_y are multiplied by, inversely.
    speed = 0.2
    boost = np.array([[np.cosh(speed), np.sinh(speed)], [np.sinh(speed), np.cosh(speed)]])
    scaled = albedo[:, None] * normals
    scaled[:, 1] = (boost @ np.stack([albedo, scaled[:, 1]]))[1]
    unit = shading_basis(np.eye(3), 1)[0]
    factors = np.array([unit[0, 0], unit[1, 1]])
    other = lighting.copy()
    other[:2] = np.linalg.solve(boost.T, lighting[:2] * factors) / factors
    again = turned_light(other, rotations) @ shading_basis(scaled, 1)[0]
    length = np.linalg.norm(scaled, axis=1, keepdims=True)
    apart = angular_errors(scaled / length, normals)
    found = fit_tracks(shown, rotations, max_degree=1, robust=False)
    about_two = turns(TWO_AXES, FRAMES)
    shown_two = turned_light(lighting, about_two) @ shading_basis(albedo[:, None] * normals, 1)[0]
    two = fit_tracks(shown_two, about_two, max_degree=1, robust=False)
    return Measurement(
        [float(np.abs(again - shown).max() / shown.max())],
        f"Normals of the two surfaces differ by {apart.mean():.1f} degrees on the average, up to "
        f"{apart.max():.1f}. The condition number is {found.condition:.2g} about one axis and "
        f"{two.condition:.2g} about two.",
    )


def head_errors(film: Film, found: FilmSurface) -> tuple[np.ndarray, np.ndarray]:
    """Return errors of normals in degrees, and of depth as a share of the head's, at its pixels.

    Parameters
    ----------
    film
        With the true surface.
    found
        What was made of it.

    Returns
    -------
    tuple of numpy.ndarray
        One number a pixel whose ray meets the true surface.
    """
    mesh, grid = film.mesh, found.rays
    starts = grid.origins - 4 * mesh.rays.radius * grid.directions
    hits = mesh.rays.first_hits(mesh.rays.local(starts), grid.directions)
    met = hits.face >= 0
    weights = np.stack([1 - hits.u - hits.v, hits.u, hits.v], axis=1)[met]
    corners = mesh.faces[hits.face[met]]
    places = np.einsum("nc,nci->ni", weights, mesh.vertices[corners])
    normals = np.einsum("nc,nci->ni", weights, mesh.normals[corners])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    true = np.einsum("ni,ni->n", places - grid.origins[met], grid.directions[met])
    depth = found.depth[grid.mask][met]
    turned = normals @ film.views.rotations[found.frame].T
    angles = angular_errors(found.normals[grid.mask][met], turned)
    return angles, np.abs(depth - true) / float(np.ptp(mesh.vertices[:, 2]))


def head() -> Measurement:
    """Recover a head without texture from a film by the oracle, poses known."""
    studio = EnvironmentMap.from_image(rasterise(ENVIRONMENTS["studio"](), 64))
    film = rendered_film(
        film_head(HEAD, plain=True),
        turns(TWO_AXES, HEAD_FRAMES),
        film_light(studio),
        SIZE,
        noise=0.01,
        rng=np.random.default_rng(0),
    )
    views: Views = film.views
    angles, depth = head_errors(film, surface_from_film(film.frames, film.masks, views))
    plain = surface_from_film(film.frames, film.masks, views, shading=False)
    plain_angles, plain_depth = head_errors(film, plain)
    return Measurement(
        [float(angles.mean()), 100 * float(depth.mean())],
        f"Head {HEAD} of one albedo, {HEAD_FRAMES} frames of {SIZE} x {SIZE}, {TWO_AXES}, 1 % "
        "noise, cast shadows, all pixels of the silhouette. Medians "
        f"{np.median(angles):.1f} degrees and {100 * np.median(depth):.2f} %. Matching by "
        f"brightness alone, the same otherwise: {plain_angles.mean():.1f} degrees and "
        f"{100 * plain_depth.mean():.2f} %.",
    )
