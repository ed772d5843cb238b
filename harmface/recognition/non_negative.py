"""The nearest image under light that is nowhere negative.

A free fit of a harmonic subspace may call on negative light, which makes a subject look like
more images than it can. Light from sampled directions, each at least 0, excludes that ([BJ03]_):
an image is `a H S`, with `a` the strengths, `H` the harmonics of the directions and `S` the
harmonic images.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [LH74] Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.recognition.probes import checked_probes
from harmface.sphere import fibonacci_directions, real_harmonics

DIRECTIONS = 150
"""Directions of the sampled light, 17 degrees apart: finer than nine harmonics resolve."""

TOLERANCE = 1e-8
"""Ascent, relative to the projections, that counts as none."""

MAX_STEPS = 100
"""Steps of the active set: a handful would do for nine dimensions."""

CHUNK = 2**13
"""Pairs solved at a time: 30 MB."""


def non_negative_distances(
    probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "N K p"]
) -> Float[np.ndarray, "n N"]:
    """Return the distance of every probe to every subject under light that is nowhere negative.

    Relative to the probe's norm as `subspace_distances`, and never less than that.

    Parameters
    ----------
    probes
        Images as rows of pixels; none may be all black.
    images
        Harmonic images of each subject, flat index `k` of the second axis.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, or probes of another size than the images.
    """
    light = non_negative_light(probes, images)
    projections, grams, squared = small_problems(probes, images)
    fitted = np.einsum("nsk,skl,nsl->ns", light, grams, light, optimize=True)
    crossed = np.einsum("nsk,nsk->ns", light, projections)
    relative = 1 + (fitted - 2 * crossed) / squared[:, None]
    return np.sqrt(np.maximum(relative, 0)).astype(probes.dtype)


def non_negative_light(
    probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "N K p"]
) -> Float[np.ndarray, "n N K"]:
    """Return the non-negative light that takes every subject nearest to every probe.

    Parameters
    ----------
    probes
        Images as rows of pixels.
    images
        Harmonic images of each subject.

    Returns
    -------
    numpy.ndarray
        Harmonic coefficients of the light, in float64: a sum of at most `K` directions of
        `sampled_light`, so that it is non-negative as a measure.
    """
    projections, grams, _ = small_problems(probes, images)
    rays = sampled_light(max_degree_of(images.shape[1]))
    count, subjects, functions = projections.shape
    flat = projections.reshape(-1, functions)
    which = np.tile(np.arange(subjects), count)
    light = np.empty_like(flat)
    for first in range(0, len(flat), CHUNK):
        some = slice(first, first + CHUNK)
        light[some] = nearest_in_cone(flat[some], grams[which[some]], rays)
    return light.reshape(projections.shape)


@lru_cache(maxsize=8)
def sampled_light(degree: int) -> Float[np.ndarray, "J K"]:
    """Return the harmonics of the sampled directions: the light of each alone."""
    rays = np.ascontiguousarray(real_harmonics(fibonacci_directions(DIRECTIONS), degree).T)
    rays.flags.writeable = False
    return rays


def small_problems(
    probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "N K p"]
) -> tuple[Float[np.ndarray, "n N K"], Float[np.ndarray, "N K K"], Float[np.ndarray, "n"]]:
    """Return what least squares needs of the pixels: `S x`, `S S^T` and `|x|^2`, in float64."""
    images = checks.finite("images", images)
    probes = checked_probes(probes, images.shape[-1])
    subjects, functions, pixels = images.shape
    flat = images.reshape(-1, pixels).astype(probes.dtype, copy=False)
    projections = (probes @ flat.T).reshape(-1, subjects, functions).astype(np.float64)
    grams = images.astype(np.float64) @ images.swapaxes(1, 2)
    return projections, grams, np.einsum("np,np->n", probes, probes).astype(np.float64)


def nearest_in_cone(
    projections: Float[np.ndarray, "P K"],
    grams: Float[np.ndarray, "P K K"],
    rays: Float[np.ndarray, "J K"],
) -> Float[np.ndarray, "P K"]:
    """Return the least `l G l - 2 l q` of each problem over the cone of the rays.

    Non-negative least squares by the active set of [LH74]_, all problems at once: each holds
    the strengths of at most `K` rays, so that every step is a solution of small systems.

    Parameters
    ----------
    projections
        The vectors `q`.
    grams
        The matrices `G`, positive semidefinite.
    rays
        What spans the cone.
    """
    problems, functions = projections.shape
    result = np.zeros_like(projections)
    # A ridge at rounding error keeps the systems regular where images depend on one another.
    ridge = 1e-12 * np.trace(grams, axis1=1, axis2=2)[:, None, None] * np.eye(functions)
    grams = grams + ridge
    limits = TOLERANCE * np.abs(projections).max(axis=1) * np.abs(rays).max()
    open_ = np.arange(problems)
    slots = np.full((problems, functions), -1)
    strengths = np.zeros((problems, functions))
    fresh = np.ones(problems, dtype=bool)
    for _ in range(MAX_STEPS):
        light = _sum(rays, slots, strengths)
        ascent = (projections - (grams @ light[..., None])[..., 0]) @ rays.T
        steepest = ascent.argmax(axis=1)
        rising = ascent[np.arange(len(open_)), steepest] > limits
        done = fresh & (~rising | (slots >= 0).all(axis=1))
        if done.any():
            result[open_[done]] = light[done]
            keep = ~done
            open_, grams, projections, limits, slots, strengths, fresh, steepest = (
                each[keep]
                for each in (open_, grams, projections, limits, slots, strengths, fresh, steepest)
            )
            if not open_.size:
                break
        adding = np.flatnonzero(fresh)
        slots[adding, (slots[adding] < 0).argmax(axis=1)] = steepest[adding]
        # Slots fill from the left: in the first steps most columns are empty in all problems.
        taken = (slots >= 0).max(axis=0, initial=False)
        width = functions - int(taken[::-1].argmax())
        slots[:, :width], strengths[:, :width], fresh = _solved(
            grams, projections, rays, slots[:, :width], strengths[:, :width]
        )
    else:
        result[open_] = _sum(rays, slots, strengths)
    return result


def _solved(
    grams: Float[np.ndarray, "P K K"],
    projections: Float[np.ndarray, "P K"],
    rays: Float[np.ndarray, "J K"],
    slots: Integer[np.ndarray, "P S"],
    strengths: Float[np.ndarray, "P S"],
) -> tuple[Integer[np.ndarray, "P S"], Float[np.ndarray, "P S"], Bool[np.ndarray, "P"]]:
    """Go to the best strengths of the chosen rays, or as far as none becomes negative."""
    chosen = _chosen(rays, slots)
    used = slots >= 0
    system = chosen @ grams @ chosen.swapaxes(1, 2)
    system[:, range(slots.shape[1]), range(slots.shape[1])] += ~used
    right = chosen @ projections[..., None]
    wanted = np.linalg.solve(system, right)[..., 0] * used
    falling = used & (wanted <= 0)
    share = np.divide(strengths, strengths - wanted, out=np.ones_like(wanted), where=falling)
    step = share.min(axis=1, keepdims=True)
    reached = strengths + step * (wanted - strengths)
    blocked = falling & (share <= step)
    settled = np.logical_not(falling.any(axis=1))
    return np.where(blocked, -1, slots), np.where(blocked, 0, reached), settled


def _sum(
    rays: Float[np.ndarray, "J K"],
    slots: Integer[np.ndarray, "P K"],
    strengths: Float[np.ndarray, "P K"],
) -> Float[np.ndarray, "P K"]:
    """Return the sum of the rays in the slots by their strengths."""
    return (strengths[:, None] @ rays[slots])[:, 0]


def _chosen(
    rays: Float[np.ndarray, "J K"], slots: Integer[np.ndarray, "P S"]
) -> Float[np.ndarray, "P S K"]:
    """Return the rays in the slots, zeros in empty ones."""
    return rays[slots] * (slots >= 0)[..., None]
