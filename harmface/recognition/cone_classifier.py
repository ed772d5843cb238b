"""Recognition by the distance to illumination cones, with scikit-learn's interface.

References
----------
.. [GBK01] Georghiades, Belhumeur and Kriegman, From Few to Many: Illumination Cone Models for
   Face Recognition under Variable Lighting and Pose, PAMI 2001.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.errors import ArgumentError
from harmface.recognition.distance_classifier import DistanceClassifier
from harmface.recognition.gallery import Gallery
from harmface.recognition.illumination_cone import (
    cone_distances,
    extreme_lights,
    lamp_images,
    low_dimensional_cone,
    scaled_normals,
)


class IlluminationConeClassifier(DistanceClassifier):
    """Name the subject whose illumination cone lies nearest to a probe, see `illumination_cone`.

    Attached shadows are in the cones, cast shadows are not. Exposure plays no part.

    Parameters
    ----------
    rays
        Greatest number of extreme rays of a cone; [GBK01]_ rendered as many lamps.
    dimension
        Of the subspace that holds a cone.
    rng
        Seed for the choice of the rays, the same for every subject.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    cones_
        Each subject's `low_dimensional_cone`.
    """

    def __init__(self, rays: int = 120, dimension: int = 11, rng: int = 0) -> None:
        self.rays = rays
        self.dimension = dimension
        self.rng = rng

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.positive_only = True
        return tags

    @classmethod
    def from_gallery(cls, gallery: Gallery) -> "IlluminationConeClassifier":
        """Return a fitted classifier of a gallery; probes are then pixels of `gallery.mask`.

        Parameters
        ----------
        gallery
            Harmonic images of every subject without cast shadows: those of degree 1 are the
            scaled normals.
        """
        classifier = cls()
        normals = gallery.spanning("3d").astype(np.float64)
        order = np.argsort(gallery.subjects)
        classifier.classes_ = np.array(gallery.subjects)[order]
        classifier.cones_ = [classifier._cone(normals[each]) for each in order]
        classifier.n_features_in_ = normals.shape[-1]
        return classifier

    def fit(self, X: Any, y: Any) -> "IlluminationConeClassifier":
        """Make each subject's cone from photographs.

        Parameters
        ----------
        X
            Linear photographs under single lamps as rows of pixels, (images, pixels).
        y
            The subject of each image; at least three of each, under lights not in a plane.

        Raises
        ------
        ArgumentError
            If images are negative or black, or a subject has too few.
        """
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        self.classes_ = np.unique(y)
        self.cones_ = []
        for name in self.classes_:
            try:
                self.cones_.append(self._cone(scaled_normals(X[y == name])))
            except ArgumentError as error:
                raise ArgumentError(f"subject {str(name)!r}: {error}") from None
        return self

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`, in [0, 1]."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        return np.stack([cone_distances(X, *cone) for cone in self.cones_], axis=1)

    def _cone(
        self, normals: Float[np.ndarray, "3 p"]
    ) -> tuple[Float[np.ndarray, "d p"], Float[np.ndarray, "J d"]]:
        lights = extreme_lights(normals, self.rays, self.rng)
        return low_dimensional_cone(lamp_images(normals, lights), self.dimension)
