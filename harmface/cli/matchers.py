"""What `harmface recognize` compares probes with: harmonic images, or photographs."""

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harmface.errors import ArgumentError

if TYPE_CHECKING:
    from harmface.io.galleries import Enrolled

SUBSPACES = {"3d": 1, "4d": 1, "9d": 2, "16d": 3, "25d": 4}
DEGREES = SUBSPACES | {"non-negative-4d": 1, "non-negative-9d": 2}
"""Methods that compare with harmonic images, and to which degree they want them."""

TRIALS = 1000
"""Most photographs that probabilities and thresholds are estimated from, and so the least
false-accept rate that can be: one in a thousand."""

FOLDS = 3
"""Parts of a gallery of photographs, each recognised by the others to see how sure a name is."""

Tried = tuple[np.ndarray, np.ndarray]
"""Distances of photographs to every subject, and which subject each shows."""


def _tried(matcher: "Matcher") -> Tried | None:
    trials = matcher.enrolled.some_trials(TRIALS)
    return None if trials is None else (matcher.distances(trials[0]), trials[1])


class HarmonicMatcher:
    """Compares images with the harmonic images of every subject."""

    tried = cached_property(_tried)

    def __init__(self, enrolled: "Enrolled", method: str) -> None:
        self.enrolled, self.method, self.mask = enrolled, method, enrolled.mask
        some = slice(int(method == "3d"), (DEGREES[method] + 1) ** 2)
        self.harmonics = enrolled.gallery.images[np.argsort(enrolled.gallery.subjects), some]

    def distances(self, images: np.ndarray) -> np.ndarray:
        """Return the distance of each image to every subject."""
        from harmface import recognition

        pixels = images[:, self.mask]
        if self.method == "non-negative-4d":
            return recognition.non_negative_distances_4d(pixels, self.basis.astype(np.float64))
        if self.method == "non-negative-9d":
            return recognition.non_negative_distances(pixels, self.basis)
        return recognition.subspace_distances(pixels, self.basis)

    @cached_property
    def basis(self) -> np.ndarray:
        """What spans each subject over the mask, orthonormal if light is free."""
        from harmface.recognition import orthonormal_basis

        seen = self.harmonics[..., self.mask]
        return orthonormal_basis(seen, seen.shape[1]) if self.method in SUBSPACES else seen

    @property
    def held_out(self) -> Tried | None:
        """The trials: they are no part of the harmonic images."""
        return self.tried

    def reconstructions(
        self, images: np.ndarray, which: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """Return what a subject looks like at its most alike to each image, and in which light."""
        from harmface.recognition import estimated_light
        from harmface.recognition.non_negative import non_negative_light, small_problems
        from harmface.recognition.non_negative_4d import nearest_in_round_cone

        pixels = images[:, self.mask].astype(np.float64)
        own = self.harmonics[which].astype(np.float64)
        seen = own[..., self.mask]
        if self.method == "non-negative-9d":
            light = np.einsum("iik->ik", non_negative_light(pixels, seen))
        elif self.method == "non-negative-4d":
            problems = small_problems(pixels, seen)
            light = np.einsum("iik->ik", nearest_in_round_cone(*problems[:2]))
        else:
            light = estimated_light(pixels, seen)
        pictures = np.einsum("nk,nkhw->nhw", light, own)
        # The 3-D subspace leaves the ambient term out.
        return pictures, np.pad(light, ((0, 0), (1, 0))) if self.method == "3d" else light


class PhotographMatcher:
    """Compares images with photographs, by a recogniser that is trained on them first."""

    tried = cached_property(_tried)

    def __init__(self, enrolled: "Enrolled", method: str) -> None:
        self.enrolled, self.method, self.mask = enrolled, method, enrolled.mask
        self.truth = np.searchsorted(enrolled.names, enrolled.gallery.subjects)
        self.recognizer = self._trained(self._rows(enrolled.gallery.images), self.truth)

    def distances(self, images: np.ndarray) -> np.ndarray:
        """Return the distance of each image to every subject."""
        from harmface.recognition.evaluation import distances_by

        return distances_by(self.recognizer, self._rows(images))

    @property
    def held_out(self) -> Tried | None:
        """Distances of the gallery's photographs to subjects known without them."""
        from harmface.recognition.evaluation import held_out_distances

        # With fewer photographs of somebody, one alone may be left of them, or none.
        if np.bincount(self.truth).min() < FOLDS:
            return None
        rows = self._rows(self.enrolled.gallery.images)
        return held_out_distances(self._trained, rows, self.truth, FOLDS, TRIALS // FOLDS)

    def reconstructions(self, images: np.ndarray, which: np.ndarray) -> tuple[np.ndarray, None]:
        """Return the projection of each image onto the span of a subject's photographs."""
        from harmface.recognition import orthonormal_basis

        pictures = np.zeros(images.shape)
        for row, (image, subject) in enumerate(zip(images, which, strict=True)):
            own = self.enrolled.gallery.images[self.truth == subject][:, self.mask]
            basis = orthonormal_basis(own.astype(np.float64), len(own))
            pictures[row, self.mask] = (basis @ image[self.mask]) @ basis
        return pictures, None

    def _trained(self, rows: np.ndarray, truth: np.ndarray) -> Any:
        from harmface.recognition.baselines import recognizer

        made = recognizer(self.method, self.mask.shape, int(np.bincount(truth).min()))
        wanted = {"mask": self.mask, "aligned": self.enrolled.aligned}
        taken = made[-1].get_params().keys() & wanted
        made[-1].set_params(**{name: wanted[name] for name in taken})
        return made.fit(rows, truth)

    def _rows(self, images: np.ndarray) -> np.ndarray:
        return (images * self.mask).reshape(len(images), -1).astype(np.float32)


Matcher = HarmonicMatcher | PhotographMatcher


def matcher_of(enrolled: "Enrolled", method: str, path: Path) -> Matcher:
    """Return what compares by a method, or refuse one that the gallery cannot serve."""
    from harmface.io.galleries import PHOTOGRAPHS
    from harmface.recognition.baselines import METHODS

    if enrolled.content == PHOTOGRAPHS:
        if method in DEGREES:
            raise ArgumentError(
                f"{path}: holds photographs, and {method} needs harmonic images; enroll meshes "
                f"with --method {method}, or use one of {', '.join(METHODS)}"
            )
        return PhotographMatcher(enrolled, method)
    if method not in DEGREES:
        raise ArgumentError(
            f"{path}: holds harmonic images, so --method must be one of {', '.join(DEGREES)}, got "
            f"{method!r}; methods of photographs need a gallery enrolled with --method {method}"
        )
    held, needed = enrolled.gallery.images.shape[1], (DEGREES[method] + 1) ** 2
    if needed > held:
        raise ArgumentError(
            f"{path}: holds {held} harmonic images of a subject, {method} needs {needed}; enroll "
            f"with --method {method}"
        )
    return HarmonicMatcher(enrolled, method)
