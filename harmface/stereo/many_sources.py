"""Structure under light from anywhere: points and light all around, or degree 2.

Points have many false optima: two that are 40 degrees apart are easily taken for one, and no small
step parts them again. Light from many fixed directions has none, once the structure is given,
and alternating with the structure it soon explains the images as well as the truth does. It
leaves the linear map of the structure open, though, which few points and uniform light do not.
So dense light starts; what it gathers around becomes points; and light and structure are
improved together.

References
----------
.. [BSR17] Boyd, Schiebinger and Recht, The Alternating Descent Conditional Gradient Method for
   Sparse Inverse Problems, SIAM J. Optimization 2017.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.fewest_points import fewest_points
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.joint import fit_jointly
from harmface.stereo.light_models import HarmonicLight, LightModel, PointLights
from harmface.stereo.non_negative import best_point, dense_light, fit_dense_light, points_of
from harmface.stereo.per_image import fit_light
from harmface.stereo.per_pixel import fit_normals
from harmface.stereo.robust import robust_scale, seen_weights

MODEL = PointLights(6, ambient=True)
"""Up to four points are common, and two more cost less than one that is missed."""

COARSE = 100
"""Directions that structure is found with, about 20 degrees apart: a cosine lobe is far wider."""

FINE = 300
"""Directions that points are found with."""

ALTERNATIONS = 10
"""Times that dense light and structure are fitted in turn."""

PRICE = 4.0
"""Price of a direction, in deviations of the noise: what the structure still lacks misleads lower
ones."""

PRUNINGS = 3
"""Times that points too many are left out: each lets the structure show more of them. Before the
linear map is known once is enough."""

LATE_PRUNINGS = 2
"""The same for images that follow those which settled the normals."""

STEPS = 8
"""Steps of each joint fit of points."""

TRIAL_STEPS = 30
"""Steps of the joint fits of one point and of degree 2 before models are compared."""

REWEIGHTED_STEPS = 25
"""Steps after each reweighting, once it was chosen."""

MORE_POINTS = 0.3
"""Misfit by which several points must be better than one or smooth light: while the linear map
is wrong, points that are not there gain up to 0.13 over one; true ones gain 1.9 and more."""

SMALL = 1e-4
"""Residual, relative to the mean image, that counts as none."""


@dataclass(frozen=True, eq=False)
class ManySources:
    """Light and structure of some pixels.

    Parameters
    ----------
    model, light
        How light makes an image, and the parameters of each image.
    b
        Scaled normals.
    energies, converged
        Of the last joint fit, see `JointFit`.
    """

    model: LightModel
    light: Float[np.ndarray, "F q"]
    b: Float[np.ndarray, "p 3"]
    energies: Float[np.ndarray, "n"]
    converged: bool


def many_sources(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    second_order: Float[np.ndarray, "p 3"],
    under_dense: Float[np.ndarray, "p 3"],
    residual: Float[np.ndarray, "F p"],
) -> ManySources:
    """Return points and uniform light, or degree 2, whichever explains these pixels better.

    Parameters
    ----------
    values
        Images as rows of pixels, of mean about 1.
    seen
        Observations that are not saturated.
    second_order
        Scaled normals that degree 2 starts from.
    under_dense, left
        Scaled normals that points start from, and what they leave, of `under_dense_light`.
    """
    rough = _points(values, seen, under_dense, residual)
    residual = values - rough.model.predict(rough.light, rough.b)
    points = _points(values, seen, rough.b, residual)
    points = _pruned(values, seen, points.light, points.b, 1)
    others = [_one_point(values, seen, points.b), _smooth(values, seen, second_order)]

    best = min(
        [points, *others],
        key=lambda fit: (
            misfit_of(values, seen, fit.model, fit.light, fit.b) + MORE_POINTS * (fit is points)
        ),
    )
    return points if best is points else _reweighted(values, seen, best)


def points_again(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    residual: Float[np.ndarray, "F p"],
    *,
    gradient: bool,
) -> ManySources:
    """Return points and light all around, found anew for scaled normals of a better linear map.

    Parameters
    ----------
    values, seen
        As in `many_sources`.
    b
        Scaled normals, right but for small errors.
    residual
        What the light found before leaves of the images.
    gradient
        Whether the light all around may have a gradient.
    """
    fit = _points(values, seen, b, residual, gradient=gradient)
    return _pruned(values, seen, fit.light, fit.b, PRUNINGS)


def points_of_more(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    *,
    gradient: bool,
) -> ManySources:
    """Return points and light all around of more images than those that settled the normals.

    Parameters
    ----------
    values, seen, gradient
        As in `points_again`.
    b
        Scaled normals that other images settled.
    """
    residual = _residual_of_dense_light(values, seen, b, gradient)
    weights = seen_weights(residual, seen, least=SMALL)
    light = _gathered(values, b, residual, weights, gradient)
    return _pruned(values, seen, light, b, LATE_PRUNINGS)


def under_dense_light(
    values: Float[np.ndarray, "F p"], seen: Bool[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"]
) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
    """Return scaled normals by alternation with dense light, and what they leave of the images.

    Hardly any light leaves less, so this bounds what other models can gain.

    Parameters
    ----------
    values, seen
        As in `many_sources`.
    b
        Scaled normals to start from, up to a linear map.
    """
    model = dense_light(COARSE)
    weights = seen.astype(np.float64)
    for done in range(ALTERNATIONS):
        light = fit_dense_light(values, model, b, weights=weights)
        b = fit_normals(values, model, light, b, weights=weights, steps=3)
        if done >= ALTERNATIONS // 2:
            weights = seen_weights(values - model.predict(light, b), seen, least=SMALL)
    return b, values - model.predict(light, b)


def misfit(residual: Float[np.ndarray, "n"], *unknowns: Float[np.ndarray, "..."]) -> float:
    """Return Bayes' information criterion for an observation, its noise distributed as Cauchy's.

    Unknowns that are zero were not fitted, as those of lights that are out.
    """
    scale = robust_scale(residual) + SMALL
    surprise = 2 * (np.log(scale) + np.log1p((residual / scale) ** 2).mean())
    count = sum(np.count_nonzero(each) for each in unknowns)
    return float(surprise + count * np.log(residual.size) / residual.size)


def misfit_of(
    values: Float[np.ndarray, "F p"],
    observed: Bool[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
) -> float:
    """Return the `misfit` of a model to the observations marked."""
    return misfit((values - model.predict(light, b))[observed], light, b)


def _jointly(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
    steps: int,
) -> ManySources:
    fit = fit_jointly(values, model, light, b, weights=weights, iterations=steps)
    return ManySources(model, fit.light, fit.b, fit.energies, fit.converged)


def _points(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    residual: Float[np.ndarray, "F p"],
    *,
    gradient: bool = False,
) -> ManySources:
    """Return points and structure from a start.

    Points are added, here, and left out where they are not needed, by `_pruned`; each time light
    and structure descend together, as in [BSR17]_.
    """
    weights = seen_weights(residual, seen, least=SMALL)
    light = _gathered(values, b, residual, weights, gradient)
    return _jointly(values, MODEL, light, b, weights, STEPS)


def _pruned(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    times: int,
) -> ManySources:
    """Return what is left without the points that are not needed, and the structure it shows."""
    for _ in range(times):
        residual = values - MODEL.predict(light, b)
        weights = seen_weights(residual, seen, least=SMALL)
        price = 3 * np.log(len(b)) * _scale(residual[seen]) ** 2
        light = fewest_points(values, MODEL, light, b, weights, price)
        fit = _jointly(values, MODEL, light, b, weights, STEPS)
        light, b = fit.light, fit.b
    return fit


def _scale(residual: Float[np.ndarray, "n"]) -> float:
    return max(robust_scale(residual), SMALL)


def _residual_of_dense_light(
    values: Float[np.ndarray, "F p"],
    seen: Bool[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    gradient: bool,
) -> Float[np.ndarray, "F p"]:
    """Return what dense light leaves of the images for scaled normals that are about right."""
    model = dense_light(COARSE)
    light = fit_dense_light(values, model, b, weights=seen.astype(np.float64), gradient=gradient)
    residual = values - model.predict(light, b)
    return residual - residual @ np.linalg.pinv(b).T @ b.T if gradient else residual


def _gathered(
    values: Float[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    residual: Float[np.ndarray, "F p"],
    weights: Float[np.ndarray, "F p"],
    gradient: bool,
) -> Float[np.ndarray, "F q"]:
    """Return for each image the points that dense light gathers around."""
    dense = dense_light(FINE)
    scale = _scale(residual[weights > 0])
    # Observations of little weight are replaced by what was expected of them, so that all
    # images share their normal equations.
    filled = values - (1 - weights) * residual
    spread = fit_dense_light(filled, dense, b, price=PRICE * scale, gradient=gradient)
    light = points_of(spread, dense, b, MODEL.count)
    if gradient:
        MODEL.gradient(light)[:] = (filled - MODEL.predict(light, b)) @ np.linalg.pinv(b).T
    return fit_light(values, MODEL, light, b, weights)[0]


def _one_point(
    values: Float[np.ndarray, "F p"], seen: Bool[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"]
) -> ManySources:
    """Return one point and uniform light: a flash in a lit room."""
    model = PointLights(1, ambient=True)
    weights = seen.astype(np.float64)
    light = best_point(values, dense_light(COARSE), b, weights)
    light, _ = fit_light(values, model, light, b, weights)
    return _jointly(values, model, light, b, weights, TRIAL_STEPS)


def _smooth(
    values: Float[np.ndarray, "F p"], seen: Bool[np.ndarray, "F p"], b: Float[np.ndarray, "p 3"]
) -> ManySources:
    model = HarmonicLight(2)
    light = np.linalg.lstsq(scaled_normal_images(b, 2).T, values.T, rcond=None)[0].T
    weights = seen.astype(np.float64)
    return _jointly(values, model, light, b, weights, TRIAL_STEPS)


def _reweighted(
    values: Float[np.ndarray, "F p"], seen: Bool[np.ndarray, "F p"], fit: ManySources
) -> ManySources:
    """Return a fit continued with observations weighed by Cauchy's loss."""
    for _ in range(2):
        residual = values - fit.model.predict(fit.light, fit.b)
        if robust_scale(residual[seen]) < SMALL:
            break
        weights = seen_weights(residual, seen, least=SMALL)
        fit = _jointly(values, fit.model, fit.light, fit.b, weights, REWEIGHTED_STEPS)
    return fit
