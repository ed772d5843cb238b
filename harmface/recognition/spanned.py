"""The distance to the subspace that a subject's images span.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import Gallery
from harmface.recognition.subspace import orthonormal_basis, subspace_distances


@dataclass(frozen=True)
class SubspaceDistance(Distance):
    """The `subspace_distances` ([BJ03]_, [R05]_ 0.4.1). Exposure plays no part.

    Of harmonic images all span the subspace, of photographs the leading singular vectors do, as
    many as a subject has photographs at least.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    dimension
        Greatest dimension of each subject's subspace.
    first
        Flat index of the first harmonic image: 1 leaves the ambient term out ([R05]_ 0.2.2).
    """

    dimension: int = 9
    first: int = 0

    @property
    def harmonics(self) -> slice:
        """As many as there are dimensions."""
        return slice(self.first, self.first + self.dimension)

    def fit(self, gallery: Gallery) -> Model:
        """Return orthonormal rows of each subject, (subjects, dimension, pixels of the mask).

        Parameters
        ----------
        gallery
            Who was enrolled.

        Returns
        -------
        mapping of str to numpy.ndarray
            `bases`: orthonormal rows of each subject, (N, dimension, pixels of the mask).

        Raises
        ------
        ArgumentError
            If the gallery does not hold the images of `source`, or somebody's are all black.
        """
        each = gallery.spanning(self.source, self.harmonics)
        dimension = min(self.dimension, *(len(own) for own in each))
        bases = [orthonormal_basis(own[:, gallery.mask], dimension) for own in each]
        return {"bases": np.stack(bases)}

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1].

        Parameters
        ----------
        model
            From `fit`.
        probes
            Linear photographs in the gallery's unit, (n, rows, columns).
        mask
            Pixels that are compared: those of the gallery.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), in [0, 1], subjects in the order of `Gallery.names`.
        """
        return subspace_distances(probes[:, mask], model["bases"])
