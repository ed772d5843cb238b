"""Who was enrolled: photographs of every subject, and what is known of their surfaces."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError

PHOTOGRAPHS, RELIT, HARMONIC, SHADOWED = "photographs", "relit", "harmonic", "shadowed"
SOURCES = (PHOTOGRAPHS, RELIT, HARMONIC, SHADOWED)
"""What a subject can be known by: its photographs; these and others rendered from the surface that
they tell; harmonic images with attached shadows; harmonic images with cast shadows as well."""


@dataclass(frozen=True, eq=False)
class Photographs:
    """Photographs of subjects in one common frame.

    Parameters
    ----------
    subjects
        Whom each photograph shows.
    images
        Linear luminance.
    """

    subjects: np.ndarray
    images: Float[np.ndarray, "n H W"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "subjects", np.asarray(self.subjects))
        object.__setattr__(self, "images", checks.finite("images", self.images))
        count = len(self.subjects)
        if self.images.ndim != 3 or count != len(self.images):
            raise ArgumentError(
                f"subjects must name each photograph of images, got {count} names and images of "
                f"shape {self.images.shape}"
            )

    @property
    def everywhere(self) -> Bool[np.ndarray, "H W"]:
        """A mask of all pixels."""
        return np.ones(self.images.shape[1:], bool)

    def chosen(self, which: np.ndarray) -> "Photographs":
        """Return some of the photographs, by a mask or by their numbers.

        Parameters
        ----------
        which
            Boolean, one for each photograph, or integer indices.

        Returns
        -------
        Photographs
            In the order of the numbers.
        """
        return Photographs(self.subjects[which], self.images[which])


@dataclass(frozen=True, eq=False)
class Gallery:
    """Enrolled subjects, all in one frame.

    Parameters
    ----------
    photographs
        Of every subject; of a mesh, what it looks like under the nine points of light.
    mask
        Pixels that are compared.
    lights
        Unit direction to the light of each photograph, if known.
    relit
        Photographs rendered from surfaces that the photographs tell, under lights that they lack.
    others
        Photographs of other people under several lights each, to learn from how light changes
        faces.
    harmonic, shadowed
        Harmonic images of each subject in the order of `names`, without and with cast shadows; of
        meshes only.
    aligned
        Whether probes are framed exactly as the gallery, as renderings are; photographs are not.
    facts
        How the gallery was made, for people and programs to read: anything JSON can hold.
    """

    photographs: Photographs
    mask: Bool[np.ndarray, "H W"]
    lights: Float[np.ndarray, "n 3"] | None = None
    relit: Photographs | None = None
    others: Photographs | None = None
    harmonic: Float[np.ndarray, "N K H W"] | None = None
    shadowed: Float[np.ndarray, "N S H W"] | None = None
    aligned: bool = False
    facts: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        shape = self.photographs.images.shape[1:]
        if not len(self.photographs.subjects):
            raise ArgumentError("photographs must hold at least one, got none")
        if self.mask.shape != shape:
            raise ArgumentError(f"mask must be of shape {shape}, got {self.mask.shape}")
        if not self.mask.any():
            raise ArgumentError("mask must leave some pixels to compare, but leaves none; widen it")
        if self.lights is not None and len(self.lights) != len(self.photographs.subjects):
            raise ArgumentError(
                f"lights must number {len(self.photographs.subjects)}, one for each photograph, "
                f"got {len(self.lights)}"
            )
        for name in (RELIT, "others"):
            own = getattr(self, name)
            if own is not None and own.images.shape[1:] != shape:
                raise ArgumentError(f"{name} must be of shape {shape}, got {own.images.shape[1:]}")
        if self.relit is not None and not np.isin(self.relit.subjects, self.names).all():
            raise ArgumentError("relit must be of subjects of the photographs")
        for name in (HARMONIC, SHADOWED):
            images = getattr(self, name)
            if images is None:
                continue
            checks.finite(name, images)
            if (
                images.ndim != 4
                or images.shape[::2][:1] != self.names.shape
                or (images.shape[2:] != shape)
            ):
                raise ArgumentError(
                    f"{name} must hold images of shape {shape} of {len(self.names)} subjects, got "
                    f"shape {images.shape}"
                )
            max_degree_of(images.shape[1])

    @cached_property
    def names(self) -> np.ndarray:
        """The subjects in sorted order, which distances to them have."""
        return np.unique(self.photographs.subjects)

    @property
    def which(self) -> Integer[np.ndarray, "n"]:
        """Number of the subject that each photograph shows."""
        return np.searchsorted(self.names, self.photographs.subjects)

    def spanning(
        self, source: str, harmonics: slice = slice(0, 9)
    ) -> list[Float[np.ndarray, "_ H W"]]:
        """Return the images that each subject is known by.

        Parameters
        ----------
        source
            One of `SOURCES`.
        harmonics
            Which of the harmonic images, by their flat index.

        Returns
        -------
        list of numpy.ndarray
            For each of `names`, (images, rows, columns).

        Raises
        ------
        ArgumentError
            If the gallery does not hold them.
        """
        if source in (HARMONIC, SHADOWED):
            images = getattr(self, source)
            if images is None:
                raise ArgumentError(
                    "the gallery must hold harmonic images for that, which photographs do not "
                    "give; enroll meshes, or use a method of photographs"
                )
            if harmonics.stop > images.shape[1]:
                raise ArgumentError(
                    f"the gallery must hold {harmonics.stop} harmonic images of a subject, but "
                    f"holds {images.shape[1]} ({source}); put shadowed+ before the method"
                )
            return list(images[:, harmonics])
        given = self.photographs
        subjects, images = given.subjects, given.images
        if source == RELIT:
            if self.relit is None:
                raise ArgumentError(
                    "the gallery must hold relit photographs, which need photographs of known "
                    "light, such as names that tell the light as Extended Yale B has; use a method "
                    "without relit+"
                )
            subjects = np.concatenate([subjects, self.relit.subjects])
            images = np.concatenate([images, self.relit.images])
        return [images[subjects == name] for name in self.names]

    def chosen(self, which: np.ndarray) -> "Gallery":
        """Return the gallery with some of its photographs, by a mask or by their numbers.

        Parameters
        ----------
        which
            Boolean, one for each photograph, or integer indices.

        Returns
        -------
        Gallery
            All else as it is; subjects without a photograph left are gone.
        """
        lights = None if self.lights is None else self.lights[which]
        return replace(self, photographs=self.photographs.chosen(which), lights=lights)

    @property
    def summary(self) -> str:
        """How many subjects and photographs there are, and of whom fewest if they differ."""
        names, counts = np.unique(self.photographs.subjects, return_counts=True)
        text = f"{len(names)} {'subject' if len(names) == 1 else 'subjects'}"
        if self.harmonic is None:
            text += f", {counts.sum()} {'photograph' if counts.sum() == 1 else 'photographs'}"
        if counts.min() < counts.max():
            text += f" (fewest {counts.min()}, of {names[counts.argmin()]})"
        rows, columns = self.mask.shape
        return f"{text} at {rows} x {columns} pixels"
