"""Light and scaled normals at once: damped Gauss-Newton with the normals eliminated.

All unknowns, q light parameters an image and three components of b a pixel, are improved
together. A pixel's b couples to no other pixel's, so the normal equations of the step

    [U  W ] [dl]   [g]
    [W' V ] [db] = [h],   V block diagonal with 3 x 3 blocks,

reduce to `(U - W V^-1 W') dl = g - W V^-1 h`, a system in the light alone, as in bundle
adjustment [TMHF99]_. Alternating between light and normals instead crawls along the directions
in which both change together, which are the ones that photometric stereo is about: linear maps
of b that the light nearly undoes.

References
----------
.. [TMHF99] Triggs, McLauchlan, Hartley and Fitzgibbon, Bundle Adjustment: A Modern Synthesis,
   Vision Algorithms 1999.
.. [M78] Moré, The Levenberg-Marquardt Algorithm: Implementation and Theory, 1978.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.blas import dsyrk

from harmface.stereo.light_models import LightModel

LEAST_DAMPING = 1e-12
MOST_DAMPING = 1e8

PIXELS = 16
"""Pixels eliminated at a time."""


@dataclass(frozen=True, eq=False)
class JointFit:
    """Light and structure that explain a stack together.

    Parameters
    ----------
    light
        Parameters of the model, a row an image.
    b
        Scaled normals.
    energies
        `sum w r^2 / 2` before the first step and after each step taken: it never grows.
    converged
        Whether the last step changed the energy by less than the tolerance.
    """

    light: Float[np.ndarray, "F q"]
    b: Float[np.ndarray, "p 3"]
    energies: Float[np.ndarray, "n"]
    converged: bool


def fit_jointly(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    *,
    weights: Float[np.ndarray, "F p"] | None = None,
    iterations: int = 60,
    tolerance: float = 1e-5,
) -> JointFit:
    """Return a least-squares fit of light and scaled normals, from a start.

    A step is taken only if it lowers `sum w (M - f(l, b))^2 / 2`; the damping of [M78]_ scales
    each unknown by its own curvature, and grows when a step fails.

    Parameters
    ----------
    values
        Images as rows of pixels, or the rows of a factorisation if the model is linear in light.
    model
        How light makes an image.
    light, b
        Start.
    weights
        Of the observations; 1 if not given.
    iterations
        Most steps tried.
    tolerance
        Relative fall of the energy below which the fit has converged.
    """
    if weights is None:
        weights = np.ones(values.shape)
    damping = 1e-3
    energy = _energy(values, model.predict(light, b), weights)
    energies = [energy]
    system = None
    converged = energy == 0
    for _ in range(iterations):
        if converged or damping > MOST_DAMPING:
            break
        if system is None:
            system = _normal_equations(values, model, light, b, weights)
        light_step, b_step = _solve(system, damping)
        new_light, new_b = light + light_step, b + b_step
        new_energy = _energy(values, model.predict(new_light, new_b), weights)
        if not new_energy < energy:
            damping *= 8
            continue
        converged = energy - new_energy <= tolerance * energy
        light, b, energy, system = new_light, new_b, new_energy, None
        damping = max(damping / 5, LEAST_DAMPING)
        energies.append(energy)
    return JointFit(light, b, np.array(energies), converged)


@dataclass(frozen=True, eq=False)
class _System:
    """The blocks of the normal equations: U, V, g and h of the module's text.

    W, the largest, is `by_light[..., None] * by_normal[:, None]` and made when it is needed.
    """

    light: Float[np.ndarray, "F q q"]
    normal: Float[np.ndarray, "p 3 3"]
    by_light: Float[np.ndarray, "F q p"]
    by_normal: Float[np.ndarray, "F p 3"]
    light_slope: Float[np.ndarray, "F q"]
    normal_slope: Float[np.ndarray, "p 3"]


def _energy(
    values: Float[np.ndarray, "F p"],
    predicted: Float[np.ndarray, "F p"],
    weights: Float[np.ndarray, "F p"],
) -> float:
    return float((weights * (values - predicted) ** 2).sum() / 2)


def _normal_equations(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> _System:
    residual = values - model.predict(light, b)
    by_light, by_normal = model.by_light(light, b), model.by_normal(light, b)
    weighted = weights[..., None] * by_normal
    # An image at a time: the derivatives by light are larger than all else.
    each = zip(by_light, weights, strict=True)
    return _System(
        light=np.stack([(rows * weight) @ rows.T for rows, weight in each]),
        normal=np.einsum("fpi,fpj->pij", weighted, by_normal, optimize=True),
        by_light=by_light,
        by_normal=weighted,
        light_slope=np.einsum("fqp,fp->fq", by_light, weights * residual),
        normal_slope=np.einsum("fpi,fp->pi", weighted, residual),
    )


def _solve(
    system: _System, damping: float
) -> tuple[Float[np.ndarray, "F q"], Float[np.ndarray, "p 3"]]:
    # Lights that are out have no derivatives, and are not asked.
    light = _damped(system.light, damping)
    image, which = np.nonzero(np.einsum("fqq->fq", system.light))
    # Cholesky factors of the damped blocks, so that Z Z' with Z = W C^-T is W V^-1 W'.
    inverse = np.linalg.inv(np.linalg.cholesky(_damped(system.normal, damping)))
    slope = np.einsum("pji,pi->pj", inverse, system.normal_slope)
    reduced = np.zeros((len(image), len(image)), order="F")
    right = system.light_slope[image, which]
    # A share of the pixels at a time, since W and Z are larger than all else.
    for first in range(0, len(slope), PIXELS):
        some = slice(first, first + PIXELS)
        # Pixels first, so that one small product a pixel makes Z.
        coupling = system.by_light[image, which, some, None] * system.by_normal[image, some]
        z = coupling.swapaxes(0, 1) @ inverse[some].swapaxes(1, 2)
        z = z.swapaxes(0, 1).reshape(len(image), -1)
        # The lower half, in place.
        dsyrk(-1.0, z.T, beta=1.0, c=reduced, trans=1, lower=1, overwrite_c=1)
        right -= z @ slope[some].ravel()
    ends = np.searchsorted(image, np.arange(len(light) + 1))
    for i, (first, end) in enumerate(pairwise(ends)):
        reduced[first:end, first:end] += light[i][np.ix_(which[first:end], which[first:end])]
    # LAPACK's Cholesky: scipy's and numpy's general solvers take many times as long here.
    light_step = np.zeros(system.light_slope.shape)
    light_step[image, which] = cho_solve(cho_factor(reduced, lower=True, overwrite_a=True), right)
    by_light = np.einsum("fq,fqp->fp", light_step, system.by_light)
    moved = np.einsum("fp,fpi->pi", by_light, system.by_normal)
    rest = slope - np.einsum("pij,pj->pi", inverse, moved)
    return light_step, np.einsum("pji,pj->pi", inverse, rest)


def _damped(blocks: Float[np.ndarray, "n d d"], damping: float) -> Float[np.ndarray, "n d d"]:
    """Add `damping` times the diagonal, and a floor where a parameter has no effect at all."""
    diagonal = np.einsum("nii->ni", blocks)
    floor = np.finfo(np.float64).eps * diagonal.mean() + np.finfo(np.float64).tiny
    damped = blocks.copy()
    np.einsum("nii->ni", damped)[...] += damping * diagonal + floor
    return damped
