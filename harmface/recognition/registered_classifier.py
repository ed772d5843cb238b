"""Recognition of probes that are framed a little differently, with scikit-learn's interface."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.distance_classifier import DistanceClassifier, checked_mask
from harmface.recognition.registration import CANDIDATES, Motion, registered_distances


class RegisteredSubspaceClassifier(DistanceClassifier):
    """Name the subject whose subspace lies nearest after registration, see `registration`.

    Parameters
    ----------
    image_shape
        Rows and columns of the images.
    mask
        Pixels that take part, (rows, columns); by default all do.
    dimension
        Dimension of each subject's subspace; `fit` needs as many images of each subject.
    candidates
        Subjects that a probe is registered to, each on its own.

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
        candidates: int = CANDIDATES,
    ) -> None:
        self.image_shape = image_shape
        self.mask = mask
        self.dimension = dimension
        self.candidates = candidates

    def fit(self, X: Any, y: Any) -> "RegisteredSubspaceClassifier":
        """Span each subject's subspace by linear images as rows of all their pixels.

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

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every registered image to every subject of `classes_`."""
        return self.register(X)[0]

    def register(self, X: Any) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the distances, and how each image lies against its nearest subject."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        probes = X.reshape(-1, *self.mask_.shape)
        return registered_distances(probes, self.bases_, self.mask_, self.candidates)
