"""The illumination cone: all images of an object under all distant light, from its extreme rays.

Light adds up and is never negative, so a convex Lambertian object's images are the sums, with
strengths of at least 0, of its images under single lamps, `max(s . B, 0)`. Finitely many lamps
suffice: those that graze two of its pixels at a time, `s_ij = b_i x b_j` ([BK98]_, proposition 3).
The scaled normals `B` need be known only up to an invertible linear map, since the lamps turn with
them; so three photographs give the whole cone.

References
----------
.. [BK98] Belhumeur and Kriegman, What Is the Set of Images of an Object under All Possible
   Illumination Conditions?, IJCV 1998.
.. [GBK01] Georghiades, Belhumeur and Kriegman, From Few to Many: Illumination Cone Models for
   Face Recognition under Variable Lighting and Pose, PAMI 2001.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.non_negative import nearest_in_cone
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import HARMONIC, PHOTOGRAPHS, RELIT, Gallery
from harmface.recognition.probes import checked_probes

DARK = 0.02
"""Fraction of an image's brightest pixel below which a pixel is in shadow."""

ALTERNATIONS = 30
"""Rounds of fitting lights and scaled normals by turns."""

SHADOW_WEIGHT = 0.02
"""Weight of a pixel that is dark although it faces the lamp: a cast shadow, or a wrong normal that
nothing else corrects."""

PARALLEL = 1e-6
"""Sine of the angle between scaled normals below which they have no cross product to speak of, and
the share of the greatest albedo below which a pixel has no normal to speak of."""


def scaled_normals(images: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "3 p"]:
    """Return albedo times normals up to an invertible linear map, from photographs.

    The best approximation of rank 3 of what is not in shadow, `images ~ L B` ([BK98]_, section 2),
    by weighted least squares. It is in double precision.

    Parameters
    ----------
    images
        Linear photographs under single lamps as rows of pixels, at least 3, none all black.

    Returns
    -------
    numpy.ndarray
        Shape (3, p), in float64.

    Raises
    ------
    ArgumentError
        If there are fewer than three images, or their lights span fewer than three dimensions.
    """
    images = checked_probes(checks.non_negative("images", images), images.shape[1])
    if len(images) < 3:
        raise ArgumentError(f"images must number at least 3 of a subject, got {len(images)}")
    lit = images > DARK * images.max(axis=1, keepdims=True)
    images = images.astype(np.float64)
    left, values, rows = np.linalg.svd(images, full_matrices=False)
    lights, normals = left[:, :3], values[:3, None] * rows[:3]
    for _ in range(0 if lit.all() else ALTERNATIONS):
        # An attached shadow is as dark as it should be, however far its pixels turn away.
        weights = np.where(lit, 1, SHADOW_WEIGHT * (lights @ normals > 0))
        normals = _fitted(images, weights, lights)
        lights = _fitted(images.T, weights.T, normals.T).T
    return _spanning(normals)


def _fitted(
    images: Float[np.ndarray, "n p"],
    weights: Float[np.ndarray, "n p"],
    factor: Float[np.ndarray, "n 3"],
) -> Float[np.ndarray, "3 p"]:
    """Return the weighted least squares fit of every column of the images by the factor."""
    squares = (factor[:, :, None] * factor[:, None]).reshape(len(factor), 9)
    systems = (weights.T @ squares).reshape(-1, 3, 3)
    # A pixel that is dark in all images but two gets the shortest normal that explains it.
    systems += 1e-12 * squares.sum() * np.eye(3)
    right = (weights * images).T @ factor
    return np.linalg.solve(systems, right[..., None])[..., 0].T


