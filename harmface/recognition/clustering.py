"""Sorting unlabelled photographs by subject, whatever the light.

Photographs are vertices of a graph; edges tell how alike two of them are, and spectral clustering
cuts it where it is thin ([L07]_). Edges come from any distance: between photographs that are among
the nearest of each other. A subject's photographs hang together by chains of similar light, even if
those under the hardest light are unlike those from the front. Or they come from `conic_affinity`,
the published way.

References
----------
.. [HYLLK03] Ho, Yang, Lim, Lee and Kriegman, Clustering Appearances of Objects under Varying
   Illumination Conditions, CVPR 2003.
.. [L07] von Luxburg, A Tutorial on Spectral Clustering, Statistics and Computing 2007.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float, Integer, Shaped
from scipy.optimize import nnls
from scipy.sparse.csgraph import laplacian
from sklearn.cluster import KMeans, SpectralClustering
from sklearn.metrics.cluster import contingency_matrix

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.distance import Distance
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.probes import checked_probes

BRIDGE = 1e-6
"""Affinity between all, which keeps the graph in one piece, as spectral clustering wants it."""


def conic_affinity(images: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "n n"]:
    """Return how much each image, of unit norm, takes of each other to be made of all others.

    Images of a subject fill a cone, for light adds up and is not negative. So each image is
    fitted by the others with strengths of at least 0, which picks those of its own cone. The
    strengths are made symmetric by their mean, [HYLLK03]_ section 3.1. The method was the subject
    of US patent 7,103,225, filed in 2003 and listed as expired.

    Parameters
    ----------
    images
        Linear photographs as rows of pixels, none all black.

    Returns
    -------
    numpy.ndarray
        Shape (n, n), symmetric, at least 0, with a diagonal of zeros.

    Raises
    ------
    ArgumentError
        If there are fewer than two images, or one is negative or all black.
    """
    images = checked_probes(checks.non_negative("images", images), images.shape[1])
    if len(images) < 2:
        raise ArgumentError(f"images must number at least 2, got {len(images)}")
    unit = images / np.linalg.norm(images, axis=1, keepdims=True)
    # In the basis of the images' span a fit costs as many rows as there are images.
    _, columns = np.linalg.qr(unit.astype(np.float64).T)
    strengths = np.zeros((len(images), len(images)))
    for each in range(len(images)):
        others = np.arange(len(images)) != each
        strengths[each, others] = nnls(columns[:, others], columns[:, each])[0]
    return (strengths + strengths.T) / 2


def mutual_distances(gallery: Gallery, distance: Distance) -> Float[np.ndarray, "n n"]:
    """Return how far each photograph of a gallery is from each other one, whoever they show.

    Parameters
    ----------
    gallery
        Photographs, of which the subjects play no part.
    distance
        One that a single photograph of a subject is enough for; the mean of both ways is taken.

    Returns
    -------
    numpy.ndarray
        Shape (n, n), symmetric, at least 0.
    """
    images = gallery.photographs.images
    each = replace(gallery, photographs=Photographs(np.arange(len(images)), images))
    found = distance.distances(distance.fit(each), images, gallery.mask)
    return (found + found.T) / 2


def neighbours_of(images: int, subjects: int | None = None) -> int:
    """Return how many neighbours to link each image to.

    That many times the logarithm keep the images of a subject in one piece ([L07]_ section 8.2:
    the number must grow as the logarithm of the number of images), but never more than a subject
    has other images on average.

    Parameters
    ----------
    images
        How many there are.
    subjects
        How many of these there are, if known.

    Returns
    -------
    int
        At least 1.
    """
    enough = int(np.ceil(2 * np.log(images)))
    others = images - 1 if subjects is None else images // subjects - 1
    return max(1, min(enough, others))


def neighbour_affinity(
    distances: Float[np.ndarray, "n n"], neighbours: int
) -> Float[np.ndarray, "n n"]:
    """Return 1 for two images that are neighbours of each other, 1/2 if only one is of the other.

    Parameters
    ----------
    distances
        Of every image to every other.
    neighbours
        How many of the nearest images are neighbours of an image, from 1 to n - 1.

    Returns
    -------
    numpy.ndarray
        Shape (n, n), symmetric, of 0, 1/2 and 1.

    Raises
    ------
    ArgumentError
        If there are not that many other images.
    """
    distances = checks.finite("distances", distances).copy()
    neighbours = checks.positive_integer("neighbours", neighbours)
    if neighbours >= len(distances):
        raise ArgumentError(
            f"neighbours must be fewer than the {len(distances)} images, got {neighbours}"
        )
    np.fill_diagonal(distances, np.inf)
    nearest = np.argsort(distances, axis=1, kind="stable")[:, :neighbours]
    linked = np.zeros(distances.shape)
    np.put_along_axis(linked, nearest, 1, axis=1)
    return (linked + linked.T) / 2


def likely_subjects(affinity: Float[np.ndarray, "n n"], fewest: int = 2) -> int:
    """Return how many subjects there seem to be, by the largest gap between eigenvalues.

    Of a graph in so many parts as many eigenvalues of the normalised Laplacian are 0; of one in
    nearly separate parts they are small, [L07]_ section 8.3.

    Parameters
    ----------
    affinity
        Between images.
    fewest
        Images that a subject has at least.

    Returns
    -------
    int
        At least 2.
    """
    most = max(2, len(affinity) // fewest)
    values = np.linalg.eigvalsh(laplacian(affinity + BRIDGE, normed=True))[: most + 1]
    return 2 + int(np.diff(values)[1:].argmax())


def cluster_subjects(
    affinity: Float[np.ndarray, "n n"], subjects: int, seed: int = 0
) -> Integer[np.ndarray, "n"]:
    """Return a number for each image, the same for images of the same subject.

    Parameters
    ----------
    affinity
        Between images: at least 0, symmetric.
    subjects
        How many subjects there are, at least 2 and fewer than images.
    seed
        Of the clustering's starting points.

    Returns
    -------
    numpy.ndarray
        Shape (n,), from 0 to `subjects - 1`, in int64.

    Raises
    ------
    ArgumentError
        If there cannot be as many subjects.
    """
    subjects = _checked_subjects(len(affinity), subjects)
    model = SpectralClustering(subjects, affinity="precomputed", random_state=seed)
    return model.fit_predict(affinity + BRIDGE).astype(np.int64)


def kmeans_subjects(
    images: Float[np.ndarray, "n p"], subjects: int, seed: int = 0
) -> Integer[np.ndarray, "n"]:
    """Return a number for each image by k-means of images of unit norm, to compare with.

    Parameters
    ----------
    images
        Linear photographs as rows of pixels, none all black.
    subjects
        How many subjects there are, at least 2 and fewer than images.
    seed
        Of the clustering's ten starting points.

    Returns
    -------
    numpy.ndarray
        Shape (n,), from 0 to `subjects - 1`, in int64.

    Raises
    ------
    ArgumentError
        If there cannot be as many subjects.
    """
    images = checked_probes(images, images.shape[1])
    subjects = _checked_subjects(len(images), subjects)
    unit = images / np.linalg.norm(images, axis=1, keepdims=True)
    return KMeans(subjects, n_init=10, random_state=seed).fit_predict(unit).astype(np.int64)


def purity(found: Integer[np.ndarray, "n"], truth: Shaped[np.ndarray, "n"]) -> float:
    """Return the share of images that show the subject that most images of their group show.

    Parameters
    ----------
    found
        Number of each image's group.
    truth
        Name of each image's subject.

    Returns
    -------
    float
        In (0, 1].

    Examples
    --------
    >>> purity(np.array([0, 0, 0, 1]), np.array(["a", "a", "b", "b"]))
    0.75
    """
    return float(contingency_matrix(truth, found).max(axis=0).sum() / len(found))


def _checked_subjects(images: int, subjects: int) -> int:
    subjects = checks.positive_integer("subjects", subjects)
    if not 2 <= subjects < images:
        raise ArgumentError(
            f"subjects must be at least 2 and fewer than the {images} images, got {subjects}"
        )
    return subjects
