"""Every recogniser of photographs by name, and what may be put before it.

References
----------
.. [BHK97] Belhumeur, Hespanha and Kriegman, Eigenfaces vs. Fisherfaces, PAMI 1997.
.. [CBJ00] Chen, Belhumeur and Jacobs, In Search of Illumination Invariants, CVPR 2000.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Float
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import FunctionTransformer

from harmface.errors import ArgumentError
from harmface.recognition.classifier import HarmonicSubspaceClassifier
from harmface.recognition.cone_classifier import IlluminationConeClassifier
from harmface.recognition.local_classifier import LocalSubspaceClassifier
from harmface.recognition.nearest import NearestImageClassifier
from harmface.recognition.normalizers import equalized, self_quotient, tan_triggs
from harmface.recognition.robust_classifier import RobustSubspaceClassifier

EIGENFACES = 50
"""Principal components, fewer where the gallery has fewer images."""

NORMALIZERS = {"equalized": equalized, "self-quotient": self_quotient, "tan-triggs": tan_triggs}
"""What may stand before a method's name, with a plus: `tan-triggs+eigenfaces`."""

METHODS = (
    *("local", "robust", "registered", "subspace", "cone", "correlation", "nearest"),
    *("eigenfaces", "eigenfaces-3", "fisherfaces", "gradient-direction", "lbph"),
)
"""Recognisers from photographs; the first is the one to use."""


class Eigenfaces(TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Project on the principal components of the gallery, leaving out the strongest.

    Parameters
    ----------
    left_out
        How many: three hold most of the light [BHK97]_.
    """

    def __init__(self, left_out: int = 0) -> None:
        self.left_out = left_out

    def fit(self, X: np.ndarray, y: Any = None) -> "Eigenfaces":
        """Find the components."""
        self.pca_ = PCA(min(EIGENFACES, *X.shape), random_state=0).fit(X)
        return self

    def transform(self, X: np.ndarray) -> Float[np.ndarray, "n d"]:
        """Return the coordinates of images."""
        return self.pca_.transform(X)[:, self.left_out :]


class Fisherfaces(TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Project on the directions that tell subjects apart best against their scatter [BHK97]_."""

    def fit(self, X: np.ndarray, y: Any) -> "Fisherfaces":
        """Find the directions, in the principal subspace where the scatter is regular."""
        subjects = len(np.unique(y))
        if len(X) <= subjects:
            raise ArgumentError(
                "images must number more than the subjects for fisherfaces, got "
                f"{len(X)} of {subjects}; give several of a subject"
            )
        dimension = min(len(X) - subjects, X.shape[1])
        self.model_ = make_pipeline(
            PCA(dimension, random_state=0), LinearDiscriminantAnalysis(solver="svd")
        ).fit(X, y)
        return self

    def transform(self, X: np.ndarray) -> Float[np.ndarray, "n d"]:
        """Return the coordinates of images."""
        return self.model_.transform(X)


def recognizer(name: str, image_shape: tuple[int, int], images_each: int) -> Any:
    """Return the recogniser of a name, to be fitted to photographs as rows of pixels.

    The result follows scikit-learn: `fit(X, y)`, `predict(X)`, and on its last step
    `distances(X)`.

    Parameters
    ----------
    name
        One of `METHODS`, with the name of a normaliser and a plus before it if wanted.
    image_shape
        Rows and columns of the photographs.
    images_each
        Least number of photographs of a subject in the gallery.

    Raises
    ------
    ArgumentError
        If there is no such method or normaliser.
    """
    *before, method = name.split("+")
    unknown = [each for each in before if each not in NORMALIZERS]
    if method not in METHODS or unknown or len(before) > 1:
        raise ArgumentError(
            f"method must be one of {', '.join(METHODS)}, or one of {', '.join(NORMALIZERS)} "
            f"and a plus before it, got {name!r}"
        )
    # OpenCV takes a while to load: what needs it is imported where it is asked for.
    if method == "local":
        final: Any = LocalSubspaceClassifier(image_shape)
    elif method == "subspace":
        final = HarmonicSubspaceClassifier(min(9, images_each))
    elif method == "robust":
        final = RobustSubspaceClassifier(image_shape, dimension=min(9, images_each))
    elif method == "registered":
        from harmface.recognition.registered_classifier import RegisteredSubspaceClassifier

        final = RegisteredSubspaceClassifier(image_shape, dimension=min(9, images_each))
    elif method == "cone":
        final = IlluminationConeClassifier()
    elif method == "lbph":
        from harmface.recognition.lbph import LbphClassifier

        final = LbphClassifier(image_shape)
    else:
        features = {
            "correlation": FunctionTransformer(standardized),
            "nearest": None,
            "eigenfaces": Eigenfaces(),
            "eigenfaces-3": Eigenfaces(left_out=3),
            "fisherfaces": Fisherfaces(),
            "gradient-direction": FunctionTransformer(OnRows(gradient_direction, image_shape)),
        }
        final = NearestImageClassifier(features[method])
    steps = [(each, FunctionTransformer(OnRows(NORMALIZERS[each], image_shape))) for each in before]
    return Pipeline([*steps, (method, final)])


def standardized(X: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "n p"]:
    """Return images of mean 0 and norm 1: distances between them rank as correlations do."""
    centred = X - X.mean(axis=1, keepdims=True)
    norm = np.linalg.norm(centred, axis=1, keepdims=True)
    return np.divide(centred, norm, out=np.zeros_like(centred), where=norm > 0)


def gradient_direction(images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "n c H W"]:
    """Return cosine and sine of the direction of the gradient, which light changes little [CBJ00]_.

    Both are 0 where there is no gradient. The squared distance of two pixels' features is
    `2 - 2 cos` of the angle between the gradients.
    """
    gradient = np.stack(np.gradient(images, axis=(1, 2)), axis=1)
    length = np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.divide(gradient, length, out=np.zeros_like(gradient), where=length > 0)


class OnRows:
    """A function of images made one of rows of pixels, which can be cloned."""

    def __init__(self, function: Callable[..., np.ndarray], image_shape: tuple[int, int]) -> None:
        self.function = function
        self.image_shape = image_shape

    def __call__(self, X: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "n q"]:
        """Return the result, flattened again."""
        return self.function(X.reshape(-1, *self.image_shape)).reshape(len(X), -1)
