"""Normals, albedo and light from the brightness of points of a moving object.

The light is fixed in the camera's frame and the object turns by `R_t`, so that a point with the
normal `n` and the albedo `rho` shows ([R05]_ eq. 16 and 28)

    I_t = rho sum_k A_k L_k Y_k(R_t n) = sum_k (D_t L)_k f_k(b),   f_k(b) = rho A_k Y_k(n),

where `b = rho n` is the scaled normal and `D_t` the rotation of coefficients by `R_t^T`. At degree
1 this is `I_t = l0 |b| + (R_t^T l1) . b` ([SFS03]_): linear in the four numbers `(rho, b)` for
known light, and for unknown light in `l1 b^T`, a matrix of rank 1.

What brightness cannot tell:

- the common scale of albedo and light;
- the sign of all normals, with that of the light's odd degrees: the mirror pair. Normals that look
  towards the camera where they are seen decide;
- if the object turns about one axis `e` only, how far normals and light are turned about it, at any
  degree; and at degree 1 the Lorentz transformation of `(rho, b . e)` that keeps
  `rho^2 - (b . e)^2`, with its counterpart of `(l0, l1 . e)`.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
.. [SFS03] Simakov, Frolova and Basri, Dense Shape Reconstruction of a Moving Object under
   Arbitrary, Unknown Lighting, ICCV 2003.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import (
    fibonacci_directions,
    harmonic_gradients,
    real_harmonics,
    rotation_matrices,
)
from harmface.stereo.robust import cauchy_weights, robust_scale

CHUNK = 2**12
"""Points treated at a time: 30 MB for each 100 frames."""

STARTS = 400
"""Directions of the light that are tried, 10 degrees apart."""

NORMALS = 4000
"""Directions of a normal that are tried, 3 degrees apart."""

APART = 25.0
"""Degrees between two minima of the light's direction."""

DECIDING = 300
"""Points that choose between minima."""

SEARCH_STEPS = 20
"""Steps of a normal that is begun anew."""

POINT_STEPS = 4
"""Steps of every point's normal for each step of the light."""

BETTER = 0.9
"""Part of its cost that a search must leave of a point to begin it anew."""

STEPS = 60
"""Most steps of the joint fit at a time."""

SEARCHES = 20
"""Most searches for normals anew, which free points that are caught in a minimum of their own."""

SETTLED = 1e-13
"""Relative change of the fit's cost below which it has settled."""

NOT_KNOWN = 1e6
"""Condition number from which something is taken as not known."""


@dataclass(frozen=True, eq=False)
class TrackedShading:
    """What the brightness of tracked points tells.

    Parameters
    ----------
    scaled_normals
        Albedo times unit normal of every point, in the object's frame of no rotation.
    lighting
        Harmonic coefficients of radiance in the camera's frame, scaled so that the mean albedo
        is a half.
    residual
        Of every observation, in the unit of the images.
    weights
        How far every observation was believed, in [0, 1].
    condition
        Ratio of the best to the worst determined combination of the light's coefficients, beside
        their scale; infinite if one is not determined at all.
    """

    scaled_normals: Float[np.ndarray, "p 3"]
    lighting: Float[np.ndarray, "K"]
    residual: Float[np.ndarray, "F p"]
    weights: Float[np.ndarray, "F p"]
    condition: float

    @property
    def ambiguous(self) -> bool:
        """Whether motion leaves more than the scale unknown."""
        return not self.condition < NOT_KNOWN


def turned_light(
    lighting: Float[np.ndarray, "K"], rotations: Float[np.ndarray, "F 3 3"]
) -> Float[np.ndarray, "F K"]:
    """Return the light that the object sees in each frame, `D_t L`.

    Parameters
    ----------
    lighting
        Coefficients in the camera's frame.
    rotations
        Of the object.

    Returns
    -------
    numpy.ndarray
        Coefficients in the object's frame.
    """
    return light_turns(rotations, int(np.sqrt(len(lighting))) - 1) @ lighting


def light_turns(
    rotations: Float[np.ndarray, "F 3 3"], max_degree: int
) -> Float[np.ndarray, "F K K"]:
    """Return the matrices `D_t` that take the camera's light to the object's frame."""
    turns = np.zeros((len(rotations), harmonic_count(max_degree), harmonic_count(max_degree)))
    for turn, rotation in zip(turns, rotations, strict=True):
        for degree, matrix in enumerate(rotation_matrices(rotation.T, max_degree)):
            block = slice(degree**2, (degree + 1) ** 2)
            turn[block, block] = matrix
    return turns


