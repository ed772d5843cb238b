"""What every way to compare a probe with the subjects of a gallery has in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.conventions import harmonic_count, max_degree_of
from harmface.errors import ArgumentError
from harmface.recognition.answers import estimated_light
from harmface.recognition.gallery import HARMONIC, PHOTOGRAPHS, SHADOWED, SOURCES, Gallery
from harmface.recognition.subspace import orthonormal_basis

Model = Mapping[str, np.ndarray]
"""What a distance learned of a gallery: arrays by name, which a file can hold."""


@dataclass(frozen=True)
class Distance(ABC):
    """A way to compare; a subclass for each.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    """

    source: str = PHOTOGRAPHS
    sources: ClassVar[tuple[str, ...]] = SOURCES
    """Those that the distance can do with."""

    learns: ClassVar[bool] = False
    """Whether other people than the gallery's are learned from."""

    positive_only: ClassVar[bool] = False
    """Whether images must be nowhere negative."""

    def __post_init__(self) -> None:
        if self.source not in self.sources:
            raise ArgumentError(
                f"source must be one of {', '.join(self.sources)}, got {self.source!r}"
            )

    @property
    def harmonics(self) -> slice:
        """Which harmonic images are compared with, by their flat index."""
        return slice(0, 9)

    @property
    def of_framed(self) -> "Distance":
        """The distance to use where probes are known to be framed as the gallery is."""
        return self

    @property
    def of_surfaces(self) -> bool:
        """Whether subjects are known by harmonic images, and not by photographs."""
        return self.source in (HARMONIC, SHADOWED)

    @abstractmethod
    def fit(self, gallery: Gallery) -> Model:
        """Return what is to be known of the subjects of a gallery.

        Parameters
        ----------
        gallery
            Who was enrolled.

        Returns
        -------
        mapping of str to numpy.ndarray
            Arrays by name, which a file can hold.

        Raises
        ------
        ArgumentError
            If the gallery does not hold the images of `source`.
        """

    def searched(self, model: Model) -> Model:
        """Return the model to search for a probe's place with, where another is better for that.

        A distance that absorbs small motion need not where motion is searched for.

        Parameters
        ----------
        model
            From `fit`.

        Returns
        -------
        mapping of str to numpy.ndarray
            Such as `distances` takes.
        """
        return model

    @abstractmethod
    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, at least 0.

        Parameters
        ----------
        model
            From `fit`.
        probes
            Linear photographs.
        mask
            Pixels that are compared: those of the gallery.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), subjects in the order of `Gallery.names`.
        """

    def light(
        self, probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "n K p"]
    ) -> Float[np.ndarray, "n K"]:
        """Return the light under which harmonic images look most like each probe.

        Parameters
        ----------
        probes
            Images as rows of pixels, (n, p).
        images
            Harmonic images of the subject that each probe is compared with, (n, K, p).

        Returns
        -------
        numpy.ndarray
            Shape (n, K): harmonic coefficients.
        """
        return estimated_light(probes, images)

    def explained(
        self,
        gallery: Gallery,
        probes: Float[np.ndarray, "n H W"],
        which: Integer[np.ndarray, "n"],
    ) -> tuple[Float[np.ndarray, "n H W"], Float[np.ndarray, "n K"] | None]:
        """Return what a subject looks like at its most alike to each probe, and in which light.

        Without harmonic images it is the projection onto the span of the subject's photographs,
        and the light unknown.

        Parameters
        ----------
        gallery
            That of `fit`.
        probes
            Linear photographs.
        which
            Number of the subject to compare each with.

        Returns
        -------
        pictures : numpy.ndarray
            Shape (n, rows, columns), in the probes' unit; of photographs, zero outside the mask.
        light : numpy.ndarray or None
            Shape (n, K): harmonic coefficients, those that play no part zero.
        """
        mask, each = gallery.mask, gallery.spanning(self.source, self.harmonics)
        pixels = probes[:, mask].astype(np.float64)
        if not self.of_surfaces:
            pictures = np.zeros(probes.shape)
            for picture, image, subject in zip(pictures, pixels, which, strict=True):
                own = each[subject][:, mask].astype(np.float64)
                basis = orthonormal_basis(own, min(own.shape))
                picture[mask] = (basis @ image) @ basis
            return pictures, None
        own = np.stack(each)[which].astype(np.float64)
        light = self.light(pixels, own[..., mask])
        pictures = np.einsum("nk,nkhw->nhw", light, own)
        first = self.harmonics.start
        # Coefficients of harmonics that are left out are zero.
        whole = np.zeros((len(light), harmonic_count(max_degree_of(self.harmonics.stop))))
        whole[:, first : self.harmonics.stop] = light
        return pictures, whole
