"""What images determine: light of each image and scaled normals of each pixel, up to a map.

Light is one point an image, as in most photometric stereo: what is in shadow is left out and the
rest is of rank 3. Or it is a few points and light all around, uniform or with a gradient, so that
attached shadows are explained rather than fitted away; or it is of degree 2, which serves smooth
surroundings. The simplest that explains the images about as well as any is kept, by Bayes'
information criterion of observations whose noise is distributed as Cauchy's.

Any linear map of b can be undone by light that is general enough: `max(b . l, 0)` stays when b
becomes A b and l becomes A^-T l, for point sources exactly, for a whole environment too. So the
map is left to the cues, see `gauge`. Uniform light is not mapped to uniform light, and so helps to
decide; the more since points are found anew once the map is about right, for in a sheared frame a
few points too many hide that uniform light is not.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from harmface.stereo.cues import (
    Albedo,
    Cue,
    DiffuseMaxima,
    Facing,
    Highlights,
    Integrability,
    KnownDirections,
    LightMetric,
    MeasuredNormals,
    Rim,
    Rows,
    Strengths,
    Symmetry,
    TypicalShape,
    anisotropy,
    structure_field,
)
from harmface.stereo.factorization import leading_dimensions
from harmface.stereo.gauge import (
    CONCAVE,
    Gauge,
    Move,
    bas_reliefs,
    boosted,
    choose_map,
    improved,
    lorentz_families,
    rough_map,
    shifted,
)
from harmface.stereo.inflation import inflated_normals
from harmface.stereo.light_models import (
    HarmonicLight,
    LightModel,
    has_one_point,
    has_several_points,
    is_single,
    uniform_share,
)
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
from harmface.stereo.single_sources import SINGLE, refitted, single_sources
from harmface.stereo.stack import ImageStack, spread_images

PIXELS = 600
"""Pixels by which light is found: 64 images of them outnumber all unknowns a dozen times."""

FIRST_IMAGES = 16
"""Images, spread over all, that tell what light there is and settle the map: the search takes long,
and once normals are about right, points of all images are found at once."""

EXPLAINED = 0.01
"""Residual, relative to the mean image, that single sources may leave without others being tried:
the noise of a camera."""

GAIN = 1.0
"""Twice the log-likelihood of an observation that many sources must gain over single ones: so much
the dark quarter of the observations gains when shadows are explained rather than left out."""

DARK_ROOM = 0.1
"""Share of uniform light below which there is none to speak of."""

GAIN_IN_THE_DARK = 3.0
"""The same where there is no uniform light: broad highlights look like other points, and gain as
much as an observation that is left out."""

UNIFORM = 0.1
"""Share of uniform light that tells the map as well as any cue."""

AGAIN = 6
"""Times that points are found anew at most; usually the map is settled after one or two."""

SETTLED = 0.03
"""Departure from a rotation, from one time to the next, below which the map is settled: a degree
and a half."""

ISOMETRY = 0.1
SURE_ISOMETRY = 0.02
"""Most and least departure from a rotation that light which is not quite uniform may cause."""


@dataclass(frozen=True, eq=False)
class Measured:
    """Pixels at which normals were measured.

    Parameters
    ----------
    pixels
        The images at these pixels.
    near
        Columns of the stack that is explained next to them.
    normals
        The unit normals.
    """

    pixels: ImageStack
    near: Int[np.ndarray, "k"]
    normals: Float[np.ndarray, "k 3"]


@dataclass(frozen=True, eq=False)
class Knowledge:
    """What is known of a surface beside its images.

    Parameters
    ----------
    measured
        Normals at some pixels.
    symmetric
        Whether it is symmetric about the middle column of its mask.
    directions
        Unit directions to the lamps of the images, zero where they are not known.
    """

    measured: Measured | None = None
    symmetric: bool = False
    directions: Float[np.ndarray, "F 3"] | None = None


@dataclass(frozen=True, eq=False)
class Structure:
    """Light and scaled normals that explain images, up to a map.

    Parameters
    ----------
    model, light
        How light makes an image, and the parameters of each image.
    b
        Scaled normals, in the frame that the fit chose.
    weights
        How much each observation counted, in [0, 1].
    residual
        Robust standard deviation of the observations about the model.
    converged
        Whether the fit settled.
    """

    model: LightModel
    light: Float[np.ndarray, "F q"]
    b: Float[np.ndarray, "p 3"]
    weights: Float[np.ndarray, "F p"]
    residual: float
    converged: bool

    def numbers(self, b: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p d"]:
        """Return v, which what is left open maps linearly.

        Points leave a linear map of b; harmonic light a Lorentz transformation of (|b|, b), see
        `second_order`.
        """
        if not isinstance(self.model, HarmonicLight):
            return b
        return np.concatenate([np.linalg.norm(b, axis=1, keepdims=True), b], axis=1)

    def mapped(self, rows: Rows, b: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "p 3"]:
        """Return the scaled normals that a map of the numbers gives.

        A Lorentz transformation of second-order structure changes albedo by `s'_0 / s_0` once
        more; s'_0 is the length of what it gives.
        """
        v = self.numbers(b)
        found = v @ rows.T
        if v.shape[1] == 4:
            grown = np.linalg.norm(found, axis=1) / np.maximum(v[:, 0], np.finfo(b.dtype).tiny)
            found = found * grown[:, None]
        return found

    def at(
        self, stack: ImageStack, start: Float[np.ndarray, "p 3"]
    ) -> tuple[Float[np.ndarray, "p 3"], Float[np.ndarray, "F p"]]:
        """Return the scaled normals of other pixels under this light, and their weights.

        Parameters
        ----------
        stack
            The same images at these pixels.
        start
            Scaled normals to begin with.
        """
        if is_single(self.model):
            return refitted(stack.values, stack.usable, self.light, start)
        return fit_robustly(stack.values, stack.seen, self.model, self.light, start)


def explain(
    stack: ImageStack, knowledge: Knowledge, rng: np.random.Generator
) -> tuple[Structure, Gauge]:
    """Return what explains the images, and the map that cues choose.

    Parameters
    ----------
    stack
        Images of mean about 1, in float64.
    knowledge
        What else is known.
    rng
        Draws pixels and starts.
    """
    lit = np.flatnonzero(stack.values.max(axis=0) > 0)
    some = rng.permutation(lit)[:PIXELS]
    few = spread_images(stack, FIRST_IMAGES)
    found = _explained(few, knowledge, some, rng)
    if has_several_points(found.model):
        return _of_several_points(stack, few, found, knowledge, some, rng)
    if is_single(found.model):
        found = _single(stack, some)
    elif few is not stack:
        found = _explained(stack, knowledge, some, rng)
    cues = cues_of(stack, found, knowledge)
    return found, choose_map(cues, _families(stack, found, cues, rng), _move(found))


def _of_several_points(
    stack: ImageStack,
    few: ImageStack,
    found: Structure,
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    rng: np.random.Generator,
) -> tuple[Structure, Gauge]:
    """Return points of all images, and their map, from those of a few."""
    cues = cues_of(few, found, knowledge)
    rows = rough_map(cues, _families(few, found, cues, rng))
    tried = [_settled(few, found, rows, knowledge, some, gradient) for gradient in (False, True)]
    found, rows, isometry = min(tried, key=lambda settled: _misfit(few, settled[0], some))
    if few is not stack and has_several_points(found.model):
        gradient = bool(found.model.gradient(found.light).any())
        found, rows = _followed(stack, found.b @ rows.T, knowledge, some, gradient)
    return found, choose_map(cues_of(stack, found, knowledge, isometry), [[rows]])


def cues_of(
    stack: ImageStack, found: Structure, knowledge: Knowledge, isometry: float = ISOMETRY
) -> list[Cue]:
    """Return the cues to the map of a structure.

    Parameters
    ----------
    stack
        Images.
    found
        Their structure.
    knowledge
        What else is known.
    isometry
        Departure from a rotation that uniform light leaves open.
    """
    v = found.numbers(found.b)
    predicted = found.model.predict(found.light, found.b)
    lit = (found.weights > 0) & (predicted > 0)
    slope = found.model.by_normal(found.light, found.b)
    information = (slope**2).sum(axis=(0, 2)) / 3
    floor = np.finfo(np.float64).eps * information.max()
    noise = found.residual / np.sqrt(np.maximum(information, floor))
    root = _whitening(slope) if v.shape[1] == 3 else np.eye(4)
    seen = structure_field(v, stack.mask, lit.mean(axis=0), noise)
    cues: list[Cue | None] = [
        Integrability.of(seen, root),
        Albedo.of(seen),
        Facing.of(seen),
        Rim.of(seen),
        TypicalShape.of(seen),
    ]
    if has_one_point(found.model):
        lamps = found.model.points(found.light)[:, 0]
        cues += [Strengths.of(lamps, lit.mean(axis=1)), DiffuseMaxima.of(seen, lamps)]
        if knowledge.directions is not None:
            every = np.linspace(0, len(knowledge.directions) - 1, len(lamps)).astype(int)
            known = knowledge.directions[every].any(axis=1)
            if known.any():
                directions, share = knowledge.directions[every][known], lit.mean(axis=1)[known]
                cues.append(KnownDirections(lamps[known], directions, share / share.mean()))
        if is_single(found.model):
            shown = (predicted > 0) & (stack.usable | ~stack.seen)
            cues.append(Highlights.of(seen, lamps, stack.values - predicted, shown))
    uniform = min(1.0, uniform_share(found.model, found.light) / UNIFORM)
    if uniform > 0:
        cues.append(LightMetric(np.eye(3), isometry, LightMetric.votes * uniform))
    if knowledge.symmetric:
        cues.append(Symmetry.of(seen))
    if knowledge.measured is not None:
        pixels = spread_images(knowledge.measured.pixels, len(stack.values))
        b, _ = found.at(pixels, found.b[knowledge.measured.near])
        cues.append(MeasuredNormals(found.numbers(b), knowledge.measured.normals))
    return [cue for cue in cues if cue is not None]


def _whitening(slope: Float[np.ndarray, "F p 3"]) -> Float[np.ndarray, "3 3"]:
    """Return the root of the mean information of b, of mean square one."""
    normal = np.einsum("fpi,fpj->ij", slope, slope, optimize=True)
    scale, axes = np.linalg.eigh(normal / (np.trace(normal) / 3))
    # Below the square of single precision's resolution a direction is not seen.
    return np.asarray((axes * np.sqrt(np.maximum(scale, 1e-9))) @ axes.T)


def _families(
    stack: ImageStack, found: Structure, cues: list[Cue], rng: np.random.Generator
) -> list[list[Rows]]:
    """Return maps to begin with."""
    if isinstance(found.model, HarmonicLight):
        return lorentz_families(rng)
    integrability = next(cue for cue in cues if isinstance(cue, Integrability))
    # Where the surface bends one way only, integrability leaves more open than bas-reliefs.
    unit = found.b / np.maximum(np.linalg.norm(found.b, axis=1, keepdims=True), 1e-12)
    inflated = np.linalg.lstsq(unit, inflated_normals(stack.mask), rcond=None)[0].T
    starts = [integrability.best_rows(rng)[0], inflated]
    if any(isinstance(cue, MeasuredNormals | KnownDirections) for cue in cues):
        starts += [CONCAVE @ rows for rows in starts]
    return [bas_reliefs(rows, found.b) for rows in starts]


def _move(found: Structure) -> Move:
    return boosted if isinstance(found.model, HarmonicLight) else shifted


def _single(stack: ImageStack, some: Int[np.ndarray, "n"]) -> Structure:
    """Return one source an image, and what it lights."""
    found = single_sources(stack.values, stack.usable, leading_dimensions(stack.values), some)
    residual = stack.values - SINGLE.predict(found.light, found.b)
    scale = robust_scale(residual[found.lit])
    return Structure(SINGLE, found.light, found.b, found.weights, scale, found.converged)


def _explained(
    stack: ImageStack, knowledge: Knowledge, some: Int[np.ndarray, "n"], rng: np.random.Generator
) -> Structure:
    """Return single sources if they explain the images about as well as many do, or many."""
    values, seen = stack.values, stack.seen
    by_single = _single(stack, some)
    if by_single.residual < EXPLAINED:
        return by_single
    leading = leading_dimensions(values)
    lit = by_single.weights > 0
    misfit_by_single = misfit_of(values, lit, SINGLE, by_single.light, by_single.b)
    residual = (values - SINGLE.predict(by_single.light, by_single.b))[:, some]
    under_dense, least = under_dense_light(values[:, some], seen[:, some], leading[some])
    # Most that another model could gain, as if it had no unknowns.
    if misfit(residual[lit[:, some]]) - misfit(least[lit[:, some]]) < GAIN:
        return by_single
    cues = cues_of(stack, by_single, knowledge)
    rough = by_single.b @ rough_map(cues, _families(stack, by_single, cues, rng)).T
    rough /= np.linalg.norm(rough, axis=1).mean()
    fit = many_sources(values[:, some], seen[:, some], rough[some], under_dense, least)
    # The fit may have drifted along a linear map, which the pixels not fitted yet must follow.
    start = rough if isinstance(fit.model, HarmonicLight) else leading
    by_many = _fit_all_pixels(stack, fit, start @ _drift(start[some], fit.b))
    # Judged by all pixels: light can be bent to explain the highlights of those it was found with.
    gained = misfit_by_single - misfit_of(values, lit, fit.model, fit.light, by_many.b)
    dark = not isinstance(fit.model, HarmonicLight)
    dark = dark and uniform_share(fit.model, fit.light) < DARK_ROOM
    return by_single if gained < (GAIN_IN_THE_DARK if dark else GAIN) else by_many


def _followed(
    stack: ImageStack,
    b: Float[np.ndarray, "p 3"],
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    gradient: bool,
) -> tuple[Structure, Rows]:
    """Return points of all images, found for normals that some of them settled, and the map."""
    values, seen = stack.values[:, some], stack.seen[:, some]
    for _ in range(AGAIN // 2):
        b = b / np.linalg.norm(b, axis=1).mean()
        fit = points_of_more(values, seen, b[some], gradient=gradient)
        drift = _drift(b[some], fit.b)
        found = _fit_all_pixels(stack, fit, b @ drift)
        rows = _drift(found.b, b).T
        # Fits to fewer pixels differ more by chance.
        if _departure(drift) <= SETTLED * PIXELS / len(some):
            break
        rows = improved(cues_of(stack, found, knowledge), rows)[1]
        b = found.b @ rows.T
    return found, rows


def _settled(
    stack: ImageStack,
    found: Structure,
    rows: Rows,
    knowledge: Knowledge,
    some: Int[np.ndarray, "n"],
    gradient: bool,
) -> tuple[Structure, Rows, float]:
    """Return points found anew until the linear map no longer depends on where they were begun.

    With the map that the cues choose, and how far from a rotation it may be: the images know the
    map as well as fits begun in two frames agree. In a frame that is sheared more points are
    needed, so what was found in the better frame is kept if it explains the images better.
    """
    values, seen = stack.values[:, some], stack.seen[:, some]
    for _ in range(AGAIN):
        b = found.b @ rows.T
        start = b[some] / np.linalg.norm(b, axis=1).mean()
        residual = values - found.model.predict(found.light, found.b[some])
        fit = points_again(values, seen, start, residual, gradient=gradient)
        drift = _drift(found.b[some], fit.b)
        if misfit_of(values, seen, fit.model, fit.light, fit.b) < _misfit(stack, found, some):
            found = _fit_all_pixels(stack, fit, found.b @ drift)
        isometry = float(np.clip(_departure(drift), SURE_ISOMETRY, ISOMETRY))
        rows = _drift(found.b, b).T
        if isometry <= SETTLED:
            break
        rows = improved(cues_of(stack, found, knowledge), rows)[1]
    return found, rows, isometry


def _misfit(stack: ImageStack, found: Structure, some: Int[np.ndarray, "n"]) -> float:
    values, seen = stack.values[:, some], stack.seen[:, some]
    return misfit_of(values, seen, found.model, found.light, found.b[some])


def _drift(before: Float[np.ndarray, "n 3"], after: Float[np.ndarray, "n 3"]) -> np.ndarray:
    """Return the linear map by which scaled normals have changed, to be applied from the right."""
    return np.asarray(np.linalg.lstsq(before, after, rcond=None)[0])


def _departure(drift: Float[np.ndarray, "3 3"]) -> float:
    """Return how far a linear map is from a rotation."""
    return float(np.abs(anisotropy(drift.T @ drift)).max())


def _fit_all_pixels(
    stack: ImageStack, fit: ManySources, start: Float[np.ndarray, "p 3"]
) -> Structure:
    """Return all pixels under light that was found with some."""
    b, weights = fit_robustly(stack.values, stack.seen, fit.model, fit.light, start)
    scale = robust_scale((stack.values - fit.model.predict(fit.light, b))[stack.seen])
    # Single precision: those of three explanations are held at a time.
    return Structure(fit.model, fit.light, b, weights.astype(np.float32), scale, fit.converged)
