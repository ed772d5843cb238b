"""Recognition by the robust distance to a subspace, with scikit-learn's interface."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.distance_classifier import DistanceClassifier, checked_mask
from harmface.recognition.gallery import Gallery
from harmface.recognition.robust import pixel_blocks, robust_distances


class RobustSubspaceClassifier(DistanceClassifier):
    """Name the subject whose subspace lies nearest to most of a probe, see `robust`.

    The method of choice where probes are framed exactly as the gallery, as renderings of meshes
    are; for photographs cropped by hand see `LocalSubspaceClassifier`.

    Parameters
    ----------
    image_shape
        Rows and columns of the images.
    mask
        Pixels that take part, (rows, columns); by default all do.
    dimension
        Dimension of each subject's subspace; `fit` needs as many images of each subject.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    bases_
        Orthonormal rows of each subject, (subjects, dimension, pixels of the mask).
    """

    def __init__(
        self,
        image_shape: tuple[int, int],
        mask: Bool[np.ndarray, "H W"] | None = None,
        dimension: int = 9,
    ) -> None:
        self.image_shape = image_shape
        self.mask = mask
        self.dimension = dimension

    @classmethod
    def from_gallery(cls, gallery: Gallery, method: str = "9d") -> "RobustSubspaceClassifier":
        """Return a fitted classifier of a gallery; probes are then all pixels of its frame.

        Parameters
        ----------
        gallery
            Harmonic images of every subject.
        method
            "3d", "4d" or "9d".
        """
        mask = gallery.mask
        spanning = gallery.spanning(method)
        subjects, dimension, _ = spanning.shape
        images = np.zeros((subjects * dimension, mask.size), spanning.dtype)
        images[:, mask.ravel()] = spanning.reshape(len(images), -1)
        names = np.repeat(np.array(gallery.subjects), dimension)
        return cls(mask.shape, mask, dimension).fit(images, names)

    def fit(self, X: Any, y: Any) -> "RobustSubspaceClassifier":
        """Span each subject's subspace.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (images, pixels).
        y
            The subject of each image.

        Raises
        ------
        ArgumentError
            If a subject has fewer images than `dimension`, or images do not have the shape stated.
        """
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        mask = checked_mask(self.image_shape, self.mask, X.shape[1])
        self.seen_, self.blocks_ = mask.ravel(), pixel_blocks(mask)
        plain = HarmonicSubspaceClassifier(self.dimension).fit(X[:, self.seen_], y)
        self.classes_, self.bases_ = plain.classes_, plain.bases_
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`, in [0, 1]."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        return robust_distances(X[:, self.seen_], self.bases_, self.blocks_)
