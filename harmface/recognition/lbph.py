"""Histograms of local binary patterns, by OpenCV."""

from typing import Any

import cv2
import numpy as np
from jaxtyping import Float
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.distance_classifier import DistanceClassifier


class LbphClassifier(DistanceClassifier):
    """Name the subject with the nearest histograms of local binary patterns (OpenCV's LBPH).

    Parameters
    ----------
    image_shape
        Rows and columns of the images.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    """

    def __init__(self, image_shape: tuple[int, int]) -> None:
        self.image_shape = image_shape

    def fit(self, X: Any, y: Any) -> "LbphClassifier":
        """Take the histograms of the gallery's images, each stretched to 8 bits."""
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        self.classes_, which = np.unique(y, return_inverse=True)
        self.recognizer_ = cv2.face.LBPHFaceRecognizer.create()
        self.recognizer_.train(self._codes(X), which.astype(np.int32))
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the chi-square distance of every image to the nearest of every subject."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        nearest = np.full((len(X), len(self.classes_)), np.inf)
        for row, image in zip(nearest, self._codes(X), strict=True):
            collector = cv2.face.StandardCollector.create()
            self.recognizer_.predict_collect(image, collector)
            labels, distances = np.array(collector.getResults()).T
            np.minimum.at(row, labels.astype(int), distances)
        return nearest

    def _codes(self, X: np.ndarray) -> list[np.ndarray]:
        low, span = X.min(axis=1, keepdims=True), np.ptp(X, axis=1, keepdims=True)
        scaled = np.divide(X - low, span, out=np.zeros_like(X), where=span > 0)
        return list(np.rint(255 * scaled).astype(np.uint8).reshape(-1, *self.image_shape))
