"""Normals under lamps so near that their light changes over the surface.

A lamp at P gives the surface point X with normal n and albedo a

    I = a e |P|^2 n . (P - X) / |P - X|^3,

e being its irradiance on a surface that faces it in the origin ([QDC18]_ eq. 2.2 for a lamp that
shines alike to all sides). So the direction to the lamp, and by the inverse square its strength,
depend on where the point is: its place in the picture is known, its height z is not. The view is
orthographic. Given z, each pixel is three linear equations or more; given normals, z is their
integral; alternating settles within a few rounds, as a change of z by d turns the lamp's direction
by d / |P| at most.

References
----------
.. [QDC18] Queau, Durix, Wu, Cremers, Lauze and Durou, LED-Based Photometric Stereo: Modeling,
   Calibration and Numerical Solution, Journal of Mathematical Imaging and Vision 2018.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import depth_least_squares, facing_camera
from harmface.stereo.factorization import interleaved
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.known_lights import EQUAL, UNKNOWNS, few_seen, robust_weights
from harmface.stereo.lamp_strengths import strengths_by_elimination
from harmface.stereo.result import Recovered
from harmface.stereo.stack import ImageStack
from harmface.stereo.uncertainty import beside_neighbours, error_of_fit

NEAREST = 0.5
"""Distance from the object's middle, in its widths, of lamps that touch it."""

FAR = 30.0
"""Distance from which an object's sides see a lamp within a degree of where its middle does."""

ROUNDS = 30
"""Most alternations of normals and depth."""

SETTLED = 2e-4
"""Median change of the depth, in widths, that turns the lamps by a fiftieth of a degree at most."""

REWEIGHTED = 10
"""Reweightings of the robust fit, in which residuals settle."""


@dataclass(frozen=True, eq=False)
class NearFit:
    """Structure under near lamps.

    Parameters
    ----------
    b
        Scaled normals.
    depth
        Height towards the viewer, in widths of the object, about its mean.
    strengths
        Irradiance by each lamp on a surface that faces it in the object's middle.
    vectors
        The lamps as each pixel sees them: direction times irradiance.
    weights
        How much each observation counted.
    converged
        Whether the depth settled.
    """

    b: Float[np.ndarray, "p 3"]
    depth: Float[np.ndarray, "p"]
    strengths: Float[np.ndarray, "F"]
    vectors: Float[np.ndarray, "F p 3"]
    weights: Float[np.ndarray, "F p"]
    converged: bool


def fit_near_lamps(
    stack: ImageStack,
    positions: Float[np.ndarray, "F 3"],
    strengths: Float[np.ndarray, "F"] | None = None,
    *,
    progress: Callable[[float], None] = lambda done: None,
) -> NearFit:
    """Return scaled normals and depth under lamps at known places, see the module's text.

    Parameters
    ----------
    stack
        Photographs, in float64, the camera far away.
    positions
        Of the lamps, x right, y up, z towards the camera, in units of the width of the mask, from
        the middle of its bounding box, at the mean height of the surface.
    strengths
        See `NearFit`; of mean one, and found from the images if not given.
    progress
        Told the share of the work that is done.

    Raises
    ------
    ArgumentError
        If positions are not one for each image, touch the object, lie in one plane with it, or fit
        the photographs so badly that a strength is not positive.
    """
    positions = checked_positions(positions, len(stack.values))
    place, width = _places(stack.mask)
    usable = stack.usable
    enough = usable.sum(axis=0) >= UNKNOWNS
    weights = usable.astype(np.float64)
    depth = np.zeros(len(place))
    converged = False
    b = np.zeros((len(place), 3))
    for number in range(ROUNDS):
        points = np.concatenate([place, depth[:, None]], axis=1)
        unit = lamp_vectors(positions, points)
        found = (
            strengths_by_elimination(stack.values, unit, weights)
            if strengths is None
            else strengths
        )
        vectors = unit * found[:, None, None]
        b, weights = _robust(stack.values, vectors, usable)
        moved = _depth(stack, b, enough) / width
        # A pixel at the rim may go back and forth between two outliers for ever.
        change = float(np.median(np.abs(moved - depth)))
        converged = change < SETTLED
        depth = moved
        progress(1.0 if converged else (number + 1) / ROUNDS)
        if converged:
            break
    return NearFit(b, depth, found, vectors, weights, converged)


