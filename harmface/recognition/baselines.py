"""The classical methods, for comparison: the nearest image of the gallery in some features.

References
----------
.. [BHK97] Belhumeur, Hespanha and Kriegman, Eigenfaces vs. Fisherfaces, PAMI 1997.
.. [CBJ00] Chen, Belhumeur and Jacobs, In Search of Illumination Invariants, CVPR 2000.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.nearest import NearestImageDistance

EIGENFACES = 50
"""Principal components, fewer where the gallery has fewer images."""


class PixelDistance(NearestImageDistance):
    """The distance of the pixels themselves."""

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the images as rows."""
        return images.reshape(len(images), -1)


class CorrelationDistance(NearestImageDistance):
    """The distance of images of mean 0 and norm 1, which ranks as correlation does."""

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the images standardised."""
        return standardized(images.reshape(len(images), -1))


class GradientDirectionDistance(NearestImageDistance):
    """The distance of gradients of length 1, which light changes little [CBJ00]_."""

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return cosine and sine of the gradients' directions."""
        return gradient_direction(images).reshape(len(images), -1)


@dataclass(frozen=True)
class EigenfacesDistance(NearestImageDistance):
    """The distance in the principal components of the gallery.

    Parameters
    ----------
    left_out
        How many of the strongest are left out: three hold most of the light [BHK97]_.
    """

    left_out: int = 0

    def learn(self, images: Float[np.ndarray, "n H W"], which: np.ndarray) -> Model:
        """Find the components."""
        rows = images.reshape(len(images), -1)
        pca = PCA(min(EIGENFACES, *rows.shape), random_state=0).fit(rows)
        return {"mean": pca.mean_, "directions": pca.components_[self.left_out :].T}

    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the coordinates of images."""
        return (images.reshape(len(images), -1) - model["mean"]) @ model["directions"]


class FisherfacesDistance(EigenfacesDistance):
    """The distance along the directions that tell subjects apart best against their scatter."""

    def learn(self, images: Float[np.ndarray, "n H W"], which: np.ndarray) -> Model:
        """Find the directions, in the principal subspace where the scatter is regular [BHK97]_."""
        rows, subjects = images.reshape(len(images), -1), which.max() + 1
        if len(rows) <= subjects:
            raise ArgumentError(
                "images must number more than the subjects for fisherfaces, got "
                f"{len(rows)} of {subjects}; give several of a subject"
            )
        pca = PCA(min(len(rows) - subjects, rows.shape[1]), random_state=0).fit(rows)
        lda = LinearDiscriminantAnalysis(solver="svd").fit(pca.transform(rows), which)
        # Where both put their origin is the same for all images, and plays no part in distances.
        directions = pca.components_.T @ lda.scalings_[:, : lda._max_components]
        return {"mean": pca.mean_, "directions": directions}


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
