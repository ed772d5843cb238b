"""Light that is nowhere negative: sums, with strengths of at least 0, of sampled directions.

A free fit of lighting coefficients may call on negative light. Light from sampled directions, each
at least 0, excludes that ([BJ03]_): its coefficients are `a H`, with `a` the strengths and `H` the
harmonics of the directions.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [LH74] Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Integer
from threadpoolctl import threadpool_limits

from harmface.sphere import fibonacci_directions, real_harmonics

DIRECTIONS = 150
"""Directions of the sampled light, 17 degrees apart: finer than nine harmonics resolve."""

TOLERANCE = 1e-6
"""Ascent, relative to the projections, that counts as none."""

MAX_STEPS = 100
"""Steps of the active set: a handful would do for nine dimensions."""


@lru_cache(maxsize=8)
def sampled_light(degree: int) -> Float[np.ndarray, "J K"]:
    """Return the harmonics of the sampled directions: the light of each alone."""
    rays = np.ascontiguousarray(real_harmonics(fibonacci_directions(DIRECTIONS), degree).T)
    rays.flags.writeable = False
    return rays


Active = tuple[Integer[np.ndarray, "P K"], Float[np.ndarray, "P K"]]
"""Which rays have strength in each problem, -1 in empty slots, and how much."""


def nearest_in_cone(
    projections: Float[np.ndarray, "P K"],
    grams: Float[np.ndarray, "P K K"],
    rays: Float[np.ndarray, "J K"],
    start: Active | None = None,
) -> Float[np.ndarray, "P K"]:
    """Return the least `l G l - 2 l q` of each problem over the cone of the rays.

    Parameters
    ----------
    projections
        The vectors `q`.
    grams
        The matrices `G`, positive semidefinite.
    rays
        What spans the cone.
    start
        Where to start from, see `active_rays`.
    """
    # The systems are small: threads would spend their time waiting for each other.
    with threadpool_limits(1, user_api="blas"):
        return _sum(rays, *active_rays(projections, grams, rays, start))


def active_rays(
    projections: Float[np.ndarray, "P K"],
    grams: Float[np.ndarray, "P K K"],
    rays: Float[np.ndarray, "J K"],
    start: Active | None = None,
) -> Active:
    """Return the rays that make up the nearest point of `nearest_in_cone`, and their strengths.

    Non-negative least squares by the active set of [LH74]_, all problems at once: each holds
    the strengths of at most `K` rays, so that every step is a solution of small systems.
    """
    problems, functions = projections.shape
    # A ridge at rounding error keeps the systems regular where images depend on one another.
    ridge = 1e-12 * np.trace(grams, axis1=1, axis2=2)[:, None, None] * np.eye(functions)
    grams = grams + ridge
    limits = TOLERANCE * np.abs(projections).max(axis=1) * np.abs(rays).max()
    if start is None:
        slots, strengths = np.full((problems, functions), -1), np.zeros((problems, functions))
    else:
        slots, strengths = (each.copy() for each in start)
    open_, best = np.ones(problems, dtype=bool), np.array(slots.max(axis=1) < 0)
    for _ in range(MAX_STEPS):
        # Where the strengths are the best for the rays held, the ray that helps most joins them.
        resting = np.flatnonzero(open_ & best)
        light = _sum(rays, slots[resting], strengths[resting])
        ascent = (projections[resting] - (light[:, None] @ grams[resting])[:, 0]) @ rays.T
        steepest = ascent.argmax(axis=1)
        rising = ascent[np.arange(len(resting)), steepest] > limits[resting]
        rising &= (slots[resting] < 0).any(axis=1)
        open_[resting[~rising]] = False
        joining = resting[rising]
        slots[joining, (slots[joining] < 0).argmax(axis=1)] = steepest[rising]
        going = np.flatnonzero(open_)
        if not going.size:
            break
        # Slots fill from the left: in the first steps most columns are empty in all problems.
        width = 1 + int(np.flatnonzero(slots[going].max(axis=0) >= 0).max(initial=0))
        slots[going, :width], strengths[going, :width], best[going] = _solved(
            grams[going],
            projections[going],
            rays,
            slots[going, :width],
            strengths[going, :width],
        )
    return slots, strengths


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