def under_near_lamps(
    stack: ImageStack,
    positions: Float[np.ndarray, "F 3"],
    strengths: Float[np.ndarray, "F"] | None,
    progress: Callable[[float], None],
) -> Recovered:
    """Return the structure under near lamps with its expected error, see `fit_near_lamps`."""
    fit = fit_near_lamps(stack, positions, strengths, progress=progress)
    noise = np.empty(len(fit.b))
    for some in interleaved(len(noise), 32 * len(positions)):
        vectors, b = fit.vectors[:, some], fit.b[some]
        shading = np.einsum("fpi,pi->fp", vectors, b)
        lit = (shading > 0)[..., None]
        residual = stack.values[:, some] - np.maximum(shading, 0)
        noise[some] = error_of_fit(vectors * lit, residual, b, fit.weights[:, some])
    few = stack.usable.sum(axis=0) < UNKNOWNS
    noise = beside_neighbours(directions_of(fit.b), stack.mask, noise)
    distance = np.linalg.norm(positions, axis=1)
    warnings = few_seen(few)
    if strengths is None and len(positions) <= UNKNOWNS:
        warnings += (EQUAL,)
    if not fit.converged:
        warnings += ("normals and depth did not settle; are the positions right?",)
    if (distance > FAR).all():
        warnings += (
            f"all lamps are more than {FAR:.0f} of the object's widths away, where nearness makes "
            "no difference; positions are in units of that width",
        )
    return Recovered(
        "known-lights",
        fit.b,
        np.where(few, 90.0, noise),
        None,
        "light",
        light_model="near points",
        converged=fit.converged,
        lamps=(fit.strengths / distance)[:, None] * positions,
        warnings=warnings,
    )


def checked_positions(positions: Float[np.ndarray, "F 3"], images: int) -> Float[np.ndarray, "F 3"]:
    """Return positions of lamps in float64 if there may be a lamp at each."""
    positions = checks.finite("positions", checks.vectors("positions", positions))
    positions = positions.astype(np.float64)
    if positions.shape != (images, 3):
        raise ArgumentError(
            f"positions must be one for each of the {images} images, got shape {positions.shape}"
        )
    distance = np.linalg.norm(positions, axis=1)
    if (distance < NEAREST).any():
        raise ArgumentError(
            f"positions must be in units of the object's width from its middle, but one is "
            f"{distance.min():.2g} from it, within the object; divide lengths by the width"
        )
    singular = np.linalg.svd(positions / distance[:, None], compute_uv=False)
    if len(positions) < UNKNOWNS or singular[2] < 1e-3 * singular[0]:
        raise ArgumentError(
            "positions must not all lie in one plane with the object's middle; add a photograph "
            "with light from outside it"
        )
    return positions


def lamp_vectors(
    positions: Float[np.ndarray, "F 3"], points: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "F p 3"]:
    """Return `|P|^2 (P - X) / |P - X|^3`: direction times irradiance, 1 in the origin."""
    towards = positions[:, None] - points
    squared = (positions**2).sum(axis=1)[:, None, None]
    return np.asarray(squared * towards / np.linalg.norm(towards, axis=2, keepdims=True) ** 3)


def _places(mask: Bool[np.ndarray, "H W"]) -> tuple[Float[np.ndarray, "p 2"], float]:
    """Return x and y of each pixel in widths of the mask from its middle, and that width."""
    rows, columns = np.nonzero(mask)
    width = float(np.ptp(columns) + 1)
    x = columns - (columns.min() + columns.max()) / 2
    y = (rows.min() + rows.max()) / 2 - rows
    return np.stack([x, y], axis=1) / width, width


def _robust(
    values: Float[np.ndarray, "F p"],
    vectors: Float[np.ndarray, "F p 3"],
    usable: Bool[np.ndarray, "F p"],
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals of pixels under lamps of their own, and the observations' weights.

    Weights start afresh: what a wrong depth took for a shadow may be none.
    """
    b, weights = np.empty((values.shape[1], 3)), usable.astype(np.float64)
    for some in interleaved(len(b), 32 * len(values)):
        allowed, light = usable[:, some], vectors[:, some]
        for _ in range(REWEIGHTED):
            b[some] = _solved(values[:, some], light, weights[:, some])
            predicted = np.einsum("fpi,pi->fp", light, b[some])
            weights[:, some] = robust_weights(values[:, some], predicted, allowed)
    return b, weights


def _solved(
    values: Float[np.ndarray, "F p"],
    vectors: Float[np.ndarray, "F p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "p 3"]:
    """Return the least squares solution of each pixel."""
    rows = vectors.swapaxes(0, 1)
    weighted = (rows * weights.T[..., None]).swapaxes(1, 2)
    normal = weighted @ rows
    # Of pixels seen by fewer than three lamps the shortest solution.
    floor = 1e-9 * np.einsum("pii->p", normal) + np.finfo(np.float64).tiny
    normal += floor[:, None, None] * np.eye(3)
    return np.linalg.solve(normal, weighted @ values.T[..., None])[..., 0]


def _depth(
    stack: ImageStack, b: Float[np.ndarray, "p 3"], enough: Bool[np.ndarray, "p"]
) -> Float[np.ndarray, "p"]:
    """Return the integral of the normals, in pixels, that of the nearest where there is none."""
    n = directions_of(b)
    n[~n.any(axis=1)] = (0.0, 0.0, 1.0)
    normals = stack.picture(n)
    facing = facing_camera(normals, stack.mask)
    known = facing.copy()
    known[stack.mask] &= enough
    if not known.any():
        known = facing
    depth = depth_least_squares(normals, known)
    nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return depth[tuple(nearest)][stack.mask]
