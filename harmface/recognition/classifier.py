"""Recognition by distance to a subspace, with scikit-learn's interface.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.errors import ArgumentError
from harmface.recognition.distance_classifier import DistanceClassifier
from harmface.recognition.gallery import Gallery
from harmface.recognition.subspace import orthonormal_basis, subspace_distances


class HarmonicSubspaceClassifier(DistanceClassifier):
    """Name the subject whose subspace of images lies nearest to a probe ([BJ03]_, [R05]_ 0.4.1).

    A subject's subspace is spanned by what `fit` is given: its harmonic images, rendered from a
    mesh (`from_gallery` does that), or photographs under several lights, of which the leading
    singular vectors are taken. Exposure plays no part: distances are relative to the norm.

    Parameters
    ----------
    dimension
        Dimension of each subject's subspace; `fit` needs as many images of each subject.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    bases_
        Orthonormal rows of each subject, (subjects, dimension, pixels).

    Examples
    --------
    Two subjects, known from two images each, and a brighter image of the second:

    >>> images = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]])
    >>> classifier = HarmonicSubspaceClassifier(dimension=2).fit(images, ["a", "a", "b", "b"])
    >>> str(classifier.predict([[0.0, 0.1, 3.0, 5.0]])[0])
    'b'
    """

    def __init__(self, dimension: int = 9) -> None:
        self.dimension = dimension

    @classmethod
    def from_gallery(cls, gallery: Gallery, method: str = "9d") -> "HarmonicSubspaceClassifier":
        """Return a fitted classifier of a gallery; probes are then pixels of `gallery.mask`.

        Parameters
        ----------
        gallery
            Harmonic images of every subject.
        method
            "3d", "4d" or "9d".
        """
        images = gallery.spanning(method)
        _, dimension, pixels = images.shape
        names = np.repeat(np.array(gallery.subjects), dimension)
        return cls(dimension).fit(images.reshape(-1, pixels), names)

    def fit(self, X: Any, y: Any) -> "HarmonicSubspaceClassifier":
        """Span each subject's subspace.

        Parameters
        ----------
        X
            Images as rows of pixels, (images, pixels): linear, of the same frame.
        y
            The subject of each image.

        Raises
        ------
        ArgumentError
            If a subject has fewer images than `dimension`.
        """
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        self.classes_, which = np.unique(y, return_inverse=True)
        counts = np.bincount(which)
        if counts.min() < self.dimension:
            few = counts.argmin()
            raise ArgumentError(
                f"subject {str(self.classes_[few])!r} has {counts[few]} images, fewer than the "
                f"{self.dimension} dimensions of a subspace; give more images or a lower dimension"
            )
        self.bases_ = np.stack(
            [orthonormal_basis(X[which == c], self.dimension) for c in range(len(counts))]
        )
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`, in [0, 1]."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        return subspace_distances(X, self.bases_)
