"""What recognisers by subspaces share that need to know how pixels lie in the picture."""

from typing import Any

import numpy as np
from jaxtyping import Bool
from sklearn.utils.validation import validate_data

from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.distance_classifier import DistanceClassifier, checked_mask


class FramedSubspaceClassifier(DistanceClassifier):
    """Span each subject's subspace over the mask of a frame; a subclass computes distances.

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
    mask_
        Pixels that take part.
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

    def fit(self, X: Any, y: Any) -> "FramedSubspaceClassifier":
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
        self.mask_ = checked_mask(self.image_shape, self.mask, X.shape[1])
        plain = HarmonicSubspaceClassifier(self.dimension).fit(X[:, self.mask_.ravel()], y)
        self.classes_, self.bases_ = plain.classes_, plain.bases_
        return self
