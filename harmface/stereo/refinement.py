"""Refinement: light of each image and normals of each pixel, together, under physical light.

The harmonic methods work with a truncated series, in which light may be negative. Here the
light of each image is one point, as in most photometric stereo: what is in shadow is left out
and the rest is of rank 3. Or it is a few points and uniform light, never negative, so attached
shadows are explained rather than fitted away; or it is of degree 2 with all pixels free, which
serves smooth surroundings. The simplest that explains the images about as well as any is kept.

Any linear map of b can be undone by light that is general enough: `max(b . l, 0)` stays when b
becomes A b and l becomes A^-T l, for point sources exactly, for a whole environment too. So after
the fit the linear map is chosen by the cues again: integrability leaves the bas-relief family,
and outline, albedo and the equality of single sources decide within it. Uniform light is not
mapped to uniform light, and so helps to decide.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.stereo.cues import NOTHING, Cues, Knowledge
from harmface.stereo.gauge import best_linear, best_of, best_rotation, boosted
from harmface.stereo.hayakawa import equal_strength_metric
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.joint import JointFit, fit_jointly
from harmface.stereo.light_models import (
    HarmonicLight,
    LightModel,
    PointLights,
    is_single,
    uniform_share,
)
from harmface.stereo.lorentz import nearest_lorentz
from harmface.stereo.non_negative import dense_light, fit_dense_light, points_of
from harmface.stereo.per_pixel import fit_robustly
from harmface.stereo.robust import cauchy_weights, robust_scale
from harmface.stereo.single_sources import SINGLE, single_sources
from harmface.stereo.stack import ImageStack

PIXELS = 800
"""Pixels by which light is found: 64 images of them outnumber all unknowns about fifteen times."""

POINTS = 4
TRIAL_STEPS = 30
"""Steps by which models of light are compared."""

ROUNDS = 2
"""Times that observations are weighed anew and light and normals fitted again."""

STEPS = 25
"""Steps of each round."""

EXPLAINED = 0.01
"""Residual, relative to the mean image, that single sources may leave without others being tried;
light from elsewhere leaves 0.02 and more on reliefs and 0.1 on round objects."""

GAIN = 0.2
"""Twice the log-likelihood of an observation that many sources must gain over single ones: noise
smaller by a tenth. Highlights pass for other sources to the extent of 0.11, and other sources
themselves gain 0.4 and more."""

SMALL = 1e-4
"""Residual, relative to the mean image, that counts as none in comparing models of light."""


@dataclass(frozen=True, eq=False)
class Refined:
    """Light and structure under the model that explains the images best.

    Parameters
    ----------
    model, light
        How light makes an image, and the parameters of each image.
    structure
        What the model leaves to be mapped: the scaled normals that it fitted, or (|b|, b) of them
        if it is harmonic, see `structure_of`.
    transformation
        The map that the cues chose.
    b
        Scaled normals: `mapped(transformation, structure)`.
    weights
        How much each observation counted, in [0, 1].
    residual
        Robust standard deviation of the observations about the model, relative to the mean.
    energies
        Of the last joint fit, falling; see `JointFit`.
    converged
        Whether it settled.
    cues
        What the transformation was chosen by.
    """

    model: LightModel
    light: Float[np.ndarray, "F q"]
    structure: Float[np.ndarray, "d p"]
    transformation: Float[np.ndarray, "3 d"]
    b: Float[np.ndarray, "p 3"]
    weights: Float[np.ndarray, "F p"]
    residual: float
    energies: Float[np.ndarray, "n"]
    converged: bool
    cues: Cues


def refine(
    stack: ImageStack,
    start: Float[np.ndarray, "p 3"],
    knowledge: Knowledge = NOTHING,
    *,
    rng: np.random.Generator | int = 0,
) -> Refined:
    """Return light and normals that explain the images, from a first estimate.

    One point an image is found by `single_sources`. Other light is found with the normals
    of a few hundred pixels, by `fit_jointly` with weights of Cauchy's loss: several points and
    uniform light, and degree 2; then each pixel is fitted by itself.

    Parameters
    ----------
    stack
        Images, in float64.
    start
        Scaled normals of the first- or second-order method.
    knowledge
        What else is known.
    rng
        Draws the pixels.
    """
    unit = float(stack.values.mean())
    start = start / np.linalg.norm(start, axis=1).mean()
    rng = checks.generator(rng)
    found = _explained(stack.values / unit, stack.usable, start, rng)
    structure = structure_of(found.model, found.b)
    lights = found.light if is_single(found.model) else None
    cues = Cues(
        structure,
        stack.mask,
        knowledge,
        lights=lights,
        uniform=uniform_share(found.model, found.light),
    )
    if isinstance(found.model, HarmonicLight):
        aligned = nearest_lorentz(_unit(found.b), _unit(start))
        transformation = best_of(cues, [aligned[1:]], boosted, 6)
    else:
        back, *_ = np.linalg.lstsq(found.b, start, rcond=None)
        starts = [back.T]
        metric = None if lights is None else equal_strength_metric(lights)
        if metric is not None:
            starts.append(best_rotation(cues, np.linalg.inv(np.linalg.cholesky(metric)), rng))
        transformation = best_linear(cues, starts)
    return Refined(
        found.model,
        found.light * unit,
        structure,
        transformation,
        mapped(transformation, structure),
        found.weights,
        found.residual,
        found.energies,
        found.converged,
        cues,
    )


def structure_of(model: LightModel, b: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "d p"]:
    """Return the numbers that what the model leaves open maps linearly.

    Points leave a linear map of b; harmonic light a Lorentz transformation of (|b|, b), see
    `second_order`.
    """
    if not isinstance(model, HarmonicLight):
        return b.T
    return np.concatenate([np.linalg.norm(b, axis=1)[None], b.T])


def mapped(
    transformation: Float[np.ndarray, "3 d"], structure: Float[np.ndarray, "d p"]
) -> Float[np.ndarray, "p 3"]:
    """Return the scaled normals that a map of `structure_of` a model gives.

    A Lorentz transformation of second-order structure changes albedo by `s'_0 / s_0` once more,
    see `second_order`; s'_0 is the length of what it gives.
    """
    b = (transformation @ structure).T
    if len(structure) == 4:
        b *= (np.linalg.norm(b, axis=1) / np.maximum(structure[0], np.finfo(b.dtype).tiny))[:, None]
    return b


def _unit(b: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    return b / np.linalg.norm(b, axis=1, keepdims=True)


@dataclass(frozen=True, eq=False)
class _Explanation:
    """Light and scaled normals that explain images, before the cues; fields as in `Refined`."""

    model: LightModel
    light: Float[np.ndarray, "F q"]
    b: Float[np.ndarray, "p 3"]
    weights: Float[np.ndarray, "F p"]
    residual: float
    energies: Float[np.ndarray, "n"]
    converged: bool


def _explained(
    values: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"],
    start: Float[np.ndarray, "p 3"],
    rng: np.random.Generator,
) -> _Explanation:
    """Return single sources if they explain the images about as well as many do, or many."""
    lit = np.flatnonzero(values.max(axis=0) > 0)
    some = rng.permutation(lit)[:PIXELS]
    single = single_sources(values, usable, start, some)
    left = values - SINGLE.predict(single.light, single.b)
    scale = robust_scale(left[single.lit])
    by_single = _Explanation(
        SINGLE,
        single.light,
        single.b,
        single.weights,
        scale,
        single.energies,
        single.converged,
    )
    if scale < EXPLAINED:
        return by_single
    model, fit = _many_sources(values[:, some], start[some])
    lit = single.lit[:, some]
    left_by_many = values[:, some] - model.predict(fit.light, fit.b)
    gained = _misfit(left[:, some][lit], single.light.size + 3 * len(some)) - _misfit(
        left_by_many[lit], int(np.count_nonzero(fit.light)) + fit.b.size
    )
    if gained < GAIN:
        return by_single
    # The fit may have drifted along a linear map, which the pixels not fitted yet must follow.
    drift, *_ = np.linalg.lstsq(start[some], fit.b, rcond=None)
    b, weights = fit_robustly(values, model, fit.light, start @ drift)
    scale = robust_scale(values - model.predict(fit.light, b))
    return _Explanation(model, fit.light, b, weights, scale, fit.energies, fit.converged)


def _many_sources(
    values: Float[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"]
) -> tuple[LightModel, JointFit]:
    """Return points and uniform light, or degree 2, whichever explains these pixels better.

    Both get a few steps; the winner goes on with observations weighed by Cauchy's loss.
    """
    dense = dense_light()
    spread = fit_dense_light(values, dense, b)
    smooth = HarmonicLight(2)
    images = scaled_normal_images(b, 2)
    starts: list[tuple[LightModel, Float[np.ndarray, "F q"]]] = [
        (PointLights(POINTS, ambient=True), points_of(spread, dense, POINTS)),
        (smooth, np.linalg.lstsq(images.T, values.T, rcond=None)[0].T),
    ]
    found = [
        (model, fit_jointly(values, model, light, b, iterations=TRIAL_STEPS))
        for model, light in starts
    ]
    model, fit = min(found, key=lambda each: _criterion(values, *each))
    for _ in range(ROUNDS):
        residual = values - model.predict(fit.light, fit.b)
        scale = robust_scale(residual)
        if scale < SMALL:
            break
        weights = cauchy_weights(residual, scale)
        fit = fit_jointly(values, model, fit.light, fit.b, weights=weights, iterations=STEPS)
    return model, fit


def _criterion(values: Float[np.ndarray, "F p"], model: LightModel, fit: JointFit) -> float:
    """Return Bayes' information criterion of a fit, its residual's scale being unknown."""
    variance = 2 * float(fit.energies[-1]) / values.size + SMALL**2
    unknowns = np.count_nonzero(fit.light) + fit.b.size
    return values.size * np.log(variance) + unknowns * np.log(values.size)


def _misfit(residual: Float[np.ndarray, "n"], unknowns: int) -> float:
    """Return the criterion for an observation, its noise distributed as Cauchy's."""
    scale = robust_scale(residual) + SMALL
    surprise = 2 * (np.log(scale) + np.log1p((residual / scale) ** 2).mean())
    return float(surprise + unknowns * np.log(residual.size) / residual.size)
