"""Comparison with the nearest image of the gallery, after any transformation of the images."""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.distance import cdist

from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import PHOTOGRAPHS, RELIT, Gallery


@dataclass(frozen=True)
class NearestImageDistance(Distance):
    """The Euclidean distance to the nearest of a subject's images, in features of the images."""

    sources = (PHOTOGRAPHS, RELIT)

    def fit(self, gallery: Gallery) -> Model:
        """Return the features of every image of the gallery, and what they come from."""
        each = gallery.spanning(self.source)
        images = np.concatenate(each) * gallery.mask
        which = np.repeat(np.arange(len(each)), [len(own) for own in each])
        learned = self.learn(images, which)
        return {**learned, "which": which, "features": self.features(learned, images)}

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to the nearest image of every subject."""
        each = self.between(self.features(model, probes * mask), model["features"])
        nearest = np.full((len(probes), model["which"].max() + 1), np.inf)
        np.minimum.at(nearest.T, model["which"], each.T)
        return nearest

    def learn(self, images: Float[np.ndarray, "n H W"], which: np.ndarray) -> Model:
        """Return what the features need to know of the gallery."""
        return {}

    @abstractmethod
    def features(
        self, model: Model, images: Float[np.ndarray, "n H W"]
    ) -> Float[np.ndarray, "n d"]:
        """Return the features of images."""

    def between(
        self, probes: Float[np.ndarray, "n d"], gallery: Float[np.ndarray, "g d"]
    ) -> Float[np.ndarray, "n g"]:
        """Return the distances between features."""
        return cdist(probes, gallery)
