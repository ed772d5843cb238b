"""The last stage: scaled normals that belong to one surface, the light being fixed.

Each pixel's scaled normal b has three numbers, but a surface z(x, y) gives two of them:
`b = s m` with `m = (-z_x, -z_y, 1)`. So neighbours share z, which halves the noise, and pixels
that light hardly reaches take their normals from those around. Three things must not be spoilt:
no grid of depths follows a surface exactly, least of all at a crease or a rim; a jump in depth
has slopes that no pixel shows; and pixels with good data need no help. So each pixel may leave
the surface, at a price, and b and z minimise

    E(b, z) = sum_fp w (M - f(l, b))^2 / 2
              + noise^2 sum_p rho(min_{s >= 0} |b - s m| / (GIVE |b_0|))
              + noise^2 sum_k rho(K d_k),

with b_0 the scaled normals given, K the smoothness, d_k second differences of z, and Cauchy's
`rho(t) = C^2 / 2 log(1 + (t / C)^2)`, C = 2.385, which forgives jumps. Without noise only the
data counts, and b stays what it was.

z is a bicubic spline and d_k are those of its coefficients, see `depth_spline`. Gauss-Newton: rho
is majorised by a square, the data replaced by its quadratic, and b and s, which then have closed
forms for given z, are eliminated pixel by pixel [GP03]_.

References
----------
.. [GP03] Golub and Pereyra, Separable Nonlinear Least Squares: the Variable Projection Method and
   its Applications, Inverse Problems 2003.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.slopes import STEEPEST
from harmface.stereo.depth_spline import DepthSpline, spline_over
from harmface.stereo.factorization import chunks, interleaved
from harmface.stereo.light_models import LightModel
from harmface.stereo.robust import CAUCHY, ROUNDING, cauchy_weights, robust_scale
from harmface.stereo.stack import ImageStack

GIVE = 0.005
"""Distance, relative to |b|, that a pixel is expected to keep from the surface: 0.3 degrees."""

LEAST_SMOOTHNESS = 0.1
"""Of surfaces that nothing is known of: it carries z over pixels that the data leave free."""

DARKEST = 0.05
"""Length of b, relative to the mean, below which it is too dark to have a direction."""

ROUNDS = 5
"""Reweightings of the surface that the iteration starts from."""

STEPS = 20
"""Most steps taken."""

TOLERANCE = 1e-3
"""Relative fall of the energy below which the fit has converged."""

HALVINGS = 10
"""Of a step, before it is given up."""

PART = 0.25
"""Share of its way that a pixel goes if the whole is too far."""


@dataclass(frozen=True, eq=False)
class IntegrableFit:
    """Scaled normals of one surface.

    Parameters
    ----------
    depth
        Height z towards the viewer, in pixels, mean zero. The heights of parts of the mask that do
        not touch, and of the sides of a jump, are arbitrary.
    spline
        Coefficients of z on the mask's grid with a margin of one, see `depth_spline`.
    b
        Scaled normals.
    normals
        Unit normals: of b, and of the surface where b is too dark to have a direction.
    noise
        Standard deviation of an observation, as found or given.
    energies
        E of the module's text at the start and after each step taken: it never grows.
    converged
        Whether the last step changed the energy by less than `TOLERANCE`, or none lowered it.
    """

    depth: Float[np.ndarray, "p"]
    spline: Float[np.ndarray, "H2 W2"]
    b: Float[np.ndarray, "p 3"]
    normals: Float[np.ndarray, "p 3"]
    noise: float
    energies: Float[np.ndarray, "n"]
    converged: bool


def fit_integrable(
    values: Float[np.ndarray, "F p"],
    mask: Bool[np.ndarray, "H W"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    *,
    weights: Float[np.ndarray, "F p"] | None = None,
    noise: float | None = None,
    smoothness: float = 1.0,
) -> IntegrableFit:
    """Return scaled normals and depth that minimise the energy of the module's text.

    The view is orthographic and a pixel has unit size.

    Parameters
    ----------
    values
        Images as rows of the mask's pixels.
    mask
        The pixels.
    model, light
        How light makes an image, and the light of each.
    b
        Scaled normals of each pixel by itself, x right, y up, z towards the viewer.
    weights
        Of the observations; 1 if not given.
    noise
        Standard deviation of an observation; found from what b leaves of the images if not given.
    smoothness
        Of the surface: its slopes are expected to change by about 1 / smoothness from a pixel to
        the next, rarely by much more. 1 expects next to nothing; 3 helps where images are few or
        noisy; below `LEAST_SMOOTHNESS` it has no effect.

    Raises
    ------
    ArgumentError
        If mask and images differ in pixels, b is zero everywhere, smoothness or noise are
        negative, or the noise is to be found where no pixel has more than three observations.
    """
    if not mask.sum() == values.shape[1] == len(b):
        raise ArgumentError(
            f"mask must cover the pixels of images and b, got {mask.sum()} for {values.shape[1]} "
            f"and {len(b)}"
        )
    if not 0 <= smoothness < np.inf:
        raise ArgumentError(f"smoothness must be at least 0 and finite, got {smoothness}")
    if noise is not None and not 0 <= noise < np.inf:
        raise ArgumentError(f"noise must be at least 0 and finite, got {noise}")
    b = checks.finite("b", b).astype(np.float64)
    if weights is None:
        weights = np.broadcast_to(1.0, values.shape)
    if noise is None:
        noise = _noise(values, model, light, b, weights)
    length = np.linalg.norm(b, axis=1)
    if not length.any():
        raise ArgumentError("b must not be zero at every pixel")
    least = DARKEST * float(length.mean())
    problem = _Problem(
        values,
        model,
        light,
        weights,
        spline_over(mask),
        # Rounding is no noise, and the surface must have some say where there is no data.
        max(noise, ROUNDING * float(np.abs(values).mean())) ** 2,
        GIVE * np.maximum(length, least),
        max(smoothness, LEAST_SMOOTHNESS),
    )
    state = _start(problem, b)
    energies = [state.energy]
    converged = False
    for _ in range(STEPS):
        better = _step(problem, state)
        converged = better is None or state.energy - better.energy <= TOLERANCE * state.energy
        if better is not None:
            state = better
            energies.append(state.energy)
        if converged:
            break
    z = problem.surface.depth @ state.coefficients
    dark = np.linalg.norm(state.b, axis=1) < least
    direction = np.where(dark[:, None], state.m, state.b)
    return IntegrableFit(
        z - z.mean(),
        # The splines add up to one, so this is the same shift.
        problem.surface.picture(state.coefficients - z.mean()),
        state.b,
        direction / np.linalg.norm(direction, axis=1, keepdims=True),
        noise,
        np.array(energies),
        converged,
    )


def of_one_surface(
    stack: ImageStack,
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
    smoothness: float,
) -> Float[np.ndarray, "p 3"]:
    """Return the scaled normals of `fit_integrable`, those too dark turned to the surface's."""
    fit = fit_integrable(
        stack.values, stack.mask, model, light, b, weights=weights, smoothness=smoothness
    )
    return fit.normals * np.linalg.norm(fit.b, axis=1, keepdims=True)