def shading_basis(
    scaled_normals: Float[np.ndarray, "p 3"], max_degree: int
) -> tuple[Float[np.ndarray, "K p"], Float[np.ndarray, "K p 3"]]:
    """Return `f_k(b) = |b| A_k Y_k(b / |b|)` and its gradient.

    `f` is homogeneous of degree 1, so its gradient is `A_k (Y_k(n) n + grad Y_k(n))`.

    Parameters
    ----------
    scaled_normals
        Not zero.
    max_degree
        Of the harmonics.

    Returns
    -------
    tuple of numpy.ndarray
        Values and gradients.
    """
    albedo = np.linalg.norm(scaled_normals, axis=1)
    normals = scaled_normals / albedo[:, None]
    lambert = lambert_per_coefficient(max_degree)
    values = lambert[:, None] * real_harmonics(normals, max_degree)
    slopes = lambert[:, None, None] * harmonic_gradients(normals, max_degree)
    return albedo * values, values[..., None] * normals + slopes


def fit_tracks(
    brightness: Float[np.ndarray, "_ p"],
    rotations: Float[np.ndarray, "F 3 3"],
    weights: Float[np.ndarray, "..."] | None = None,
    *,
    max_degree: int = 2,
    robust: bool = True,
    start: tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "K"]] | None = None,
) -> TrackedShading:
    """Return scaled normals and light that explain the brightness of tracked points.

    From a closed form at degree 1, or a start that is given, Levenberg's and Marquardt's method
    minimises the weighted squares over the light and all scaled normals at once: the 3 unknowns
    of each point are eliminated (Schur's complement), which leaves one small system for the light.

    Parameters
    ----------
    brightness
        Of each point in each frame, linear.
    rotations
        Of the object in each frame.
    weights
        How far to believe each observation, not negative: 0 where a point is not seen. All alike
        if not given.
    max_degree
        1 or 2.
    robust
        Whether Cauchy's weights let what the fit does not explain count less. They help against
        points that are caught in a minimum of their own; many dark shadows mislead the fit all the
        same where light and normals are both free: give those no weight.
    start
        Scaled normals and light to begin with.

    Returns
    -------
    TrackedShading
        Normals look towards the camera on the average over the frames in which they are seen.

    Raises
    ------
    ArgumentError
        If the object does not turn, shapes do not agree, or a point is seen in fewer than four
        frames.
    """
    brightness = checks.finite("brightness", brightness).astype(np.float64)
    rotations = np.stack([checks.rotation("rotations", each) for each in rotations])
    if brightness.ndim != 2 or len(brightness) != len(rotations):
        raise ArgumentError(
            f"brightness must have shape ({len(rotations)} frames, points), got {brightness.shape}"
        )
    seen = np.ones_like(brightness) if weights is None else checks.non_negative("weights", weights)
    if seen.shape != brightness.shape:
        raise ArgumentError(f"weights must have shape {brightness.shape}, got {seen.shape}")
    if ((seen > 0).sum(axis=0) < 4).any():
        raise ArgumentError("weights must let every point be seen in at least four frames")
    if max_degree not in (1, 2):
        raise ArgumentError(f"max_degree must be 1 or 2, got {max_degree}")
    turns = light_turns(rotations, max_degree)
    fit = PointFit(brightness, turns, max_degree)
    if start is None:
        _check_turns(rotations)
        some, lights = _first_order(brightness, rotations, seen)
        few = PointFit(brightness[:, some], turns, max_degree)
        fits = [
            few.searched(np.pad(each, (0, turns.shape[1] - 4)), seen[:, some]) for each in lights
        ]
        costs = [few.cost(points, found, seen[:, some]) for points, found in fits]
        light = fits[int(np.argmin(costs))][1]
        b, light = fit.searched(light, seen)
    else:
        left = fit.residual(*start)
        believed = cauchy_weights(left, robust_scale(left[seen > 0])) if robust else 1.0
        b, light = fit.settled(*start, seen * believed)
    used = seen
    for _ in range(4 if robust else 0):
        residual = fit.residual(b, light)
        used = seen * cauchy_weights(residual, robust_scale(residual[seen > 0]))
        b, light = fit.settled(b, light, used)
        found = best_normals(brightness, seen, turns @ light, max_degree)
        found = fit.points(found, light, seen, steps=SEARCH_STEPS)
        b = fit.points(found, light, seen, b)
    facing = np.einsum("fp,fi,pi->", seen, rotations[:, 2], b)
    if facing < 0:
        # The mirror pair: harmonics of degree 1 change their sign with the normals.
        b, light = -b, np.concatenate([light[:1], -light[1:4], light[4:]])
    condition = fit.condition(b, light, used)
    scale = 2 * float(np.linalg.norm(b, axis=1).mean())
    return TrackedShading(b / scale, light * scale, fit.residual(b, light), used, condition)


