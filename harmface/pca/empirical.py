"""Empirical PCA of images under varying light, rendered or photographed."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.pca.pixels import pixel_weights, visible_pixels
from harmface.pca.snapshots import Block, over_images, over_pixels
from harmface.rendering import clamped_cosines
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class EmpiricalPCA:
    """Leading principal components of a stack of images.

    Parameters
    ----------
    eigenvalues
        Variance of the images along each mode, falling.
    modes
        Images, orthonormal under the weights; the value of largest magnitude is positive.
    origin
        The image about which the components are taken: the mean, or black.
    scores
        Coordinates of each image along the modes, from the origin.
    energies
        Squared distance of each image from the origin, under the weights.
    weights
        Weight of each pixel; 0 where nothing is seen.
    subtract_mean
        Whether the origin is the mean.
    """

    eigenvalues: Float[np.ndarray, "count"]
    modes: Float[np.ndarray, "count *pixels"]
    origin: Float[np.ndarray, "*pixels"]
    scores: Float[np.ndarray, "F count"]
    energies: Float[np.ndarray, "F"]
    weights: Float[np.ndarray, "*pixels"]
    subtract_mean: bool

    __repr__ = summary

    @property
    def fractions(self) -> Float[np.ndarray, "count"]:
        """Share of each mode in the variance along all modes, computed or not."""
        return self.eigenvalues / self.energies.mean()

    @property
    def cumulative(self) -> Float[np.ndarray, "count"]:
        """Share of the first modes together in the variance along all."""
        return np.cumsum(self.fractions)


def empirical_pca(
    images: Float[np.ndarray, "F *pixels"],
    weights: Float[np.ndarray, "*pixels"] | None = None,
    count: int = 9,
    subtract_mean: bool = True,
) -> EmpiricalPCA:
    """Return the leading principal components of a stack of images.

    The matrix decomposed has the side of the fewer of images and pixels. The stack is read
    in blocks, so it may be a memory map larger than memory.

    Parameters
    ----------
    images
        Linear images.
    weights
        Weight of each pixel, not negative; 0 leaves it out. By default all count the same.
    count
        How many components.
    subtract_mean
        Whether components are about the mean image, or else about black.

    Returns
    -------
    EmpiricalPCA
        Its `count` leading modes.

    Raises
    ------
    ArgumentError
        If there are too few images or pixels for so many components, the images span fewer, a
        value is NaN or infinite, or the weights are negative or all zero.

    Examples
    --------
    >>> images = np.array([[1.0, 0.0], [3.0, 0.0], [2.0, 0.5], [2.0, -0.5]])
    >>> empirical_pca(images, count=2).fractions
    array([0.8, 0.2])
    """
    images = checks.array_of("images", images)
    weights = pixel_weights(weights, images.shape[1:])
    seen = np.flatnonzero(weights)
    flat = images.reshape(len(images), -1)

    def block(some: slice, where: slice) -> Float[np.ndarray, "n c"]:
        return checks.finite("images", flat[some][:, seen[where]])

    return _decompose(block, len(images), weights, count, subtract_mean)


def attached_shadow_pca(
    normals: Float[np.ndarray, "*pixels 3"],
    directions: Float[np.ndarray, "F 3"],
    albedo: Float[np.ndarray, "*pixels"] | None = None,
    weights: Float[np.ndarray, "*pixels"] | None = None,
    count: int = 9,
    subtract_mean: bool = True,
) -> EmpiricalPCA:
    """Return the components of the images of an object under each of many directional lights.

    The images are `albedo max(n . w, 0)`, without harmonics; they are made in blocks and never
    held together.

    Parameters
    ----------
    normals
        Unit normals; zero vectors are background. The images have their precision.
    directions
        Unit directions to the lights, each of irradiance 1.
    albedo
        Fraction of the light reflected, not negative; by default 1.
    weights
        Weight of each pixel, not negative; by default all count the same.
    count
        How many components.
    subtract_mean
        Whether components are about the mean image, or else about black.

    Returns
    -------
    EmpiricalPCA
        Its `count` leading modes.

    Raises
    ------
    ArgumentError
        As `analytic_pca` and `empirical_pca` do.
    """
    normals, albedo, weights = visible_pixels(normals, albedo, weights)
    directions = checks.unit_vectors("directions", directions).astype(normals.dtype)
    seen = np.flatnonzero(weights)
    seen_normals = normals.reshape(-1, 3)[seen]
    seen_albedo = albedo.reshape(-1)[seen].astype(normals.dtype)

    def block(some: slice, where: slice) -> Float[np.ndarray, "n c"]:
        shading = clamped_cosines(seen_normals[where], directions[some])
        shading *= seen_albedo[where]
        return shading

    return _decompose(block, len(directions), weights, count, subtract_mean)


def _decompose(
    block: Block,
    images: int,
    weights: Float[np.ndarray, "*pixels"],
    count: int,
    subtract_mean: bool,
) -> EmpiricalPCA:
    """Return the components of the images that `block` makes of the pixels of positive weight."""
    seen = np.flatnonzero(weights)
    count = checks.positive_integer("count", count)
    most = min(images - subtract_mean, len(seen))
    if count > most:
        raise ArgumentError(
            f"count must be at most {most} with {images} images of {len(seen)} pixels, got "
            f"{count}; ask for fewer modes or give more images"
        )
    roots = np.sqrt(weights.reshape(-1)[seen])
    solve = over_images if images <= len(seen) else over_pixels
    found = solve(block, images, roots, count, subtract_mean)
    modes = found.modes / roots.astype(found.modes.dtype)
    largest = np.abs(modes).argmax(axis=1)[:, None]
    signs = np.sign(np.take_along_axis(modes, largest, axis=1))

    def spread(values: Float[np.ndarray, "... p"]) -> Float[np.ndarray, "..."]:
        full = np.zeros((*values.shape[:-1], weights.size), values.dtype)
        full[..., seen] = values
        return full.reshape(*values.shape[:-1], *weights.shape)

    return EmpiricalPCA(
        found.eigenvalues,
        spread(signs * modes),
        spread(found.origin),
        found.scores * signs[:, 0],
        found.energies,
        weights,
        subtract_mean,
    )
