"""What all recognisers by distance share: the nearest subject is named."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from sklearn.base import BaseEstimator, ClassifierMixin

from harmface.errors import ArgumentError


class DistanceClassifier(ClassifierMixin, BaseEstimator, ABC):  # type: ignore[misc]
    """Name the nearest subject, by the `distances` that a subclass computes.

    Attributes
    ----------
    classes_
        Subjects in sorted order, as scikit-learn wants them.
    """

    classes_: np.ndarray

    @abstractmethod
    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`."""

    def decision_function(self, X: Any) -> Float[np.ndarray, "n *N"]:
        """Return scores that are greater for nearer subjects.

        They are negated distances, (n, subjects); with two subjects scikit-learn asks for one
        score, (n,): how much nearer the second is.
        """
        distances = self.distances(X)
        if len(self.classes_) == 2:
            return distances[:, 0] - distances[:, 1]
        return -distances

    def predict(self, X: Any) -> np.ndarray:
        """Return the nearest subject of every image."""
        nearest = self.distances(X).argmin(axis=1)
        return self.classes_[nearest]


def checked_mask(
    image_shape: tuple[int, int], mask: Bool[np.ndarray, "H W"] | None, pixels: int
) -> Bool[np.ndarray, "H W"]:
    """Return the mask of images of that shape, everything if None is given.

    Parameters
    ----------
    image_shape
        Rows and columns.
    mask
        Pixels that take part, or None.
    pixels
        Number of pixels that images came with.

    Raises
    ------
    ArgumentError
        If the shape does not hold the pixels, or the mask has another or is empty.
    """
    rows, columns = image_shape
    if rows * columns != pixels:
        raise ArgumentError(
            f"image_shape must hold the {pixels} pixels of each image, got {image_shape}"
        )
    mask = np.ones(image_shape, bool) if mask is None else mask
    if mask.shape != (rows, columns):
        raise ArgumentError(f"mask must be of shape {image_shape}, got {mask.shape}")
    if not mask.any():
        raise ArgumentError("mask must leave some pixels, but leaves none; widen it")
    return mask
