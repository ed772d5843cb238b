"""Who can be recognised: harmonic images of every subject, in one common frame."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import luminance, max_degree_of
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight
from harmface.recognition.cast_shadows import shadowed_harmonic_images
from harmface.recognition.subspace import HARMONICS_OF
from harmface.rendering import box_average, harmonic_images, render

SUPERSAMPLING = 2


@dataclass(frozen=True, eq=False)
class Gallery:
    """Enrolled subjects.

    All images share the frontal orthographic frame of `frame_orthographic`: the whole mesh,
    centred by its bounding box, its height filling 1 / 1.05 of the picture.

    Parameters
    ----------
    subjects
        Distinct names.
    images
        Harmonic images of each subject, see `harmonic_images`; zero in the background.
    """

    subjects: tuple[str, ...]
    images: Float[np.ndarray, "N K H W"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "images", checks.finite("images", self.images))
        if len(self.subjects) != len(self.images) or not self.subjects:
            raise ArgumentError(
                f"subjects must name each of {len(self.images)} sets of images, "
                f"got {len(self.subjects)} names"
            )
        repeated = {name for name in self.subjects if self.subjects.count(name) > 1}
        if repeated:
            raise ArgumentError(f"subjects must be distinct, got {sorted(repeated)[0]!r} twice")
        max_degree_of(self.images.shape[1])
        if not self.mask.any():
            raise ArgumentError("subjects must share some pixels, but no pixel shows all of them")

    @property
    def mask(self) -> Bool[np.ndarray, "H W"]:
        """Pixels where every subject has a surface: those that comparisons are made on.

        The background of a photograph then plays no part.
        """
        return np.asarray((self.images[:, 0] > 0).all(axis=0))

    def spanning(self, method: str) -> Float[np.ndarray, "N d p"]:
        """Return the images that span each subject's subspace, over the pixels of `mask`.

        Parameters
        ----------
        method
            "3d", "4d" or "9d".
        """
        if method not in HARMONICS_OF:
            raise ArgumentError(f"method must be one of {', '.join(HARMONICS_OF)}, got {method!r}")
        wanted = HARMONICS_OF[method]
        if wanted.stop > self.images.shape[1]:
            raise ArgumentError(
                f"method {method} needs {wanted.stop} harmonic images, the gallery has "
                f"{self.images.shape[1]}; enroll with a higher degree"
            )
        return self.images[:, wanted, self.mask]


def enroll(
    meshes: Mapping[str, Mesh], size: int = 64, degree: int = 2, cast_shadows: bool = False
) -> Gallery:
    """Render the harmonic images of every mesh in the common frontal frame.

    Parameters
    ----------
    meshes
        Mesh of each subject by name; faces look along +z.
    size
        Rows and columns of the images.
    degree
        Highest degree of the harmonics.
    cast_shadows
        Whether to cast rays for the shadows of the subject on itself: slower, and nearer to
        photographs.

    Raises
    ------
    ArgumentError
        If there is no mesh, or one that cannot be seen.
    """
    if not meshes:
        raise ArgumentError("meshes must hold at least one subject, got none")
    images = [subject_images(mesh, size, degree, cast_shadows) for mesh in meshes.values()]
    return Gallery(tuple(meshes), np.stack(images))


def subject_images(
    mesh: Mesh, size: int, degree: int, cast_shadows: bool = False
) -> Float[np.ndarray, "K H W"]:
    """Return the harmonic images of one subject in the common frontal frame, in float32."""
    if cast_shadows:
        # Rays must start on the surface, not at the mean of a pixel's samples, which lies in it.
        view = gbuffer(mesh, frame_orthographic(mesh, size * SUPERSAMPLING))
        fine = shadowed_harmonic_images(view, mesh, degree)
        return box_average(fine, SUPERSAMPLING).astype(np.float32)
    view = gbuffer(mesh, frame_orthographic(mesh, size), SUPERSAMPLING)
    return harmonic_images(view.normals, luminance(view.albedo), degree).astype(np.float32)


def subject_photographs(mesh: Mesh, light: DistantLight, size: int) -> Float[np.ndarray, "F H W"]:
    """Return photographs of one subject in the common frontal frame, with cast shadows.

    Rendered by the oracle and not by harmonics: what `fit` of a classifier takes in place of
    photographs, for instance under `nine_points`.

    Parameters
    ----------
    mesh
        The subject.
    light
        One photograph for each of its leading axis.
    size
        Rows and columns.
    """
    view = gbuffer(mesh, frame_orthographic(mesh, size * SUPERSAMPLING))
    images = render(view, light, caster=mesh)
    return box_average(images, SUPERSAMPLING).astype(np.float32)
