"""Precomputed transfer to glossy surfaces: what they show from any side, and its compression.

References
----------
.. [SKS02] Sloan, Kautz and Snyder, Precomputed Radiance Transfer for Real-Time Rendering in
   Dynamic, Low-Frequency Lighting Environments, SIGGRAPH 2002.
.. [SHHS03] Sloan, Hall, Hart and Snyder, Clustered Principal Components for Precomputed Radiance
   Transfer, SIGGRAPH 2003.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.geometry import Mesh
from harmface.rendering.precomputed_transfer import SAMPLES, visibility_coefficients
from harmface.sphere import multiplication_matrix, real_harmonics

SETTLED = 1e-4
"""Share by which a round of clustering must lower the error for another to follow."""


def glossy_transfer(
    mesh: Mesh,
    lobe: Float[np.ndarray, "L"],
    *,
    samples: int = SAMPLES,
    rng: np.random.Generator | int = 0,
) -> Float[np.ndarray, "V K K"]:
    """Return matrices from distant light to what each vertex shows in each mirrored direction.

    The light that is not hidden is the product of light and visibility, whose matrix up to degree
    `d` needs the visibility to degree `2 d` and no more ([SKS02]_ section 5); a lobe about the
    mirror direction scales its degrees ([R05]_ eq. 37-39). Shown in the direction whose mirror
    image about the normal is `r` is then `Y(r) @ matrix @ L`, see `glossy_radiance`.

    Parameters
    ----------
    mesh
        The surface; it does not reflect to itself.
    lobe
        Factor of each degree, 1 at degree 0: all ones for a mirror, falling fast for a dull
        surface.
    samples
        Number of directions over the whole sphere, even.
    rng
        Generator or seed.

    Returns
    -------
    numpy.ndarray
        A matrix for each vertex, shape (V, K, K).

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """
    lobe = checks.finite("lobe", lobe)
    if lobe.ndim != 1 or len(lobe) == 0:
        raise ArgumentError(f"lobe must have a factor for each degree, got shape {lobe.shape}")
    degree = len(lobe) - 1
    visibility = visibility_coefficients(mesh, 2 * degree, samples=samples, rng=rng)
    matrices = multiplication_matrix(visibility.T, degree, degree)
    return lobe[degrees(degree)][:, None] * matrices


def glossy_radiance(
    shown: Float[np.ndarray, "V *channels_K"],
    normals: Float[np.ndarray, "V 3"],
    to_camera: Float[np.ndarray, "V 3"],
) -> Float[np.ndarray, "V *channels"]:
    """Return the radiance that vertices send to a camera.

    Parameters
    ----------
    shown
        Coefficients over the mirrored direction: `matrices @ light`, or `ClusteredTransfer.apply`.
    normals
        Unit normals.
    to_camera
        Unit directions to the camera; what lies behind the surface is dark.

    Returns
    -------
    numpy.ndarray
        Radiance, `(V, *channels)`; 0 where the camera is behind the surface.

    Raises
    ------
    ArgumentError
        If a direction is not of unit length.
    """
    shown = checks.finite("shown", shown)
    normals = checks.unit_vectors("normals", normals)
    to_camera = checks.unit_vectors("to_camera", to_camera)
    along = np.einsum("vi,vi->v", normals, to_camera)
    mirrored = 2 * along[:, None] * normals - to_camera
    mirrored /= np.linalg.norm(mirrored, axis=1, keepdims=True)
    basis = real_harmonics(mirrored, int(np.sqrt(shown.shape[-1])) - 1)
    radiance = np.einsum("kv,v...k->v...", basis, shown)
    front = (along > 0).reshape(-1, *[1] * (radiance.ndim - 1))
    return np.asarray(radiance * front)


@dataclass(frozen=True, eq=False)
class ClusteredTransfer:
    """Matrices as combinations of a few for each cluster of vertices ([SHHS03]_ eq. 5).

    Parameters
    ----------
    cluster
        Which cluster each vertex belongs to.
    means
        Mean matrix of each cluster.
    bases
        Principal components of each cluster.
    weights
        Of the components, for each vertex.
    """

    cluster: Integer[np.ndarray, "V"]
    means: Float[np.ndarray, "C K K"]
    bases: Float[np.ndarray, "C n K K"]
    weights: Float[np.ndarray, "V n"]

    def matrices(self) -> Float[np.ndarray, "V K K"]:
        """Return the matrices that are stood for.

        Returns
        -------
        numpy.ndarray
            A matrix for each vertex, shape (V, K, K).
        """
        change = np.einsum("vn,vnij->vij", self.weights, self.bases[self.cluster])
        return np.asarray(self.means[self.cluster] + change)

    def apply(self, light: Float[np.ndarray, "*channels K"]) -> Float[np.ndarray, "V *channels_K"]:
        """Return `matrices() @ light`, a product for each component instead of each vertex.

        Parameters
        ----------
        light
            Coefficients of radiance.

        Returns
        -------
        numpy.ndarray
            Coefficients over the mirrored direction, `(V, *channels, K)`.
        """
        means = np.einsum("cij,...j->c...i", self.means, light)
        bases = np.einsum("cnij,...j->cn...i", self.bases, light)
        change = np.einsum("vn,vn...i->v...i", self.weights, bases[self.cluster])
        return np.asarray(means[self.cluster] + change)


def clustered_pca(
    matrices: Float[np.ndarray, "V K K"],
    clusters: int,
    components: int,
    *,
    rounds: int = 20,
    rng: int = 0,
) -> ClusteredTransfer:
    """Return matrices compressed by principal components of clusters ([SHHS03]_ section 4).

    K-means begins; then each round fits an affine subspace to each cluster and moves every vertex
    to the subspace nearest to it, neither of which can raise the squared error.

    Parameters
    ----------
    matrices
        One for each vertex.
    clusters
        Number of clusters.
    components
        Dimension of each subspace.
    rounds
        Most rounds; they end when the error hardly falls.
    rng
        Seed of K-means.

    Returns
    -------
    ClusteredTransfer
        Cluster and weights of each vertex, mean and basis of each cluster.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """
    from sklearn.cluster import KMeans

    matrices = checks.finite("matrices", matrices)
    signals = matrices.reshape(len(matrices), -1)
    clusters = checks.positive_integer("clusters", clusters)
    components = checks.integer("components", components, 0)
    if clusters > len(signals) or components > signals.shape[1]:
        raise ArgumentError(
            f"clusters and components must be at most {len(signals)} and {signals.shape[1]}, as "
            f"many as there are vertices and entries, got {clusters} and {components}"
        )
    cluster = KMeans(clusters, n_init=1, random_state=rng).fit(signals).labels_
    before = np.inf
    for _ in range(checks.positive_integer("rounds", rounds)):
        means = np.zeros((clusters, signals.shape[1]))
        bases = np.zeros((clusters, components, signals.shape[1]))
        for number in range(clusters):
            members = signals[cluster == number]
            if len(members):
                means[number] = members.mean(axis=0)
                rows = np.linalg.svd(members - means[number], full_matrices=False)[2][:components]
                bases[number, : len(rows)] = rows
        errors = np.empty((clusters, len(signals)))
        for number in range(clusters):
            centred = signals - means[number]
            inside = centred @ bases[number].T
            errors[number] = (centred**2).sum(axis=1) - (inside**2).sum(axis=1)
        nearest = errors.argmin(axis=0)
        error = errors[cluster, np.arange(len(signals))].sum()
        if error >= (1 - SETTLED) * before:
            break
        before, cluster = error, nearest
    weights = np.empty((len(signals), components))
    for number in range(clusters):
        members = nearest == number
        weights[members] = (signals[members] - means[number]) @ bases[number].T
    shape = matrices.shape[1:]
    return ClusteredTransfer(
        nearest, means.reshape(-1, *shape), bases.reshape(clusters, components, *shape), weights
    )
