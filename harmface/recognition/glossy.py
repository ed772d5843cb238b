"""The distance to a harmonic subspace that holds highlights, too."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harmface.recognition.distance import Model
from harmface.recognition.gallery import HARMONIC, SHADOWED, Gallery
from harmface.recognition.spanned import SubspaceDistance
from harmface.recognition.specular import extended_bases, specular_images
from harmface.recognition.subspace import orthonormal_basis


@dataclass(frozen=True)
class GlossyDistance(SubspaceDistance):
    """The distance to harmonic images and the dimensions that hold most of a lobe's highlights.

    Normals are those that the harmonic images of degree 1 tell, `albedo n` up to one factor; the
    view is orthographic, from +z. See `extended_bases` for which dimensions are added.

    Parameters
    ----------
    source
        What subjects are known by: "harmonic" or "shadowed".
    dimension
        Dimension of the diffuse subspace.
    first
        Flat index of the first harmonic image.
    exponent
        Sharpness of the highlights, that of Phong's lobe.
    extra
        How many dimensions are added.
    """

    sources: ClassVar[tuple[str, ...]] = (HARMONIC, SHADOWED)
    source: str = HARMONIC
    exponent: float = 8.0
    extra: int = 1

    def fit(self, gallery: Gallery) -> Model:
        """Return orthonormal rows of each subject, (N, dimension + extra, pixels of the mask)."""
        diffuse = np.stack(gallery.spanning(self.source, self.harmonics))[..., gallery.mask]
        bases = orthonormal_basis(diffuse, self.dimension)
        # Without cast shadows, of Y_1-1, Y_10 and Y_11: y, z and x, times the albedo.
        y, z, x = np.stack(gallery.spanning(HARMONIC, slice(1, 4)))[..., gallery.mask].swapaxes(
            0, 1
        )
        normals = np.stack([x, y, z], axis=-1).astype(np.float64)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        towards = np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
        specular = specular_images(normals, towards, self.exponent).swapaxes(0, 1)
        return {"bases": extended_bases(bases, specular.astype(bases.dtype), self.extra)}
