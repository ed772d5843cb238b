"""Recognition by the nearest image of the gallery, after any transformation of the images."""

from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.distance import cdist
from sklearn.base import clone
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.distance_classifier import DistanceClassifier


class NearestImageClassifier(DistanceClassifier):
    """Name the subject of the gallery's nearest image, by Euclidean distance of features.

    Parameters
    ----------
    features
        A transformer of scikit-learn from images as rows of pixels to rows of features; by
        default the pixels themselves.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    """

    def __init__(self, features: Any = None) -> None:
        self.features = features

    def fit(self, X: Any, y: Any) -> "NearestImageClassifier":
        """Fit the features and keep those of the gallery."""
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        self.classes_, self.which_ = np.unique(y, return_inverse=True)
        if self.features is None:
            self.gallery_ = X
        else:
            self.features_ = clone(self.features).fit(X, y)
            self.gallery_ = self.features_.transform(X)
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to the nearest of every subject of `classes_`."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        probes = X if self.features is None else self.features_.transform(X)
        each = cdist(probes, self.gallery_)
        nearest = np.full((len(X), len(self.classes_)), np.inf)
        np.minimum.at(nearest.T, self.which_, each.T)
        return nearest
