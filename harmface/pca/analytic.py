"""Analytic PCA of the images of one object, from its visible normals alone."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.pca.distributions import LightDistribution
from harmface.pca.gram import CHUNK, chunks, harmonic_gram
from harmface.pca.lighting_pca import LightingPCA, lighting_pca
from harmface.pca.pixels import visible_pixels
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class AnalyticPCA(LightingPCA):
    """Principal components of the images of one object.

    Parameters
    ----------
    eigenvalues, expansion
        As in `LightingPCA`.
    normals
        Unit normals of the image.
    albedo
        Albedo of each pixel.
    weights
        Weight of each pixel; 0 where nothing is seen.
    """

    normals: Float[np.ndarray, "*pixels 3"]
    albedo: Float[np.ndarray, "*pixels"]
    weights: Float[np.ndarray, "*pixels"]

    __repr__ = summary

    def modes(self, count: int) -> Float[np.ndarray, "count *pixels"]:
        """Return the first modes as images, computed now, pixels of weight 0 black.

        They are orthonormal under the weights: `sum_i w_i e_i f_i` is 1 or 0.

        Parameters
        ----------
        count
            How many, at most the number of eigenvalues above zero.

        Returns
        -------
        numpy.ndarray
            Shape `(count, *pixels)`, of unit length over the weighted pixels.

        Raises
        ------
        ArgumentError
            If `count` is below 1 or more than there are.
        """
        count = checks.positive_integer("count", count)
        if count > len(self.expansion):
            raise ArgumentError(
                f"count must be at most {len(self.expansion)}, the modes this light has here, "
                f"got {count}; ask for fewer modes or vary the light more"
            )
        expansion = self.expansion[:count].astype(self.normals.dtype, copy=False)
        seen = np.flatnonzero(self.weights)
        normals, albedo = self.normals.reshape(-1, 3), self.albedo.reshape(-1)
        images = np.zeros((count, self.weights.size), normals.dtype)
        for some in chunks(len(seen), CHUNK):
            pixels = seen[some]
            shading = expansion @ real_harmonics(normals[pixels], self.max_degree)
            images[:, pixels] = shading * albedo[pixels]
        return images.reshape(count, *self.weights.shape)


def analytic_pca(
    normals: Float[np.ndarray, "*pixels 3"],
    albedo: Float[np.ndarray, "*pixels"] | None = None,
    weights: Float[np.ndarray, "*pixels"] | None = None,
    light: LightDistribution | None = None,
    max_degree: int = 8,
    subtract_mean: bool = True,
) -> AnalyticPCA:
    """Return the principal components of an object's images under varying light.

    Attached shadows are in them; cast shadows are not. One pass over the pixels, in time
    proportional to their number, see `lighting_pca` for the rest. Degree 8 leaves out 0.03 % of
    what a directional light does.

    Parameters
    ----------
    normals
        Unit normals; zero vectors are background.
    albedo
        Fraction of the light reflected, not negative; by default 1.
    weights
        Weight of each pixel, not negative; by default every pixel counts the same.
    light
        How the light varies; by default one directional light of irradiance 1, uniform over
        the sphere.
    max_degree
        Highest degree of the harmonics.
    subtract_mean
        Whether components are about the mean image, or else about black.

    Returns
    -------
    AnalyticPCA
        Eigenvalues in falling order, as many as there are harmonics that a surface reflects.

    Raises
    ------
    ArgumentError
        If nothing is visible, a normal is neither zero nor of unit length, albedo or weights
        are negative, or the weights are all zero.

    Examples
    --------
    Two pixels, and light from anywhere: it brightens both, or one against the other.

    >>> two = np.array([[-0.6, 0, 0.8], [0.6, 0, 0.8]])
    >>> pca = analytic_pca(two, max_degree=1)
    >>> pca.fractions.round(3)
    array([0.64, 0.36, 0.  , 0.  ])
    >>> pca.modes(2).round(3)
    array([[ 0.707,  0.707],
           [-0.707,  0.707]])
    """
    normals, albedo, weights = visible_pixels(normals, albedo, weights)
    seen = weights > 0
    # Odd degrees above 1 are not reflected: more than a third of all harmonics.
    reflected = np.flatnonzero(lambert_per_coefficient(max_degree))
    squared_albedo = weights[seen] * np.square(albedo[seen])
    gram = harmonic_gram(normals[seen], squared_albedo, max_degree, reflected)
    pca = lighting_pca(gram, light, subtract_mean=subtract_mean)
    return AnalyticPCA(pca.eigenvalues, pca.expansion, normals, albedo, weights)