@dataclass(frozen=True, eq=False)
class _Problem:
    values: Float[np.ndarray, "F p"]
    model: LightModel
    light: Float[np.ndarray, "F q"]
    weights: Float[np.ndarray, "F p"]
    surface: DepthSpline
    variance: float
    give: Float[np.ndarray, "p"]
    smoothness: float

    def misfit(self, b: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
        """Return the energy of each pixel's observations."""
        found = np.empty(len(b))
        for some in chunks(len(b), 8 * len(self.values)):
            residual = self.values[:, some] - self.model.predict(self.light, b[some])
            found[some] = np.einsum("fp,fp,fp->p", self.weights[:, some], residual, residual) / 2
        return found

    def leaving(
        self, b: Float[np.ndarray, "p 3"], m: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "p"]:
        """Return how far each pixel is from the surface, relative to what it may."""
        s = np.maximum(np.einsum("pi,pi->p", b, m), 0) / np.einsum("pi,pi->p", m, m)
        return np.linalg.norm(b - s[:, None] * m, axis=1) / self.give

    def energies(
        self, b: Float[np.ndarray, "p 3"], m: Float[np.ndarray, "p 3"]
    ) -> Float[np.ndarray, "p"]:
        """Return the energy of each pixel, m = (-z_x, -z_y, 1) being the surface's normals."""
        return self.misfit(b) + self.variance * _cauchy(self.leaving(b, m))

    def bending(self, coefficients: Float[np.ndarray, "n"]) -> Float[np.ndarray, "k"]:
        """Return second differences relative to what is expected of them."""
        return np.asarray(self.smoothness * (self.surface.bends @ coefficients))

    def tangent_normals(self, coefficients: Float[np.ndarray, "n"]) -> Float[np.ndarray, "p 3"]:
        """Return (-z_x, -z_y, 1)."""
        slopes = (self.surface.slopes @ coefficients).reshape(2, -1)
        return np.stack([-slopes[0], -slopes[1], np.ones(slopes.shape[1])], axis=1)


@dataclass(frozen=True, eq=False)
class _State:
    """Unknowns, the surface's normals m = (-z_x, -z_y, 1), and the energy."""

    coefficients: Float[np.ndarray, "n"]
    m: Float[np.ndarray, "p 3"]
    b: Float[np.ndarray, "p 3"]
    energy: float


def _best(
    problem: _Problem,
    coefficients: Float[np.ndarray, "n"],
    m: Float[np.ndarray, "p 3"],
    candidates: list[Float[np.ndarray, "p 3"]],
) -> _State:
    """Return the state in which each pixel has the candidate of least energy."""
    b = candidates[0]
    each = problem.energies(b, m)
    for other in candidates[1:]:
        energies = problem.energies(other, m)
        b = np.where((energies < each)[:, None], other, b)
        each = np.minimum(energies, each)
    bending = problem.variance * _cauchy(problem.bending(coefficients)).sum()
    return _State(coefficients, m, b, float(each.sum() + bending))


def _cauchy(ratio: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    return CAUCHY**2 / 2 * np.log1p((ratio / CAUCHY) ** 2)


@dataclass(frozen=True, eq=False)
class _Data:
    """The data's quadratic `b' H b / 2 - h' b` of each pixel: H and h."""

    curvature: Float[np.ndarray, "p 3 3"]
    pull: Float[np.ndarray, "p 3"]


def _data(problem: _Problem, b: Float[np.ndarray, "p 3"]) -> _Data:
    """Return the quadratic about b."""
    curvature, pull = np.empty((len(b), 3, 3)), np.empty(b.shape)
    for some in chunks(len(b), 8 * len(problem.values)):
        slope = problem.model.by_normal(problem.light, b[some]).swapaxes(0, 1)
        weighted = problem.weights[:, some].T[..., None] * slope
        residual = problem.values[:, some] - problem.model.predict(problem.light, b[some])
        curvature[some] = weighted.swapaxes(1, 2) @ slope
        pull[some] = np.einsum("pfi,fp->pi", weighted, residual)
    # Where no light decides, b stays where it is: a damping too weak to be felt elsewhere.
    damping = 1e-9 * np.einsum("pii->", curvature) / len(b) + np.finfo(np.float64).tiny
    curvature += damping * np.eye(3)
    pull += np.einsum("pij,pj->pi", curvature, b)
    return _Data(curvature, pull)


@dataclass(frozen=True, eq=False)
class _Pixels:
    """What each pixel wants of m = (-z_x, -z_y, 1), b being eliminated.

    With the data's quadratic and the price `t |b - s m|^2 / 2` of leaving the surface,
    `b = K (h + t s m)` with `K = (H + t)^-1`, and what remains is
    `s^2 m' G m / 2 - s a' m` with `G = t K H` and `a = t K h`.
    """

    data: _Data
    inverse: Float[np.ndarray, "p 3 3"]
    price: Float[np.ndarray, "p"]
    curvature: Float[np.ndarray, "p 3 3"]
    pull: Float[np.ndarray, "p 3"]

    def scales(self, m: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
        """Return the best s; the surface looks towards the viewer, so it is not negative."""
        along = np.einsum("pi,pij,pj->p", m, self.curvature, m)
        return np.maximum(np.einsum("pi,pi->p", m, self.pull), 0) / along

    def scaled_normals(self, m: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p 3"]:
        """Return the best b."""
        towards = self.data.pull + (self.price * self.scales(m))[:, None] * m
        return np.einsum("pij,pj->pi", self.inverse, towards)

    def slopes(
        self, m: Float[np.ndarray, "p 3"], s: Float[np.ndarray, "p"]
    ) -> tuple[Float[np.ndarray, "p 2 2"], Float[np.ndarray, "p 2"]]:
        """Return the Gauss-Newton matrix of each pixel's slopes and the downhill direction."""
        curved = np.einsum("pij,pj->pi", self.curvature, m)
        along = np.einsum("pi,pi->p", m, curved)
        across = self.curvature - curved[:, :, None] * curved[:, None] / along[:, None, None]
        # By the slopes m changes by (-1, 0, 0) and (0, -1, 0).
        downhill = s[:, None] * (s[:, None] * curved - self.pull)
        return s[:, None, None] ** 2 * across[:, :2, :2], downhill[:, :2]


def _pixels(problem: _Problem, data: _Data, weights: Float[np.ndarray, "p"]) -> _Pixels:
    """Return the pixels' wishes; the weights are those of leaving the surface."""
    price = problem.variance / problem.give**2 * weights
    inverse = np.linalg.inv(data.curvature + price[:, None, None] * np.eye(3))
    shared = price[:, None, None] * (inverse @ data.curvature)
    return _Pixels(
        data,
        inverse,
        price,
        (shared + shared.swapaxes(1, 2)) / 2,
        price[:, None] * np.einsum("pij,pj->pi", inverse, data.pull),
    )


def _start(problem: _Problem, b: Float[np.ndarray, "p 3"]) -> _State:
    """Return the surface of the pixels' own slopes, reweighted against jumps.

    Pixels that the surface explains better than they do themselves begin there: those that no
    light seemed to reach would never move.
    """
    s = np.maximum(b[:, 2], np.linalg.norm(b[:, :2], axis=1) / STEEPEST)
    s = np.maximum(s, np.finfo(np.float64).tiny)
    own = np.concatenate([b[:, :2], s[:, None]], axis=1) / s[:, None]
    wanted = -own[:, :2]
    bent = np.ones(problem.surface.bends.shape[0])
    data = _data(problem, b)
    pixels = _pixels(problem, data, np.ones(len(b)))
    matrices, _ = pixels.slopes(own, s)
    stiffness = problem.variance * problem.smoothness**2
    for _ in range(ROUNDS):
        pull = np.einsum("pij,pj->pi", matrices, wanted)
        coefficients = problem.surface.minimiser(
            matrices, stiffness * bent, problem.surface.slopes.T @ pull.T.ravel()
        )
        m = problem.tangent_normals(coefficients)
        fitted = pixels.scaled_normals(m)
        pixels = _pixels(problem, data, cauchy_weights(problem.leaving(fitted, m), 1.0))
        matrices, _ = pixels.slopes(own, s)
        bent = cauchy_weights(problem.bending(coefficients), 1.0)
    return _best(problem, coefficients, m, [_brightness(problem, m)[:, None] * m, fitted, b])


def _brightness(problem: _Problem, m: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p"]:
    """Return the s by which s m explains each pixel best: images are homogeneous in b."""
    found = np.empty(len(m))
    for some in chunks(len(m), 8 * len(problem.values)):
        predicted = problem.model.predict(problem.light, m[some])
        weighted = problem.weights[:, some] * predicted
        energy = (weighted * predicted).sum(axis=0)
        energy = np.maximum(energy, np.finfo(np.float64).tiny)
        found[some] = (weighted * problem.values[:, some]).sum(axis=0) / energy
    return np.maximum(found, 0)


def _step(problem: _Problem, state: _State) -> _State | None:
    """Return a state of lower energy, if there is one in the direction of Gauss and Newton.

    A pixel whose observations enter or leave a shadow on the way, where the quadratic is wrong,
    goes a part of its way or stays.
    """
    bent = cauchy_weights(problem.bending(state.coefficients), 1.0)
    leaving = cauchy_weights(problem.leaving(state.b, state.m), 1.0)
    pixels = _pixels(problem, _data(problem, state.b), leaving)
    matrices, downhill = pixels.slopes(state.m, pixels.scales(state.m))
    surface = problem.surface
    stiffness = problem.variance * problem.smoothness**2 * bent
    right = surface.slopes.T @ downhill.T.ravel()
    right -= surface.bends.T @ (stiffness * (surface.bends @ state.coefficients))
    direction = surface.minimiser(matrices, stiffness, right)
    for halving in range(HALVINGS):
        coefficients = state.coefficients + direction / 2**halving
        m = problem.tangent_normals(coefficients)
        way = (pixels.scaled_normals(m) - state.b) / 2**halving
        parts = [state.b + way, state.b + PART * way, state.b]
        found = _best(problem, coefficients, m, parts)
        if found.energy < state.energy:
            return found
    return None


def _noise(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> float:
    """Return the robust standard deviation of observations about each pixel's own fit.

    Observations that b has no influence on, in shadow, say nothing; each pixel's three unknowns
    took their share of the rest.
    """
    some = interleaved(len(b), 8 * len(values))[0]
    slope = model.by_normal(light, b[some])
    residual = values[:, some] - model.predict(light, b[some])
    seen = slope.any(axis=2) & (weights[:, some] > 0)
    seen &= seen.sum(axis=0) > 3
    pixels = int(seen.any(axis=0).sum())
    if not pixels:
        raise ArgumentError(
            "noise must be given: no pixel has more than three observations, so b leaves nothing "
            "to find it from"
        )
    count = int(seen.sum())
    return robust_scale(residual[seen]) * float(np.sqrt(count / (count - 3 * pixels)))
