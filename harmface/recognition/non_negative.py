"""The nearest image under light that is nowhere negative.

A free fit of a harmonic subspace may call on negative light, which makes a subject look like
more images than it can; see `light.non_negative` for light that excludes this ([BJ03]_). An image
is `a H S`, with `a` the strengths, `H` the harmonics of the sampled directions and `S` the harmonic
images.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.light.non_negative import active_rays, nearest_in_cone, sampled_light
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import HARMONIC, SHADOWED, Gallery
from harmface.recognition.probes import checked_probes

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

    Returns
    -------
    numpy.ndarray
        Shape (n, N), in [0, 1], in the probes' dtype.

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
