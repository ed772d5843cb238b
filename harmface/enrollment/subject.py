"""A subject whose surface was recovered from photographs, ready to be seen in other light."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import GBuffer, Mesh, OrthographicCamera, depth_to_mesh
from harmface.light import DistantLight
from harmface.rendering import harmonic_images, render, shadowed_harmonic_images


@dataclass(frozen=True)
class RelitSubject:
    """Surface and albedo of a subject, over the whole of its photographs.

    Parameters
    ----------
    depth
        Height towards the viewer, in pixels.
    albedo
        Albedo in the photographs' unit: a surface that faces a light of irradiance 1 has the
        brightness that it would have in a photograph.

    Raises
    ------
    ArgumentError
        If the sizes differ, a value is NaN or the albedo negative.
    """

    depth: Float[np.ndarray, "H W"]
    albedo: Float[np.ndarray, "H W"]

    def __post_init__(self) -> None:
        checks.finite("depth", self.depth)
        checks.non_negative("albedo", self.albedo)
        if self.depth.shape != self.albedo.shape:
            raise ArgumentError(
                f"albedo must have the depth's size {self.depth.shape}, got {self.albedo.shape}"
            )

    @cached_property
    def mesh(self) -> Mesh:
        """The surface, which casts the shadows; a vertex a pixel."""
        return depth_to_mesh(self.depth, np.ones(self.depth.shape, bool))

    @property
    def normals(self) -> Float[np.ndarray, "H W 3"]:
        """Unit normals."""
        return self.mesh.normals.reshape(*self.depth.shape, 3)

    @property
    def view(self) -> GBuffer:
        """The subject as its photographs show it."""
        high = float(self.depth.max()) + 1.0
        albedo = np.repeat(self.albedo[..., None].astype(np.float64), 3, axis=2)
        return GBuffer(
            self.normals,
            albedo,
            high - self.depth.astype(np.float64),
            self.mesh.vertices.reshape(*self.depth.shape, 3),
            np.ones(self.depth.shape, bool),
            OrthographicCamera((0.0, 0.0, high), float(len(self.depth)), self.depth.shape),
        )

    def photographs(self, lights: Float[np.ndarray, "J 3"]) -> Float[np.ndarray, "J H W"]:
        """Return the subject under one light at a time, with the shadows it casts.

        Parameters
        ----------
        lights
            Unit direction to each light, of irradiance 1.

        Returns
        -------
        numpy.ndarray
            Shape (J, H, W), in the photographs' unit, in float64.
        """
        light = DistantLight(lights, np.eye(len(lights)))
        return render(self.view, light, caster=self.mesh)

    def harmonic_images(
        self, degree: int = 2, cast_shadows: bool = False
    ) -> Float[np.ndarray, "K H W"]:
        """Return the images that span the subject's harmonic subspace.

        Parameters
        ----------
        degree
            Highest degree of the light.
        cast_shadows
            Whether to cast rays for the shadows of the surface on itself.

        Returns
        -------
        numpy.ndarray
            Shape (K, H, W), in the photographs' unit: irradiance times albedo under each harmonic.
        """
        if cast_shadows:
            return shadowed_harmonic_images(self.view, self.mesh, degree)
        return harmonic_images(self.normals, self.albedo, degree)
