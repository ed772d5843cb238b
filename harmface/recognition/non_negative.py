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

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Integer
from threadpoolctl import threadpool_limits

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import HARMONIC, SHADOWED, Gallery
from harmface.recognition.probes import checked_probes
from harmface.sphere import fibonacci_directions, real_harmonics

DIRECTIONS = 150
"""Directions of the sampled light, 17 degrees apart: finer than nine harmonics resolve."""

TOLERANCE = 1e-6
"""Ascent, relative to the projections, that counts as none."""

MAX_STEPS = 100
"""Steps of the active set: a handful would do for nine dimensions."""

CHUNK = 2**10
"""Pairs solved at a time: 2 MB, which a cache holds; many more take twice as long."""


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
    projections, grams, squared = small_problems(probes, images)
    light = _nearest_lights(projections, grams)
    fitted = np.einsum("nsk,skl,nsl->ns", light, grams, light, optimize=True)
    crossed = np.einsum("nsk,nsk->ns", light, projections)
    relative = 1 + (fitted - 2 * crossed) / squared[:, None]
    return np.sqrt(np.maximum(relative, 0)).astype(checks.floating("probes", probes).dtype)


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
    return _nearest_lights(projections, grams)


def _nearest_lights(
    projections: Float[np.ndarray, "n N K"], grams: Float[np.ndarray, "N K K"]
) -> Float[np.ndarray, "n N K"]:
    """Solve the problems of all pairs, a few at a time."""
    count, subjects, functions = projections.shape
    rays = sampled_light(max_degree_of(functions))
    flat = projections.reshape(-1, functions)
    which = np.tile(np.arange(subjects), count)
    # Subjects resemble each other: the light that suits all together is a good place to start.
    mean = np.broadcast_to(grams.mean(axis=0), (count, functions, functions))
    slots, strengths = active_rays(projections.mean(axis=1), mean, rays)
    light = np.empty_like(flat)
    for first in range(0, len(flat), CHUNK):
        some = slice(first, first + CHUNK)
        probe = np.arange(len(flat))[some] // subjects
        start = slots[probe], strengths[probe]
        light[some] = nearest_in_cone(flat[some], grams[which[some]], rays, start)
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
    grams = np.empty((subjects, functions, functions))
    for first in range(0, subjects, CHUNK):
        some = images[first : first + CHUNK].astype(np.float64)
        grams[first : first + CHUNK] = some @ some.swapaxes(1, 2)
    return projections, grams, np.einsum("np,np->n", probes, probes).astype(np.float64)


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


@dataclass(frozen=True)
class NonNegativeDistance(Distance):
    """The `non_negative_distances`, to harmonic images of degree 2."""

    sources = (HARMONIC, SHADOWED)
    source: str = HARMONIC

    def fit(self, gallery: Gallery) -> Model:
        """Return the harmonic images over the mask."""
        images = np.stack(gallery.spanning(self.source, self.harmonics))
        return {"images": images[..., gallery.mask]}

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1]."""
        return non_negative_distances(probes[:, mask], model["images"])

    def light(
        self, probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "n K p"]
    ) -> Float[np.ndarray, "n K"]:
        """Return the non-negative light under which a subject looks most like each probe."""
        return np.einsum("iik->ik", non_negative_light(probes, images))
