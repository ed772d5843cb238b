"""Sorting unlabelled photographs by subject, whatever the light.

References
----------
.. [HYLLK03] Ho, Yang, Lim, Lee and Kriegman, Clustering Appearances of Objects under Varying
   Illumination Conditions, CVPR 2003.
"""

import numpy as np
from jaxtyping import Float, Integer
from scipy.optimize import nnls
from sklearn.cluster import SpectralClustering

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.probes import checked_probes


def conic_affinity(images: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "n n"]:
    """Return how much each image, of unit norm, takes of each other to be made of all others.

    Images of a subject fill a cone, for light adds up and is not negative. So each image is
    fitted by the others with strengths of at least 0, which picks those of its own cone. The
    strengths are made symmetric by their mean, [HYLLK03]_ section 3.1.

    Parameters
    ----------
    images
        Linear photographs as rows of pixels, none all black.
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


def cluster_subjects(
    images: Float[np.ndarray, "n p"], subjects: int, seed: int = 0
) -> Integer[np.ndarray, "n"]:
    """Return a number for each image, the same for images of the same subject.

    Spectral clustering of the conic affinities, [HYLLK03]_. Light from the front is sorted well;
    images under grazing light, mostly shadow, have neighbours among other subjects.

    Parameters
    ----------
    images
        Linear photographs as rows of pixels, aligned, none all black.
    subjects
        How many subjects there are, at least 2 and fewer than images.
    seed
        Of the clustering's starting points.
    """
    subjects = checks.positive_integer("subjects", subjects)
    if not 2 <= subjects < len(images):
        raise ArgumentError(
            f"subjects must be at least 2 and fewer than the {len(images)} images, got {subjects}"
        )
    # A touch of affinity between all keeps the graph in one piece, as the method wants it.
    affinity = conic_affinity(images) + 1e-6
    model = SpectralClustering(subjects, affinity="precomputed", random_state=seed)
    return model.fit_predict(affinity).astype(np.int64)
