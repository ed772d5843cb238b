"""Recognition by the distance of every window to its own subspace, scikit-learn's interface."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.distance_classifier import DistanceClassifier, checked_mask
from harmface.recognition.local_subspace import (
    Windows,
    local_basis,
    local_distances,
    log_intensity,
)
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

WHOLE_POWER = 0.06
"""Power of the whole image's distance: enough to decide ties, too little to outvote windows that
a shadow leaves alone."""

WHOLE_DIMENSION = 9
"""Dimension of the whole image's subspace, that of the light."""


class LocalSubspaceClassifier(DistanceClassifier):
    """Name the subject whose windows explain a probe best, see `local_subspace`.

    The method of choice for photographs under extreme light: nine photographs a subject under
    the nine points of light, or a handful of frontal ones. Probes must be in the unit of the
    gallery, whose greatest value counts as the camera's full scale.

    The distance is `local_distances`, times a low power of `subspace_distances` of the whole
    image: where that fits well it decides between subjects whose windows look alike.

    Parameters
    ----------
    image_shape
        Rows and columns of the images.
    mask
        Pixels that take part, (rows, columns); by default all do.
    aligned
        Whether probes are framed exactly as the gallery, as renderings are; photographs are not.
    noise
        Standard deviation of the camera's noise in the dark, as a fraction of full scale.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    bases_
        See `local_basis`, (subjects, windows, dimension, pixels of a window).
    whole_
        Orthonormal rows of each subject's whole images, (subjects, dimension, pixels).
    full_scale_
        Greatest value of the gallery.
    """

    def __init__(
        self,
        image_shape: tuple[int, int],
        mask: Bool[np.ndarray, "H W"] | None = None,
        aligned: bool = False,
        noise: float = 0.005,
    ) -> None:
        self.image_shape = image_shape
        self.mask = mask
        self.aligned = aligned
        self.noise = noise

    def fit(self, X: Any, y: Any) -> "LocalSubspaceClassifier":
        """Span the subspaces of every subject's windows.

        Parameters
        ----------
        X
            Linear photographs as rows of all their pixels, (images, pixels).
        y
            The subject of each image; one image of a subject is enough.

        Raises
        ------
        ArgumentError
            If the images are negative or all black, or do not have the shape stated.
        """
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        self.windows_ = Windows(checked_mask(self.image_shape, self.mask, X.shape[1]))
        self.full_scale_ = float(checks.non_negative("X", X).max())
        if self.full_scale_ == 0:
            raise ArgumentError("images must not all be black")
        images = self._logarithms(X)
        self.classes_, which = np.unique(y, return_inverse=True)
        each = [which == c for c in range(len(self.classes_))]
        self.bases_ = np.stack(
            [local_basis(images[own], self.windows_, self.aligned) for own in each]
        )
        self.whole_ = np.stack([_whole_basis(self._seen(X[own])) for own in each])
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`, in [0, 1]."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        seen = self._seen(X)
        flat = np.flatnonzero(seen.max(axis=1) == seen.min(axis=1))
        if flat.size:
            raise ArgumentError(
                f"probes must show something, but {flat.size} of {len(X)} have the same value "
                f"everywhere (first: number {flat[0]})"
            )
        local = local_distances(self._logarithms(X), self.bases_, self.windows_)
        whole = subspace_distances(seen.astype(np.float32), self.whole_)
        return local * whole**WHOLE_POWER

    def _logarithms(self, X: np.ndarray) -> Float[np.ndarray, "n H W"]:
        images = X.reshape(-1, *self.windows_.mask.shape)
        return log_intensity(images / self.full_scale_, self.noise)

    def _seen(self, X: np.ndarray) -> Float[np.ndarray, "n p"]:
        return X[:, self.windows_.mask.ravel()]


def _whole_basis(images: Float[np.ndarray, "g p"]) -> Float[np.ndarray, "d p"]:
    """Return orthonormal rows of a subject's images, zeros where it has fewer than others."""
    basis = orthonormal_basis(images, min(len(images), WHOLE_DIMENSION)).astype(np.float32)
    return np.pad(basis, ((0, WHOLE_DIMENSION - len(basis)), (0, 0)))