def extreme_lights(
    normals: Float[np.ndarray, "3 p"], count: int, rng: np.random.Generator | int
) -> Float[np.ndarray, "J 3"]:
    """Return the directions `+-b_i x b_j` of the lamps whose images are extreme rays of the cone.

    Parameters
    ----------
    normals
        Scaled normals, true or up to a linear map; they must span three dimensions.
    count
        Greatest number of directions: if all pairs of pixels give more, random pairs are taken.
    rng
        Generator or seed for that.

    Returns
    -------
    numpy.ndarray
        Distinct unit directions, each followed by its opposite. Pairs of parallel normals give
        none, and so there may be fewer than `count`.

    Raises
    ------
    ArgumentError
        On NaN, normals in a plane, or a count below 2.
    """
    normals = _spanning(checks.finite("normals", normals).astype(np.float64))
    rng = checks.generator(rng)
    count = checks.integer("count", count, 2)
    lengths = np.linalg.norm(normals, axis=0)
    lit = lengths > PARALLEL * lengths.max()
    unit = (normals[:, lit] / lengths[lit]).T
    if len(unit) * (len(unit) - 1) <= count:
        first, second = np.triu_indices(len(unit), 1)
    else:
        # Twice as many as wanted: some have no cross product, or that of others.
        first, second = rng.integers(len(unit), size=(2, count))
    grazing = np.cross(unit[first], unit[second])
    sines = np.linalg.norm(grazing, axis=1)
    grazing = grazing[sines > PARALLEL] / sines[sines > PARALLEL, None]
    # An axis and its opposite are one; rounding makes those of equal normals equal.
    signs = np.sign(grazing[np.arange(len(grazing)), np.abs(grazing).argmax(axis=1)])
    _, distinct = np.unique(
        np.round(grazing * signs[:, None] / PARALLEL).astype(np.int64), axis=0, return_index=True
    )
    chosen = grazing[np.sort(distinct)[: count // 2]]
    return np.stack([chosen, -chosen], axis=1).reshape(-1, 3)


def lamp_images(
    normals: Float[np.ndarray, "3 p"],
    lights: Float[np.ndarray, "J 3"],
    visibility: Bool[np.ndarray, "J p"] | None = None,
) -> Float[np.ndarray, "J p"]:
    """Return `max(s . B, 0)`, and 0 where a lamp is not visible: the rays of a cone.

    Parameters
    ----------
    normals
        Scaled normals.
    lights
        Directions, such as `extreme_lights`.
    visibility
        Whether each lamp reaches each pixel: cast shadows, from `geometry.visible`, for which the
        normals must be the true ones.

    Returns
    -------
    numpy.ndarray
        Shape (J, p): intensities, at least 0.
    """
    images = np.maximum(lights @ normals, 0)
    return images if visibility is None else images * visibility


def low_dimensional_cone(
    images: Float[np.ndarray, "J p"], dimension: int = 11
) -> tuple[Float[np.ndarray, "d p"], Float[np.ndarray, "lit d"]]:
    """Return orthonormal rows that hold a cone's rays as well as may be, and the rays in them.

    Rays are made of unit norm first; the rows are the leading right singular vectors. [GBK01]_
    found 11 dimensions to hold more than 99 % of the cones of faces.

    Parameters
    ----------
    images
        Rays: images under single lamps; those that are all black are left out.
    dimension
        Of the subspace, fewer if there are fewer rays.

    Returns
    -------
    basis : numpy.ndarray
        Shape (d, p): orthonormal rows.
    rays : numpy.ndarray
        Shape (lit, d): coordinates in the basis of the images that are not all black.

    Raises
    ------
    ArgumentError
        On NaN, or if all are black.
    """
    images = checks.finite("images", images)
    dimension = checks.positive_integer("dimension", dimension)
    norms = np.linalg.norm(images, axis=1)
    if not norms.any():
        raise ArgumentError("images must not all be black")
    unit = (images[norms > 0] / norms[norms > 0, None]).astype(np.float64)
    # The eigenvectors of the small matrix of inner products give the singular vectors.
    energy, mixing = np.linalg.eigh(unit @ unit.T)
    kept = np.flatnonzero(energy > energy[-1] * len(unit) * np.finfo(images.dtype).eps)
    kept = kept[-dimension:][::-1]
    basis = (mixing[:, kept] / np.sqrt(energy[kept])).T @ unit
    return basis, unit @ basis.T


def cone_distances(
    probes: Float[np.ndarray, "n p"],
    basis: Float[np.ndarray, "d p"],
    rays: Float[np.ndarray, "J d"],
) -> Float[np.ndarray, "n"]:
    """Return the distance of every probe to one subject's cone, relative to the probe's norm.

    What lies outside the cone's subspace, and inside it the distance to the nearest sum of rays
    with strengths of at least 0; all probes at once.

    Parameters
    ----------
    probes
        Images as rows of pixels; none may be all black.
    basis, rays
        See `low_dimensional_cone`.

    Returns
    -------
    numpy.ndarray
        Shape (n,), in [0, 1], in the probes' dtype.
    """
    probes = checked_probes(probes, basis.shape[1])
    squared = np.einsum("np,np->n", probes, probes, dtype=np.float64)
    inside = (probes @ basis.T.astype(probes.dtype)).astype(np.float64)
    identities = np.broadcast_to(np.eye(len(basis)), (len(probes), len(basis), len(basis)))
    nearest = nearest_in_cone(inside, identities, rays.astype(np.float64))
    # At the nearest point of a cone the remainder is at right angles to it.
    captured = np.einsum("nd,nd->n", nearest, 2 * inside - nearest) / squared
    return np.sqrt(np.maximum(1 - captured, 0)).astype(probes.dtype)


def _spanning(normals: Float[np.ndarray, "3 p"]) -> Float[np.ndarray, "3 p"]:
    values = np.linalg.svd(normals, compute_uv=False)
    if len(values) < 3 or values[2] <= values[0] * 100 * np.finfo(normals.dtype).eps:
        raise ArgumentError(
            "scaled normals must span three dimensions, got fewer: the surface is flat or bent one "
            "way, or the photographs' lights lie in a plane"
        )
    return normals


@dataclass(frozen=True)
class ConeDistance(Distance):
    """The distance to illumination cones, with attached shadows and without cast ones.

    Parameters
    ----------
    rays
        Greatest number of extreme rays of a cone; [GBK01]_ rendered as many lamps.
    dimension
        Of the subspace that holds a cone.
    rng
        Seed for the choice of the rays, the same for every subject.
    """

    sources = (PHOTOGRAPHS, RELIT, HARMONIC)
    positive_only = True
    rays: int = 120
    dimension: int = 11
    rng: int = 0

    @property
    def harmonics(self) -> slice:
        """Those of degree 1: the scaled normals."""
        return slice(1, 4)

    def fit(self, gallery: Gallery) -> Model:
        """Return each subject's `low_dimensional_cone`, those of fewer rays filled up with zeros.

        Photographs must be at least three of each subject, under single lamps not in a plane.
        """
        cones = []
        each = gallery.spanning(self.source, self.harmonics)
        for name, images in zip(gallery.names, each, strict=True):
            seen = images[:, gallery.mask]
            try:
                normals = seen.astype(np.float64) if self.of_surfaces else scaled_normals(seen)
                lights = extreme_lights(normals, self.rays, self.rng)
                cones.append(low_dimensional_cone(lamp_images(normals, lights), self.dimension))
            except ArgumentError as error:
                raise ArgumentError(f"subject {str(name)!r}: {error}") from None
        most = max(len(basis) for basis, _ in cones)
        bases = np.zeros((len(cones), most, seen.shape[1]))
        rays = np.zeros((len(cones), max(len(own) for _, own in cones), most))
        for number, (basis, own) in enumerate(cones):
            bases[number, : len(basis)], rays[number, : len(own), : len(basis)] = basis, own
        return {"bases": bases, "rays": rays}

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1]."""
        cones = zip(model["bases"], model["rays"], strict=True)
        return np.stack([cone_distances(probes[:, mask], *cone) for cone in cones], axis=1)
