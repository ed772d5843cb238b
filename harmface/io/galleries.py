"""Gallery files: who is enrolled, as harmonic images or as photographs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.files import PARSE_ERRORS, excerpt
from harmface.io.npz import read_npz, write_npz
from harmface.recognition.evaluation import spread
from harmface.recognition.gallery import Gallery

KIND, VERSION = "gallery", 2
HARMONIC_IMAGES, PHOTOGRAPHS = "harmonic images", "photographs"


@dataclass(frozen=True, eq=False)
class LabelledPhotographs:
    """Photographs of subjects in one common frame.

    Parameters
    ----------
    subjects
        Whom each photograph shows.
    images
        Linear luminance, nowhere negative, each with some contrast.
    """

    subjects: tuple[str, ...]
    images: Float[np.ndarray, "n H W"]

    def __post_init__(self) -> None:
        checks.non_negative("images", self.images)
        if self.images.ndim != 3 or len(self.subjects) != len(self.images) or not self.subjects:
            raise ArgumentError(
                f"subjects must name each photograph of images, got {len(self.subjects)} names "
                f"and images of shape {self.images.shape}"
            )
        flat = np.ptp(self.images, axis=(1, 2)) == 0
        if flat.any():
            raise ArgumentError(
                f"images must show something, but number {flat.argmax()} has one value everywhere"
            )


@dataclass(frozen=True, eq=False)
class Enrolled:
    """All that a gallery file holds.

    Parameters
    ----------
    gallery
        Harmonic images, or photographs, that subjects are recognised by.
    method
        The method that the gallery was made for.
    trials
        Photographs of enrolled subjects that a threshold and probabilities are estimated from;
        without them neither can be.
    mask
        Pixels that are compared.
    aligned
        Whether probes are framed exactly as the gallery, as renderings are; photographs are not.
    facts
        How the gallery was made, for people and programs to read: anything JSON can hold.
    """

    gallery: Gallery | LabelledPhotographs
    method: str
    trials: LabelledPhotographs | None
    mask: Bool[np.ndarray, "H W"]
    aligned: bool
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        frames = [self.gallery.images, *([self.trials.images] if self.trials else [])]
        if any(images.shape[-2:] != self.mask.shape for images in frames):
            raise ArgumentError(
                f"gallery, trials and mask must be of one size, got "
                f"{[images.shape[-2:] for images in frames]} and {self.mask.shape}"
            )
        if not self.mask.any():
            raise ArgumentError("mask must leave some pixels to compare, got none")
        if self.trials and not set(self.trials.subjects) <= set(self.gallery.subjects):
            raise ArgumentError("trials must be of subjects of the gallery")

    @property
    def content(self) -> str:
        """What subjects are recognised by: "harmonic images" or "photographs"."""
        return HARMONIC_IMAGES if isinstance(self.gallery, Gallery) else PHOTOGRAPHS

    @property
    def names(self) -> tuple[str, ...]:
        """The subjects, in the order that distances to them have."""
        return tuple(sorted(set(self.gallery.subjects)))

    @property
    def summary(self) -> str:
        """How many subjects and photographs there are, and of whom fewest if they differ."""
        names, counts = np.unique(self.gallery.subjects, return_counts=True)
        text = f"{len(names)} {'subject' if len(names) == 1 else 'subjects'}"
        if self.content == PHOTOGRAPHS:
            text += f", {counts.sum()} {'photograph' if counts.sum() == 1 else 'photographs'}"
        if counts.min() < counts.max():
            text += f" (fewest {counts.min()}, of {names[counts.argmin()]})"
        return f"{text} at {self.mask.shape[0]} x {self.mask.shape[1]} pixels"

    def some_trials(
        self, most: int
    ) -> tuple[Float[np.ndarray, "t H W"], Integer[np.ndarray, "t"]] | None:
        """Return at most so many trials, spread over all, and which of `names` each shows."""
        if self.trials is None:
            return None
        some = spread(len(self.trials.images), most)
        which = np.searchsorted(self.names, self.trials.subjects)
        return self.trials.images[some], which[some]


def enrolled_photographs(
    photographs: LabelledPhotographs,
    method: str,
    *,
    mask: Bool[np.ndarray, "H W"] | None = None,
    aligned: bool = False,
    facts: Mapping[str, Any] | None = None,
) -> Enrolled:
    """Return a gallery of photographs, which are their own trials.

    Parameters
    ----------
    photographs
        Those of every subject.
    method
        The method that the gallery is for.
    mask
        Pixels that are compared; by default all are.
    aligned, facts
        See `Enrolled`.
    """
    mask = np.ones(photographs.images.shape[1:], bool) if mask is None else mask
    return Enrolled(photographs, method, photographs, mask, aligned, facts or {})


def write_gallery(path: Path | str, enrolled: Enrolled) -> None:
    """Write a gallery to a versioned NPZ file."""
    arrays = {"images": enrolled.gallery.images, "mask": enrolled.mask}
    attributes = {
        "content": enrolled.content,
        "method": enrolled.method,
        "subjects": list(enrolled.gallery.subjects),
        "aligned": enrolled.aligned,
        "facts": dict(enrolled.facts),
    }
    if enrolled.trials is not None and enrolled.trials is not enrolled.gallery:
        arrays["trials"] = enrolled.trials.images
        attributes["trials"] = list(enrolled.trials.subjects)
    write_npz(path, KIND, VERSION, arrays, attributes)


def read_gallery(path: Path | str) -> Enrolled:
    """Read a gallery that `write_gallery` made.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, or changed since it was written.
    """
    arrays, attributes = read_npz(path, KIND, VERSION)
    try:
        return _enrolled(arrays, attributes)
    except KeyError as error:
        raise FileError(f"{path}: is a gallery without {error}; enroll again") from None
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no gallery of use ({excerpt(error)}); enroll again") from None


def _enrolled(arrays: dict[str, np.ndarray], attributes: dict[str, Any]) -> Enrolled:
    method, facts = attributes["method"], attributes["facts"]
    if not isinstance(method, str) or not isinstance(facts, dict):
        raise TypeError("method must be a name and facts a table")
    images, mask = arrays["images"], arrays["mask"]
    if mask.dtype != bool or mask.ndim != 2 or images.dtype.kind != "f":
        raise TypeError("images must be real numbers and mask a picture of true and false")
    subjects = tuple(map(str, attributes["subjects"]))
    aligned = attributes["aligned"] is True
    if attributes["content"] == PHOTOGRAPHS:
        photographs = LabelledPhotographs(subjects, images)
        return enrolled_photographs(photographs, method, mask=mask, aligned=aligned, facts=facts)
    if attributes["content"] != HARMONIC_IMAGES or images.ndim != 4:
        raise ValueError(f"its content is {attributes['content']!r}")
    trials = None
    if "trials" in arrays:
        trials = LabelledPhotographs(tuple(map(str, attributes["trials"])), arrays["trials"])
    return Enrolled(Gallery(subjects, images), method, trials, mask, aligned, facts)