def _check_turns(rotations: Float[np.ndarray, "F 3 3"]) -> None:
    cosine = (np.einsum("ij,fij->f", rotations[0], rotations) - 1) / 2
    if np.arccos(np.clip(cosine, -1, 1)).max() < 1e-6:
        raise ArgumentError(
            "rotations must differ: without a turn of the object its brightness stays as it is "
            "and tells nothing of its normals"
        )


def _first_order(
    brightness: Float[np.ndarray, "F p"],
    rotations: Float[np.ndarray, "F 3 3"],
    seen: Float[np.ndarray, "F p"],
) -> tuple[np.ndarray, list[Float[np.ndarray, "4"]]]:
    """Return some points, and light of degree 1 that explains them, by trying its direction.

    For a direction `l` the four numbers `(rho l0, b)` of a point are linear. What is left of the
    squares over all directions has few minima: all of them, the least first.
    """
    frames = len(rotations)
    design = np.concatenate([np.ones((frames, 1)), rotations.reshape(frames, 9)], axis=1)
    # No more points than decide on two angles.
    some = np.linspace(0, brightness.shape[1] - 1, min(DECIDING, brightness.shape[1])).astype(int)
    weighted = seen[:, some]
    normal = np.einsum("fp,fi,fj->pij", weighted, design, design)
    right = np.einsum("fp,fi->pi", weighted * brightness[:, some], design)

    def explained(direction: np.ndarray) -> float:
        matrix, vector = _along(normal, right, direction)
        return float(
            np.einsum("pi,pi->", vector, np.linalg.solve(matrix, vector[..., None])[..., 0])
        )

    # The mirror pair: one half of the directions will do.
    directions = fibonacci_directions(STARTS)
    directions = directions[directions[:, 2] >= 0]
    costs = np.array([-explained(each) for each in directions])
    near = directions @ directions.T > np.cos(np.radians(APART))
    minima = [i for i in np.argsort(costs) if costs[i] == costs[near[i]].min()]
    y0, _, y1, _ = lambert_per_coefficient(1) * real_harmonics(np.array([0.0, 0, 1]), 1)
    starts = []
    for best in directions[minima]:
        matrix, vector = _along(normal, right, best)
        solved = np.linalg.solve(matrix, vector[..., None])[..., 0]
        constant, b = solved[:, 0], solved[:, 1:]
        size = np.linalg.norm(b, axis=1)
        ambient = float(constant @ size / (size @ size))
        # Harmonics 1, 2, 3 are y, z, x.
        starts.append(np.array([ambient / y0, best[1] / y1, best[2] / y1, best[0] / y1]))
    return some, starts


def _along(
    normal: Float[np.ndarray, "p 10 10"],
    right: Float[np.ndarray, "p 10"],
    direction: Float[np.ndarray, "3"],
) -> tuple[Float[np.ndarray, "p 4 4"], Float[np.ndarray, "p 4"]]:
    """Return the equations of `(rho l0, b)` for one direction of the light."""
    take = np.zeros((10, 4))
    take[0, 0] = 1
    # R^T l . b = sum_ij R_ij l_i b_j
    take[1:, 1:] = np.kron(direction[:, None], np.eye(3))
    matrix = take.T @ normal @ take
    # Rotation about one axis leaves a combination free: the smallest solution is taken.
    ridge = 1e-10 * np.einsum("pii->p", matrix)
    return matrix + ridge[:, None, None] * np.eye(4), right @ take


