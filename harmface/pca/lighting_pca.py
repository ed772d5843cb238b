"""Principal components of images under varying light, written down from a Gram matrix.

An image under lighting coefficients `L` is `rho_i sum_k A_k L_k Y_k(n_i)`. With `S` the
covariance of `L` and `Q` the Gram matrix of the harmonics over the visible normals, the images'
covariance has the eigenvalues of the `K x K` matrix `S^1/2 A Q A S^1/2`, whatever the number of
pixels ([R02]_; [R05]_ 0.3.3).

References
----------
.. [R02] Ramamoorthi, Analytic PCA Construction for Theoretical Analysis of Lighting
   Variability in Images of a Lambertian Object, PAMI 2002.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.pca.distributions import LightDistribution, uniform_lights
from harmface.reflectance import lambert_per_coefficient
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class LightingPCA:
    """Principal components of lighting variability, as functions of the normal.

    Parameters
    ----------
    eigenvalues
        Variance of the images along each mode, falling; zeros included.
    expansion
        Mode `j` is `rho sum_k expansion[j, k] Y_k(n)`: one row for each eigenvalue above zero.
        Modes have norm 1 under the weights of the Gram matrix. The coefficient of largest
        magnitude is positive: a mode that is mostly `x` is bright on the right.
    """

    eigenvalues: Float[np.ndarray, "K"]
    expansion: Float[np.ndarray, "modes K"]

    __repr__ = summary

    @property
    def max_degree(self) -> int:
        """Highest degree of the harmonics."""
        return max_degree_of(len(self.eigenvalues))

    @property
    def fractions(self) -> Float[np.ndarray, "K"]:
        """Share of each mode in the variance."""
        return self.eigenvalues / self.eigenvalues.sum()

    @property
    def cumulative(self) -> Float[np.ndarray, "K"]:
        """Share of the first modes together in the variance."""
        return np.cumsum(self.fractions)


def lighting_pca(
    gram: Float[np.ndarray, "K K"],
    light: LightDistribution | None = None,
    *,
    subtract_mean: bool = True,
) -> LightingPCA:
    """Return the principal components for a Gram matrix of visible normals.

    Parameters
    ----------
    gram
        Inner products of the harmonics over the visible normals, weighted by the squared
        albedo: of an image (`harmonic_gram`) or of a canonical shape (`sphere_gram`, ...).
    light
        How the light varies; by default one directional light uniform over the sphere.
    subtract_mean
        Whether components are about the mean image, or else about black.

    Returns
    -------
    LightingPCA
        Variances in falling order, and components as sums of harmonics.

    Raises
    ------
    ArgumentError
        If the light is of another degree, or no image differs from the mean.

    Examples
    --------
    All normals of a sphere: the components are the harmonics, with variance `A_l^2 / 4 pi`.

    >>> lighting_pca(np.eye(9)).fractions.round(3)
    array([0.27 , 0.27 , 0.27 , 0.038, 0.038, 0.038, 0.038, 0.038, 0.   ])
    """
    gram = checks.finite("gram", gram)
    degree = max_degree_of(len(gram))
    if light is None:
        light = uniform_lights(degree)
    if light.max_degree != degree:
        raise ArgumentError(
            f"light must have coefficients to degree {degree} as the Gram matrix has, got degree "
            f"{light.max_degree}; make both of the same degree"
        )
    transfer = lambert_per_coefficient(degree)
    scaled_root = transfer[:, None] * _root(
        light.covariance if subtract_mean else light.second_moment
    )
    values, vectors = np.linalg.eigh(scaled_root.T @ gram @ scaled_root)
    values, vectors = np.maximum(values[::-1], 0), vectors[:, ::-1]
    if values[0] == 0:
        raise ArgumentError(
            "light must make images that differ, but none varies; give more lights, "
            "or keep the mean"
        )
    kept = values > len(values) * np.finfo(np.float64).eps * values[0]
    expansion = (scaled_root @ (vectors[:, kept] / np.sqrt(values[kept]))).T
    largest = np.abs(expansion).argmax(axis=1)[:, None]
    expansion *= np.sign(np.take_along_axis(expansion, largest, axis=1))
    return LightingPCA(values, expansion)


def _root(covariance: Float[np.ndarray, "K K"]) -> Float[np.ndarray, "K K"]:
    """Return `R` with `R R^T = covariance`; any root gives the same components."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0))
