"""The recogniser: a gallery and a distance, with scikit-learn's interface."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float, Integer
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from harmface.errors import ArgumentError
from harmface.recognition.answers import posteriors
from harmface.recognition.distance import Distance, Model
from harmface.recognition.evaluation import (
    FEWEST_STRANGERS,
    Rejection,
    independence,
    rejection_by_margin,
    spread,
)
from harmface.recognition.gallery import Gallery, Photographs
from harmface.recognition.held_out import FOLDS, tries
from harmface.recognition.methods import BEST, best_method, distance_named

if TYPE_CHECKING:
    from harmface.recognition.registration import Motion

TRIALS = 1000
"""Most photographs that probabilities and thresholds are estimated from."""


@dataclass(frozen=True, eq=False)
class Trials:
    """How the gallery's own photographs compare with its subjects.

    Parameters
    ----------
    distances
        Of each photograph to every subject.
    truth
        Number of each photograph's subject.
    """

    distances: Float[np.ndarray, "t N"]
    truth: Integer[np.ndarray, "t"]


class SubjectClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Name the subject of a gallery that is nearest to a probe, by any distance.

    Parameters
    ----------
    method
        "best", another name of `methods.METHODS`, or a `Distance`.
    image_shape
        Rows and columns of the images that `fit` is given; one row if not given.
    mask
        Pixels that are compared, (rows, columns); by default all are.
    aligned
        Whether probes are framed exactly as the images of `fit`, as renderings are.

    Attributes
    ----------
    classes_
        Subjects in sorted order.
    gallery_
        What was enrolled.
    distance_
        The distance that the method names.
    model_
        What the distance learned of the gallery: arrays by name.
    known_, held_out_
        How the gallery's photographs compare with the model, and with models that were fitted
        without them; None if there are too few for that.

    Examples
    --------
    Two subjects, known from two images each, and a brighter image of the second:

    >>> images = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]])
    >>> classifier = SubjectClassifier("subspace").fit(images, ["a", "a", "b", "b"])
    >>> str(classifier.predict([[0.0, 0.1, 3.0, 5.0]])[0])
    'b'
    """

    classes_: np.ndarray
    gallery_: Gallery
    distance_: Distance
    model_: Model
    known_: Trials
    held_out_: Trials | None

    def __init__(
        self,
        method: str | Distance = BEST,
        image_shape: tuple[int, int] | None = None,
        mask: Bool[np.ndarray, "H W"] | None = None,
        aligned: bool = False,
    ) -> None:
        self.method = method
        self.image_shape = image_shape
        self.mask = mask
        self.aligned = aligned

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        method = "local" if self.method == BEST else self.method
        distance = distance_named(method) if isinstance(method, str) else method
        tags.input_tags.positive_only = distance.positive_only
        return tags

    @classmethod
    def from_gallery(cls, gallery: Gallery, method: str | Distance = BEST) -> "SubjectClassifier":
        """Return the fitted classifier of a gallery.

        Parameters
        ----------
        gallery
            Such as `enroll` makes of meshes.
        method
            A name or a `Distance`; the classifier has the name that "best" stands for.

        Returns
        -------
        SubjectClassifier
            Fitted.

        Raises
        ------
        ArgumentError
            If the gallery does not hold what the method needs.
        """
        method = best_method(gallery) if method == BEST else method
        made = cls(method, gallery.mask.shape, gallery.mask, gallery.aligned)
        made.n_features_in_ = gallery.mask.size
        return made._fitted(gallery)

    @classmethod
    def restored(
        cls,
        gallery: Gallery,
        method: str | Distance,
        model: Model,
        known: Trials,
        held_out: Trials | None,
    ) -> "SubjectClassifier":
        """Return a classifier as `from_gallery` made it, from its attributes.

        Parameters
        ----------
        gallery
            As `gallery_`.
        method
            A name or a `Distance`; not "best".
        model, known, held_out
            As `model_`, `known_` and `held_out_`.

        Returns
        -------
        SubjectClassifier
            Fitted.
        """
        made = cls(method, gallery.mask.shape, gallery.mask, gallery.aligned)
        made.n_features_in_ = gallery.mask.size
        made.gallery_, made.classes_ = gallery, gallery.names
        made.distance_ = made._distance_for(gallery)
        made.model_, made.known_, made.held_out_ = model, known, held_out
        return made

    def fit(self, X: Any, y: Any) -> "SubjectClassifier":
        """Enroll photographs.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (images, pixels): of one frame.
        y
            The subject of each image.

        Returns
        -------
        SubjectClassifier
            Itself.

        Raises
        ------
        ArgumentError
            If the images do not have the shape stated, or are not what the method needs.
        """
        X, y = validate_data(self, X, y, dtype=[np.float64, np.float32])
        check_classification_targets(y)
        shape = self.image_shape or (1, X.shape[1])
        if shape[0] * shape[1] != X.shape[1]:
            raise ArgumentError(
                f"image_shape must hold the {X.shape[1]} pixels of each image, got {shape}"
            )
        photographs = Photographs(y, X.reshape(-1, *shape))
        mask = photographs.everywhere if self.mask is None else self.mask
        return self._fitted(Gallery(photographs, mask, aligned=self.aligned))

    def _fitted(self, gallery: Gallery) -> "SubjectClassifier":
        self.gallery_, self.classes_ = gallery, gallery.names
        self.distance_ = self._distance_for(gallery)
        self.model_ = self.distance_.fit(gallery)
        some = spread(len(gallery.which), TRIALS)
        images = gallery.photographs.images[some]
        self.known_ = Trials(
            self.distance_.of_framed.distances(self.model_, images, gallery.mask),
            gallery.which[some],
        )
        self.held_out_ = self.known_ if self.distance_.of_surfaces else self._held_out(gallery)
        return self

    def _distance_for(self, gallery: Gallery) -> Distance:
        method = best_method(gallery) if self.method == BEST else self.method
        return distance_named(method) if isinstance(method, str) else method

    def _held_out(self, gallery: Gallery) -> Trials | None:
        """Compare photographs that were not enrolled, if there are any."""
        found, truths = [], []
        tried = tries(gallery, self.distance_.learns)
        for known, probes, truth in tried:
            some = spread(len(truth), TRIALS // len(tried))
            distance = self.distance_.of_framed
            found.append(distance.distances(distance.fit(known), probes[some], known.mask))
            truths.append(truth[some])
        if not tried:
            return None
        return Trials(np.concatenate(found), np.concatenate(truths))

    def distances(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image to every subject of `classes_`.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), at least 0, with a column for each of `classes_`.
        """
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        mask = self.gallery_.mask
        return self.distance_.distances(self.model_, X.reshape(-1, *mask.shape), mask)

    def distances_in_place(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the distance of every image as it lies, even if the method searches for its place.

        Strangers are told by these: under the best of many places a stranger comes near to
        somebody, too, which the photographs that `rejection` rests on were not let do.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), at least 0, with a column for each of `classes_`.
        """
        check_is_fitted(self)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        mask = self.gallery_.mask
        return self.distance_.of_framed.distances(self.model_, X.reshape(-1, *mask.shape), mask)

    def placed(self, X: Any) -> tuple[Float[np.ndarray, "n N"], "list[Motion] | None"]:
        """Return the `distances`, and how each image lies against the frame of the gallery.

        That is None of methods that do not search for it, see `framed`.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        distances : numpy.ndarray
            Shape (n, N), see `distances`.
        motions : list of Motion or None
            Shift in pixels, turn in degrees and scale of each image.
        """
        check_is_fitted(self)
        if self.distance_.of_framed is self.distance_:
            return self.distances(X), None
        from harmface.recognition.framed import FramedDistance

        assert isinstance(self.distance_, FramedDistance)
        X = validate_data(self, X, dtype=[np.float64, np.float32], reset=False)
        mask = self.gallery_.mask
        return self.distance_.search(self.model_, X.reshape(-1, *mask.shape), mask)

    def decision_function(self, X: Any) -> Float[np.ndarray, "n *N"]:
        """Return scores that are greater for nearer subjects.

        They are negated distances, (n, subjects); with two subjects scikit-learn asks for one
        score, (n,): how much nearer the second is, as the logarithm of the distances' ratio.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), or (n,) of two subjects.
        """
        distances = self.distances(X)
        if len(self.classes_) == 2:
            first, second = np.log(np.maximum(distances, np.finfo(distances.dtype).tiny)).T
            return first - second
        return -distances

    def predict(self, X: Any) -> np.ndarray:
        """Return the nearest subject of every image.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        numpy.ndarray
            Shape (n,): names of `classes_`.
        """
        nearest = self.distances(X).argmin(axis=1)
        return self.classes_[nearest]

    def predict_proba(self, X: Any) -> Float[np.ndarray, "n N"]:
        """Return the probability of every subject of `classes_`, given that it is one of them.

        See `probabilities`.

        Parameters
        ----------
        X
            Linear images as rows of all their pixels, (n, pixels), in the unit of those of `fit`.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), each row of sum 1.
        """
        return self.probabilities(self.distances(X))

    @property
    def calibrated(self) -> bool:
        """Whether there are probabilities: photographs enough to estimate them from."""
        return self.held_out_ is not None and len(self.classes_) > 1

    @property
    def farthest_held_out(self) -> float | None:
        """Greatest distance to the nearest subject, of other people's photographs held out.

        What is farther from everybody shows no face in the gallery's frame, or one under harder
        light than theirs. None of methods that do not learn from other people: a gallery's own
        photographs may all be in easy light.
        """
        if self.held_out_ is None or not self.distance_.learns:
            return None
        return float(self.held_out_.distances.min(axis=1).max())

    def probabilities(self, distances: Float[np.ndarray, "n N"]) -> Float[np.ndarray, "n N"]:
        """Return the `posteriors` of distances, with the `independence` that the gallery tells.

        Parameters
        ----------
        distances
            Of `distances` or `placed`, (n, N).

        Returns
        -------
        numpy.ndarray
            Shape (n, N), each row of sum 1.

        Raises
        ------
        ArgumentError
            If the gallery has too few photographs, or one subject only.
        """
        if self.held_out_ is None or len(self.classes_) < 2:
            raise ArgumentError(
                f"the gallery must hold two subjects and {FOLDS} photographs of each for "
                "probabilities; enroll more"
            )
        exponent = independence(self.held_out_.distances, self.held_out_.truth)
        return posteriors(distances, exponent)

    def rejection(self, rate: float = 0.01) -> Rejection:
        """Return how to tell strangers, see `rejection_by_margin`.

        The gallery's own photographs play the strangers, whom it does not matter that their own
        subject was enrolled with them. They are compared as they lie, and probes are to be, see
        `distances_in_place`. Of fewer than `FEWEST_STRANGERS` those that are held out do.

        Parameters
        ----------
        rate
            Wanted share of strangers that are taken for somebody.

        Returns
        -------
        Rejection
            The least margin of a probe that is believed.

        Raises
        ------
        ArgumentError
            If the gallery has fewer than three subjects, or too few photographs.
        """
        few = len(self.known_.truth) < FEWEST_STRANGERS
        trials = self.held_out_ if few and self.held_out_ is not None else self.known_
        return rejection_by_margin(trials.distances, trials.truth, rate)

    def explained(
        self, images: Float[np.ndarray, "n H W"], which: Integer[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "n H W"], Float[np.ndarray, "n K"] | None]:
        """Return what a subject looks like at its most alike to each probe, and in which light.

        See `Distance.explained`.

        Parameters
        ----------
        images
            Linear photographs, (n, rows, columns).
        which
            Column of the subject to compare each with, (n,).

        Returns
        -------
        pictures : numpy.ndarray
            Shape (n, rows, columns), in the images' unit.
        light : numpy.ndarray or None
            Shape (n, K): harmonic coefficients; None if subjects are known by photographs alone.
        """
        check_is_fitted(self)
        return self.distance_.explained(self.gallery_, images, which)
