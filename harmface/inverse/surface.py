"""The surface in a photograph: what every pixel shows, and what light reaches it."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion

from harmface.errors import ArgumentError
from harmface.geometry import Camera, GBuffer, Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight, EnvironmentMap
from harmface.rendering import (
    harmonic_images,
    irradiance,
    relight,
    render,
    shadowed_harmonic_images,
)

DIRECTIONS = 600
"""Directions that stand for an environment map, 8 degrees apart."""

SUPERSAMPLING = 2


@dataclass(frozen=True, eq=False)
class PhotographedSurface:
    """Normals of every pixel, and a mesh behind them where there is one.

    Parameters
    ----------
    normals
        Unit normals, zero vectors in the background.
    mask
        Where pixels show the surface.
    albedo
        Of every pixel, in grey or colour; None if it is not known.
    view, caster
        What the camera sees of the mesh that casts shadows; None without one.
    """

    normals: Float[np.ndarray, "H W 3"]
    mask: Bool[np.ndarray, "H W"]
    albedo: Float[np.ndarray, "H W *channels"] | None = None
    view: GBuffer | None = None
    caster: Mesh | None = None

    @classmethod
    def of_normals(cls, normals: Float[np.ndarray, "H W 3"]) -> "PhotographedSurface":
        """Return a surface of which the normals are known, without cast shadows.

        Parameters
        ----------
        normals
            Unit normals, zero vectors in the background.

        Returns
        -------
        PhotographedSurface
            The pixels that have a normal, of unknown albedo.
        """
        return cls(normals, (normals != 0).any(axis=-1))

    @classmethod
    def of_mesh(
        cls, mesh: Mesh, frame: Camera | tuple[int, int], *, cast_shadows: bool = True
    ) -> "PhotographedSurface":
        """Return what a camera sees of a mesh.

        Parameters
        ----------
        mesh
            The surface, in the pose of the photograph.
        frame
            The camera, or rows and columns of a photograph framed by `frame_orthographic`.
        cast_shadows
            Whether the mesh shadows itself.
        """
        camera = frame_orthographic(mesh, frame) if isinstance(frame, tuple) else frame
        view = gbuffer(mesh, camera, SUPERSAMPLING)
        coloured = np.ptp(view.albedo[view.mask], axis=0).any()
        albedo = view.albedo if coloured else None
        return cls(view.normals, view.mask, albedo, view, mesh if cast_shadows else None)

    @property
    def inner(self) -> Bool[np.ndarray, "H W"]:
        """The mask without pixels at a mesh's outline, which show the background too."""
        return self.mask if self.view is None else self.mask & binary_erosion(self.view.mask)

    def within(self, mask: Bool[np.ndarray, "H W"]) -> "PhotographedSurface":
        """Return the surface where a mask is true as well.

        Parameters
        ----------
        mask
            Pixels that may be kept.

        Returns
        -------
        PhotographedSurface
            With the smaller mask, else the same.

        Raises
        ------
        ArgumentError
            If the mask is of another size or misses the surface.
        """
        if mask.shape != self.mask.shape or not (mask & self.mask).any():
            raise ArgumentError(
                f"mask must be of {self.mask.shape} pixels and meet the surface, got {mask.shape}"
            )
        return replace(self, mask=self.mask & mask)

    def harmonic_irradiances(self, degree: int) -> Float[np.ndarray, "K H W"]:
        """Return the irradiance of every pixel under each harmonic, with its cast shadows.

        Parameters
        ----------
        degree
            Highest degree.

        Returns
        -------
        numpy.ndarray
            `K = (degree + 1)**2` images in float64, 0 outside the mask.
        """
        white = self.mask.astype(np.float64)
        if self.view is None or self.caster is None:
            return harmonic_images(self.normals.astype(np.float64), white, degree)
        return shadowed_harmonic_images(
            replace(self.view, mask=self.mask), self.caster, degree, albedo=white
        )

    def irradiance(
        self, light: EnvironmentMap | DistantLight | Float[np.ndarray, "*channels K"]
    ) -> Float[np.ndarray, "*channels H W"]:
        """Return the irradiance of every pixel under a light, 0 outside the mask.

        Maps and lamps are summed over directions, with cast shadows; coefficients are evaluated
        as harmonics.

        Parameters
        ----------
        light
            A map, lamps, or coefficients of radiance.

        Returns
        -------
        numpy.ndarray
            Irradiance, `(*channels, H, W)`, in the unit of the lamps' or of radiance times sr.
        """
        if isinstance(light, np.ndarray):
            degree = round(light.shape[-1] ** 0.5) - 1
            return np.maximum(relight(light, self.harmonic_irradiances(degree)), 0)
        if isinstance(light, EnvironmentMap):
            light = light.as_distant_light(DIRECTIONS)
        if self.view is not None:
            white = self.mask.astype(np.float64)
            seen = replace(self.view, mask=self.mask)
            return render(seen, light, albedo=white, caster=self.caster)
        image = np.zeros((*light.irradiances.shape[:-1], *self.mask.shape))
        image[..., self.mask] = irradiance(self.normals[self.mask], light)
        return image
