"""Recognition by the robust distance to a subspace, with scikit-learn's interface."""

from typing import Any

import numpy as np
from jaxtyping import Float
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.framed_classifier import FramedSubspaceClassifier
from harmface.recognition.gallery import Gallery
from harmface.recognition.robust import pixel_blocks, robust_distances


class RobustSubspaceClassifier(FramedSubspaceClassifier):
    """Name the subject whose subspace lies nearest to most of a probe, see `robust`.

    The method of choice where probes are framed exactly as the gallery, as renderings of meshes
    are; for photographs cropped by hand see `LocalSubspaceClassifier`.

    Parameters and attributes are those of `FramedSubspaceClassifier`.
    """

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
        classifier = cls(mask.shape, mask, dimension)
        classifier.fit(images, names)
        return classifier

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`, in [0, 1]."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        return robust_distances(X[:, self.mask_.ravel()], self.bases_, pixel_blocks(self.mask_))