def best_normals(
    brightness: Float[np.ndarray, "F p"],
    weights: Float[np.ndarray, "F p"],
    lights: Float[np.ndarray, "F K"],
    max_degree: int,
) -> Float[np.ndarray, "p 3"]:
    """Return the scaled normals, of a grid of directions, that fit best under known light.

    Parameters
    ----------
    brightness, weights
        Of each point in each frame.
    lights
        What the object sees in each frame.
    max_degree
        Of the harmonics.

    Returns
    -------
    numpy.ndarray
        Scaled normals.
    """
    directions = fibonacci_directions(NORMALS)
    shown = lights @ shading_basis(directions, max_degree)[0]
    along = shown.T @ (weights * brightness)
    square = np.maximum((shown**2).T @ weights, np.finfo(float).tiny)
    best = np.argmax(np.maximum(along, 0) ** 2 / square, axis=0)
    each = np.arange(brightness.shape[1])
    albedo = np.maximum(along[best, each], np.finfo(float).tiny) / square[best, each]
    return albedo[:, None] * directions[best]


class PointFit:
    """Weighted least squares over light and scaled normals."""

    def __init__(
        self,
        brightness: Float[np.ndarray, "F p"],
        turns: Float[np.ndarray, "F K K"],
        max_degree: int,
    ) -> None:
        self.brightness, self.turns, self.max_degree = brightness, turns, max_degree

    def cost(
        self,
        b: Float[np.ndarray, "p 3"],
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
    ) -> float:
        """Return the weighted squares of what the model leaves."""
        return float((weights * self.residual(b, light) ** 2).sum())

    def residual(
        self, b: Float[np.ndarray, "p 3"], light: Float[np.ndarray, "K"]
    ) -> Float[np.ndarray, "F p"]:
        """Return what the model leaves of the images."""
        values, _ = shading_basis(b, self.max_degree)
        return self.brightness - (self.turns @ light) @ values

    def _equations(
        self,
        b: Float[np.ndarray, "p 3"],
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
        damping: float,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the light's system, and what brings the points' steps back from the light's."""
        count = len(light)
        system, rest = np.zeros((count, count)), np.zeros(count)
        inverse, mixed, own = (
            np.empty((len(b), 3, 3)),
            np.empty((len(b), 3, count)),
            np.empty_like(b),
        )
        lights = self.turns @ light
        for first in range(0, len(b), CHUNK):
            some = slice(first, first + CHUNK)
            values, slopes = shading_basis(b[some], self.max_degree)
            residual = self.brightness[:, some] - lights @ values
            w = weights[:, some]
            by_point = np.einsum("fk,kpi->fpi", lights, slopes)
            # values_k D_tkj: what each coefficient of the light adds to each observation.
            by_light = np.einsum("kp,fkj->fpj", values, self.turns, optimize=True)
            weighted = w[..., None] * by_point
            square = np.einsum("fpi,fpj->pij", weighted, by_point)
            trace = np.einsum("pii->p", square) + np.finfo(float).tiny
            square += ((damping + 1e-14) * trace)[:, None, None] * np.eye(3)
            inverse[some] = np.linalg.inv(square)
            mixed[some] = np.einsum("fpi,fpj->pij", weighted, by_light, optimize=True)
            own[some] = np.einsum("fpi,fp->pi", weighted, residual)
            reduced = inverse[some] @ mixed[some]
            weighted_light = w[..., None] * by_light
            system += np.einsum("fpi,fpj->ij", weighted_light, by_light, optimize=True)
            system -= np.einsum("pki,pkj->ij", mixed[some], reduced)
            rest += np.einsum("fpi,fp->i", weighted_light, residual)
            rest -= np.einsum("pki,pk->i", reduced, own[some])
        return system, rest, inverse, mixed, own

    def points(
        self,
        b: Float[np.ndarray, "p 3"],
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
        otherwise: Float[np.ndarray, "p 3"] | None = None,
        steps: int = POINT_STEPS,
        near: tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "p"]] | None = None,
    ) -> Float[np.ndarray, "p 3"]:
        """Return scaled normals that fit better under known light, each point on its own.

        Parameters
        ----------
        b, light, weights
            As they stand.
        otherwise
            Scaled normals to begin with where they are better.
        steps
            How many.
        near
            Unit normals to stay near, and the weights of the squared parts of `b` across them.
        """
        lights = self.turns @ light
        new = np.empty_like(b)
        for first in range(0, len(b), CHUNK):
            some = slice(first, first + CHUNK)
            shown, w, at = self.brightness[:, some], weights[:, some], b[some]
            pull = np.zeros((len(at), 3, 3))
            if near is not None:
                normal, stiff = near[0][some], near[1][some]
                pull = stiff[:, None, None] * (np.eye(3) - normal[:, :, None] * normal[:, None])

            def left(
                at: np.ndarray,
                shown: np.ndarray = shown,
                w: np.ndarray = w,
                pull: np.ndarray = pull,
            ) -> np.ndarray:
                values, _ = shading_basis(at, self.max_degree)
                misfit = (w * (shown - lights @ values) ** 2).sum(axis=0)
                return misfit + np.einsum("pi,pij,pj->p", at, pull, at)

            cost = left(at)
            if otherwise is not None:
                before = left(otherwise[some])
                at = np.where((before < cost)[:, None], otherwise[some], at)
                cost = np.minimum(before, cost)
            damping = np.full(len(at), 1e-3)
            for _ in range(steps):
                values, slopes = shading_basis(at, self.max_degree)
                by_point = np.einsum("fk,kpi->fpi", lights, slopes)
                weighted = w[..., None] * by_point
                square = np.einsum("fpi,fpj->pij", weighted, by_point) + pull
                trace = np.einsum("pii->p", square) + np.finfo(float).tiny
                square += (damping * trace)[:, None, None] * np.eye(3)
                own = np.einsum("fpi,fp->pi", weighted, shown - lights @ values)
                own -= np.einsum("pij,pj->pi", pull, at)
                tried = at + np.linalg.solve(square, own[..., None])[..., 0]
                tried_cost = left(tried)
                better = tried_cost < cost
                at = np.where(better[:, None], tried, at)
                cost = np.where(better, tried_cost, cost)
                damping = np.where(better, damping / 30, damping * 10)
            new[some] = at
        return new

    def settled(
        self,
        b: Float[np.ndarray, "p 3"],
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
    ) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "K"]]:
        """Return the scaled normals and the light where steps no longer lower the cost."""
        damping = 1e-4
        cost = self.cost(b, light, weights)
        for _ in range(STEPS):
            system, rest, inverse, mixed, own = self._equations(b, light, weights, damping)
            scale = np.trace(system) / len(light)
            # Scale is free, and perhaps more: the shortest step.
            change = np.linalg.lstsq(
                system + damping * scale * np.eye(len(light)), rest, rcond=1e-13
            )[0]
            new_light = light + change
            step = np.einsum("pij,pj->pi", inverse, own - mixed @ change)
            new = self.points(b + step, new_light, weights, otherwise=b)
            new_cost = self.cost(new, new_light, weights)
            if new_cost < cost:
                done = cost - new_cost < SETTLED * cost
                b, light, cost, damping = new, new_light, new_cost, damping / 10
                if done:
                    break
            else:
                damping = max(damping, 1e-12) * 10
                if damping > 1e4:
                    break
        return b, light

    def searched(
        self,
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
    ) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "K"]]:
        """Return what `settled` returns, each point begun anew wherever its cost is least.

        For one light and one normal the albedo is linear, so a point's cost is known for all
        directions at once.
        """
        begun = best_normals(self.brightness, weights, self.turns @ light, self.max_degree)
        b, light = self.settled(begun, light, weights)
        for _ in range(SEARCHES):
            cost = (weights * self.residual(b, light) ** 2).sum(axis=0)
            found = best_normals(self.brightness, weights, self.turns @ light, self.max_degree)
            found = self.points(found, light, weights, steps=SEARCH_STEPS)
            better = (weights * self.residual(found, light) ** 2).sum(axis=0) < BETTER * cost
            if not better.any():
                break
            b, light = self.settled(np.where(better[:, None], found, b), light, weights)
        return b, light

    def condition(
        self,
        b: Float[np.ndarray, "p 3"],
        light: Float[np.ndarray, "K"],
        weights: Float[np.ndarray, "F p"],
    ) -> float:
        """Return the condition number of the light's system but for the common scale."""
        system, *_ = self._equations(b, light, weights, 0.0)
        # What the images would tell of the light if the normals were known.
        design = np.einsum("kp,fkj->fpj", shading_basis(b, self.max_degree)[0], self.turns)
        told = np.einsum("fp,fpi,fpj->ij", weights, design, design, optimize=True)
        least = np.linalg.eigvalsh(system)[1]
        best = np.linalg.eigvalsh(told)[-1]
        return float(np.sqrt(best / least)) if least > 0 else float("inf")
