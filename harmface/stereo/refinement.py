"""Refinement: light of each image and normals of each pixel, together, under physical light.

The harmonic methods work with a truncated series, in which light may be negative. Here the
light of each image is a few points and uniform light, never negative, so attached shadows are
explained rather than fitted away; or it is of degree 2 with all pixels free, which serves
smooth surroundings. Whichever explains the images better is kept.

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
from harmface.stereo.gauge import best_linear, best_of, boosted
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.joint import JointFit, fit_jointly
from harmface.stereo.light_models import HarmonicLight, LightModel, PointLights
from harmface.stereo.lorentz import nearest_lorentz
from harmface.stereo.non_negative import dense_light, fit_dense_light, points_of
from harmface.stereo.per_pixel import fit_normals
from harmface.stereo.robust import cauchy_weights, robust_scale

PIXELS = 400
"""Pixels by which light is found: 64 images of them outnumber all unknowns about ten times."""

POINTS = 4
TRIAL_STEPS = 30
"""Steps by which models of light are compared."""

ROUNDS = 2
"""Times that observations are weighed anew and light and normals fitted again."""

STEPS = 25
"""Steps of each round."""

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
        Of the joint fit, falling; see `JointFit`.
    converged
        Whether the joint fit settled.
    cost
        Of the cues, see `Cues`.
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
    cost: float


def refine(
    values: Float[np.ndarray, "F p"],
    mask: Bool[np.ndarray, "H W"],
    start: Float[np.ndarray, "p 3"],
    knowledge: Knowledge = NOTHING,
    *,
    rng: np.random.Generator | int = 0,
) -> Refined:
    """Return light and normals that explain the images, from a first estimate.

    Light is found with the normals of a few hundred pixels, by `fit_jointly` with weights of
    Cauchy's loss, for one point an image, for several and uniform light, and for degree 2; the
    best by its residual and number of unknowns is kept. Then each pixel is fitted by itself.

    Parameters
    ----------
    values
        Images as rows of pixels.
    mask
        The pixels.
    start
        Scaled normals of the first- or second-order method.
    knowledge
        What else is known.
    rng
        Draws the pixels.
    """
    rng = checks.generator(rng)
    unit = float(values.mean())
    values = values / unit
    start = start / np.linalg.norm(start, axis=1).mean()
    lit = np.flatnonzero(values.max(axis=0) > 0)
    some = rng.permutation(lit)[:PIXELS]
    model, fit = _explained_best(values[:, some], start[some])
    # The fit may have drifted along a linear map, which the pixels not fitted yet must follow.
    drift, *_ = np.linalg.lstsq(start[some], fit.b, rcond=None)
    raw = fit_normals(values, model, fit.light, start @ drift)
    residual = values - model.predict(fit.light, raw)
    scale = robust_scale(residual)
    weights = cauchy_weights(residual, scale)
    raw = fit_normals(values, model, fit.light, raw, weights=weights)
    structure = structure_of(model, raw)
    single = isinstance(model, PointLights) and not model.ambient
    sources = fit.light if single else None
    cues = Cues(structure, mask, knowledge, lights=sources)
    if isinstance(model, HarmonicLight):
        aligned = nearest_lorentz(_unit(fit.b), _unit(start[some]))
        transformation = best_of(cues, [aligned[1:]], boosted, 6)
    else:
        back, *_ = np.linalg.lstsq(fit.b, start[some], rcond=None)
        transformation = best_linear(cues, [back.T])
    return Refined(
        model,
        fit.light * unit,
        structure,
        transformation,
        mapped(transformation, structure),
        weights,
        scale,
        fit.energies,
        fit.converged,
        cues.cost(transformation),
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


def _explained_best(
    values: Float[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"]
) -> tuple[LightModel, JointFit]:
    """Return the model of light that explains these pixels best, and its fit.

    All models get a few steps; the winner goes on with observations weighed by Cauchy's loss.
    """
    dense = dense_light()
    spread = fit_dense_light(values, dense, b)
    smooth = HarmonicLight(2)
    images = scaled_normal_images(b, 2)
    starts: list[tuple[LightModel, Float[np.ndarray, "F q"]]] = [
        (PointLights(1, ambient=False), points_of(spread, dense, 1)[:, :3]),
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
