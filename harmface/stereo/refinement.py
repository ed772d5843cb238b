"""Refinement: light of each image and normals of each pixel, together, under physical light.

The harmonic methods work with a truncated series, in which light may be negative. Here the
light of each image is one point, as in most photometric stereo: what is in shadow is left out
and the rest is of rank 3. Or it is a few points and light all around, uniform or with a gradient,
so attached shadows are explained rather than fitted away; or it is of degree 2 with all pixels
free, which serves smooth surroundings. The simplest that explains the images about as well as any
is kept; broad gloss looks like more points, so where there is no uniform light these must explain
far more.

Any linear map of b can be undone by light that is general enough: `max(b . l, 0)` stays when b
becomes A b and l becomes A^-T l, for point sources exactly, for a whole environment too. So after
the fit the linear map is chosen by the cues again: integrability leaves the bas-relief family,
and outline, albedo and the equality of single sources decide within it. Uniform light is not
mapped to uniform light, and so helps to decide; the more since points are found anew once the map
is about right, for in a sheared frame a few points too many hide that uniform light is not.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from harmface import checks
from harmface.stereo.cues import (
    ALL_CELLS,
    ISOMETRY,
    NOTHING,
    SEARCH_CELLS,
    UNEQUAL,
    Cues,
    Knowledge,
    anisotropy,
)
from harmface.stereo.factorization import factorize
from harmface.stereo.gauge import (
    Rows,
    best_linear,
    best_of,
    best_rotation,
    boosted,
    improved,
    shifted,
)
from harmface.stereo.hayakawa import equal_strength_metric
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.integrability import integrable_start
from harmface.stereo.light_models import (
    HarmonicLight,
    LightModel,
    PointLights,
    has_one_point,
    has_several_points,
    uniform_share,
)
from harmface.stereo.lorentz import nearest_lorentz
from harmface.stereo.many_sources import (
    ManySources,
    many_sources,
    misfit,
    misfit_of,
    points_again,
    points_of_more,
    under_dense_light,
)
from harmface.stereo.per_pixel import fit_robustly
from harmface.stereo.robust import robust_scale
from harmface.stereo.single_sources import SINGLE, single_sources
from harmface.stereo.stack import ImageStack, spread_images

PIXELS = 600
"""Pixels by which light is found: 64 images of them outnumber all unknowns a dozen times."""

FIRST_IMAGES = 16
"""Images, spread over all, that tell what light there is and settle the map: the search takes long,
and once normals are about right, points of all images are found at once."""

EXPLAINED = 0.01
"""Residual, relative to the mean image, that single sources may leave without others being tried;
light from elsewhere leaves 0.02 and more on reliefs and 0.1 on round objects."""

GAIN = 1.0
"""Twice the log-likelihood of an observation that many sources must gain over single ones. Cast
shadows pass for other sources to the extent of 0.7, uniform light of 3 % to that of 0.2 to 1, and
other sources themselves gain 1.4 and more."""

DARK_ROOM = 0.1
"""Share of uniform light below which there is none: gloss makes up points, but no uniform light."""

GAIN_IN_THE_DARK = 3.0
"""The same where there is no uniform light: gloss gains 0.5 to 2.5, as broad highlights look like
other points, and true points gain 3.5 and more."""

MADE_EQUAL = 8
"""Strengths that a linear map can make equal, whatever they are: as many as its numbers, but for
the scale."""

MOSTLY = 0.7
"""Share of the other sources that are of that strength, too, if lamps are equal."""

AGAIN = 6
"""Times that points are found anew at most; usually the map is settled after one or two."""

FOLLOWED = 3
"""The same with all images: once is enough if the first ones settled the map."""

SETTLED = 0.03
"""Departure from a rotation, from one time to the next, below which the map is settled."""

SURE_ISOMETRY = 0.02
"""Departure of the map from a rotation that is left open however well the images tell it."""


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
    pixels: int = PIXELS,
) -> Refined:
    """Return light and normals that explain the images, from a first estimate.

    One point an image is found by `single_sources`. Other light is found with the normals
    of a few hundred pixels by `many_sources`; then each pixel is fitted by itself.

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
    pixels
        Pixels by which light is found.
    """
    unit = float(stack.values.mean())
    stack = replace(stack, values=stack.values / unit)
    start = start / np.linalg.norm(start, axis=1).mean()
    rng = checks.generator(rng)
    some = rng.permutation(np.flatnonzero(stack.values.max(axis=0) > 0))[:pixels]
    few = spread_images(stack, FIRST_IMAGES)
    found, transformation, equal, isometry = _found(few, start, knowledge, some, rng)
    if few is not stack:
        if has_several_points(found.model):
            b = found.b @ transformation.T
            gradient = bool(found.model.gradient(found.light).any())
            found, transformation = _followed(stack, b, knowledge, some, gradient)
        else:
            found, transformation, equal, isometry = _found(stack, start, knowledge, some, rng)
    cues = _cues_of(stack, found, knowledge, ALL_CELLS, equal, isometry)
    structure = structure_of(found.model, found.b)
    move, parameters = (boosted, 6) if len(structure) == 4 else (shifted, 9)
    transformation = improved(cues, transformation, move, parameters)
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


def nearly_equal(sources: Float[np.ndarray, "F 3"]) -> bool:
    """Return whether sources are of one strength, beyond those that a linear map can make so."""
    strength = np.linalg.norm(sources, axis=1)
    alike = int((np.abs(strength / np.median(strength) - 1) < UNEQUAL).sum())
    # Of eight or fewer none could tell otherwise, and usual lamps are equal.
    others = max(len(strength) - MADE_EQUAL, 0)
    return alike - MADE_EQUAL >= MOSTLY * others or not others


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
    stack: ImageStack,
    start: Float[np.ndarray, "p 3"],
    some: Int[np.ndarray, "n"],
) -> _Explanation:
    """Return single sources if they explain the images about as well as many do, or many."""
    values, usable, seen = stack.values, stack.usable, stack.seen
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
    misfit_by_single = misfit_of(values, single.lit, SINGLE, single.light, single.b)
    left, lit = left[:, some], single.lit[:, some]
    starts = [start, leading_dimensions(values)]
    dense = [under_dense_light(values[:, some], seen[:, some], b[some]) for b in starts]
    best = int(np.argmin([robust_scale(rest[seen[:, some]]) for _, rest in dense]))
    under_dense, least = dense[best]
    # Most that another model could gain, as if it had no unknowns.
    if misfit(left[lit]) - misfit(least[lit]) < GAIN:
        return by_single
    fit = many_sources(values[:, some], seen[:, some], start[some], under_dense, least)
    # The fit may have drifted along a linear map, which the pixels not fitted yet must follow.
    b = start if isinstance(fit.model, HarmonicLight) else starts[best]
    drift, *_ = np.linalg.lstsq(b[some], fit.b, rcond=None)
    by_many = _everywhere(stack, fit, b @ drift)
    # Judged by all pixels: light can be bent to explain the highlights of those it was found with.
    gained = misfit_by_single - misfit_of(values, single.lit, fit.model, fit.light, by_many.b)
    dark = isinstance(fit.model, PointLights) and uniform_share(fit.model, fit.light) < DARK_ROOM
    if gained < (GAIN_IN_THE_DARK if dark else GAIN):
        return by_single
    return by_many


def _found(
    stack: ImageStack,
    start: Float[np.ndarray, "p 3"],
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    rng: np.random.Generator,
) -> tuple[_Explanation, Rows, bool, float]:
    """Return what explains the images, and its map that fits the cues.

    With whether sources are equal, and how far from a rotation the map may be.
    """
    found = _explained(stack, start, some)
    transformation, equal = _map_found(stack, found, start, knowledge, rng)
    if not has_several_points(found.model):
        return found, transformation, equal, ISOMETRY
    found, transformation, isometry = min(
        (
            _settled(stack, found, transformation, knowledge, some, gradient)
            for gradient in (False, True)
        ),
        key=lambda settled: misfit_of(
            stack.values[:, some],
            stack.seen[:, some],
            settled[0].model,
            settled[0].light,
            settled[0].b[some],
        ),
    )
    return found, transformation, equal, isometry


def _followed(
    stack: ImageStack,
    b: Float[np.ndarray, "p 3"],
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    gradient: bool,
) -> tuple[_Explanation, Rows]:
    """Return points of all images, found for normals that some of them settled, and the map."""
    values, seen = stack.values[:, some], stack.seen[:, some]
    for _ in range(FOLLOWED):
        b = b / np.linalg.norm(b, axis=1).mean()
        fit = points_of_more(values, seen, b[some], gradient=gradient)
        drift, *_ = np.linalg.lstsq(b[some], fit.b, rcond=None)
        found = _everywhere(stack, fit, b @ drift)
        transformation = np.linalg.lstsq(found.b, b, rcond=None)[0].T
        # Fits to fewer pixels differ more by chance.
        if _departure(drift) <= SETTLED * PIXELS / len(some):
            break
        cues = _cues_of(stack, found, knowledge, SEARCH_CELLS)
        transformation = improved(cues, transformation, shifted, 9)
        b = found.b @ transformation.T
    return found, transformation


def _settled(
    stack: ImageStack,
    found: _Explanation,
    transformation: Rows,
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    gradient: bool,
) -> tuple[_Explanation, Rows, float]:
    """Return points found anew until the linear map no longer depends on where they were begun.

    With the map that the cues choose, and how far from a rotation it may be.
    """
    for _ in range(AGAIN):
        b = found.b @ transformation.T
        found, isometry = _explained_again(stack, found, b, some, gradient)
        transformation = np.linalg.lstsq(found.b, b, rcond=None)[0].T
        if isometry <= SETTLED:
            break
        cues = _cues_of(stack, found, knowledge, SEARCH_CELLS)
        transformation = improved(cues, transformation, shifted, 9)
    return found, transformation, isometry


def _explained_again(
    stack: ImageStack,
    found: _Explanation,
    b: Float[np.ndarray, "p 3"],
    some: Int[np.ndarray, "n"],
    gradient: bool,
) -> tuple[_Explanation, float]:
    """Return points found anew for mapped normals, and how far the linear map is told by them.

    In a frame that is sheared more points are needed, so what was found in the better frame is kept
    if it explains the images better, by Bayes' criterion. The images know the map as well as fits
    begun in two frames agree.
    """
    values, seen = stack.values[:, some], stack.seen[:, some]
    left = values - found.model.predict(found.light, found.b[some])
    b = b[some] / np.linalg.norm(b, axis=1).mean()
    fit = points_again(values, seen, b, left, gradient=gradient)
    drift, *_ = np.linalg.lstsq(found.b[some], fit.b, rcond=None)
    moved = _departure(drift)
    now = misfit_of(values, seen, fit.model, fit.light, fit.b)
    if now < misfit_of(values, seen, found.model, found.light, found.b[some]):
        found = _everywhere(stack, fit, found.b @ drift)
    return found, float(np.clip(moved, SURE_ISOMETRY, ISOMETRY))


def _departure(drift: Float[np.ndarray, "3 3"]) -> float:
    """Return how far a linear map is from a rotation."""
    return float(np.abs(anisotropy((drift.T @ drift)[None])).max())


def _everywhere(
    stack: ImageStack,
    fit: ManySources,
    start: Float[np.ndarray, "p 3"],
) -> _Explanation:
    """Return all pixels under light that was found with some."""
    b, weights = fit_robustly(stack.values, stack.seen, fit.model, fit.light, start)
    scale = robust_scale((stack.values - fit.model.predict(fit.light, b))[stack.seen])
    # Single precision: those of three explanations are held at a time.
    weights = weights.astype(np.float32)
    return _Explanation(fit.model, fit.light, b, weights, scale, fit.energies, fit.converged)


def _map_found(
    stack: ImageStack,
    found: _Explanation,
    start: Float[np.ndarray, "p 3"],
    knowledge: Knowledge,
    rng: np.random.Generator,
) -> tuple[Rows, bool]:
    """Return the map of the structure that fits the cues, and whether sources are equal."""
    cues = _cues_of(stack, found, knowledge, SEARCH_CELLS)
    if isinstance(found.model, HarmonicLight):
        aligned = nearest_lorentz(directions_of(found.b), directions_of(start))
        return best_of(cues, [aligned[1:]], boosted, 6), True
    back, *_ = np.linalg.lstsq(found.b, start, rcond=None)
    starts = [back.T, integrable_start(found.b.T, stack.mask)]
    lights = _one_point_lights(found)
    if lights is None:
        return best_linear(cues, starts), True
    metric = equal_strength_metric(lights)
    if metric is not None:
        starts.append(best_rotation(cues, np.linalg.inv(np.linalg.cholesky(metric)), rng))
    transformation = best_linear(cues, starts)
    if nearly_equal(lights @ np.linalg.inv(transformation)):
        return transformation, True
    cues = _cues_of(stack, found, knowledge, SEARCH_CELLS, equal=False)
    return best_linear(cues, [transformation, *starts]), False


def _cues_of(
    stack: ImageStack,
    found: _Explanation,
    knowledge: Knowledge,
    cells: int,
    equal: bool = True,
    isometry: float = ISOMETRY,
) -> Cues:
    return Cues(
        structure_of(found.model, found.b),
        stack.mask,
        knowledge,
        lights=_one_point_lights(found),
        equal=equal,
        uniform=uniform_share(found.model, found.light),
        isometry=isometry,
        cells=cells,
    )


def _one_point_lights(found: _Explanation) -> Float[np.ndarray, "F 3"] | None:
    return found.model.points(found.light)[:, 0] if has_one_point(found.model) else None


def leading_dimensions(values: Float[np.ndarray, "F p"]) -> Float[np.ndarray, "p 3"]:
    """Return the first three singular vectors as scaled normals, the first towards the viewer.

    Images are positive, so the first singular vector is of one sign. On reliefs, where a method of
    more dimensions may go astray, the three nearly span the scaled normals.
    """
    first, second, third = factorize(values, 3).structure
    b = np.stack([second, third, first * np.sign(first.sum())], axis=1)
    return b / np.linalg.norm(b, axis=1).mean()
