"""Recognition of probes that are framed a little differently, with scikit-learn's interface."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.recognition.framed_classifier import FramedSubspaceClassifier
from harmface.recognition.registration import CANDIDATES, Motion, registered_distances


class RegisteredSubspaceClassifier(FramedSubspaceClassifier):
    """Name the subject whose subspace lies nearest after registration, see `registration`.

    The other parameters and the attributes are those of `FramedSubspaceClassifier`.

    Parameters
    ----------
    candidates
        Subjects that a probe is registered to, each on its own.
    """

    def __init__(
        self,
        image_shape: tuple[int, int],
        mask: Bool[np.ndarray, "H W"] | None = None,
        dimension: int = 9,
        candidates: int = CANDIDATES,
    ) -> None:
        super().__init__(image_shape, mask, dimension)
        self.candidates = candidates

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every registered image to every subject of `classes_`."""
        return self.register(X)[0]

    def register(self, X: Any) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the distances, and how each image lies against its nearest subject."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        probes = X.reshape(-1, *self.mask_.shape)
        return registered_distances(probes, self.bases_, self.mask_, self.candidates)
