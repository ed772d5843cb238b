"""Spherical harmonic reflection maps: what any isotropic material shows, from every side.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
.. [RH02] Ramamoorthi and Hanrahan, Frequency Space Environment Map Rendering, SIGGRAPH 2002.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degree_order, harmonic_count
from harmface.errors import ArgumentError
from harmface.light import EnvironmentMap, project
from harmface.reflectance import Material
from harmface.sphere import (
    energy_per_degree,
    frames_facing,
    in_frames,
    real_harmonics,
)
from harmface.summaries import summary

MOST_DEGREE = 40
"""Degree to which a field is tried: beyond, a prefiltered map (`reflection_map`) is better."""


@dataclass(frozen=True, eq=False)
class ReflectedField:
    """The radiance `B(n, w) = sum L_lm D^l_mq(n) rho_lpq Y_pq(w)`, [R05]_ eq. 37-39.

    The outgoing direction stays above the surface, so that what the series does below is free: it
    is made even, with which it has no step at the horizon. Terms with `p + q` odd vanish then, and
    the others count twice.

    Parameters
    ----------
    light
        Coefficients of radiance, `(*channels, K)`.
    material
        Coefficients `rho_lpq` of `Material.coefficients`, of as many degrees `l`.

    Raises
    ------
    ArgumentError
        If degrees do not agree.
    """

    light: Float[np.ndarray, "*channels K"]
    material: Float[np.ndarray, "L P Q"]

    __repr__ = summary

    def __post_init__(self) -> None:
        checks.finite("light", self.light)
        checks.finite("material", self.material)
        if self.material.ndim != 3 or self.light.shape[-1] != len(self.material) ** 2:
            raise ArgumentError(
                "material must have shape (L, P, Q) with L degrees as light, got "
                f"{self.material.shape} for {self.light.shape[-1]} coefficients of light"
            )

    @classmethod
    def of(
        cls, environment: EnvironmentMap, material: Material, accuracy: float = 1e-2
    ) -> "ReflectedField":
        """Return the field with as many terms as an accuracy needs.

        Over all normals and directions the energy of the terms of degrees `l` and `p` is
        `|L_l|^2 / (2l + 1) sum_q rho_lpq^2`: the matrices `D^l_mq` are orthogonal on the
        rotations.

        Parameters
        ----------
        environment
            Radiance from all sides.
        material
            In one channel.
        accuracy
            Root mean square of what is cut off, as a share of the radiance's own.

        Returns
        -------
        ReflectedField

        Raises
        ------
        ArgumentError
            If the accuracy is not in (0, 1), or takes more than degree 40.
        """
        if not 0 < accuracy < 1:
            raise ArgumentError(f"accuracy must lie between 0 and 1, got {accuracy}")
        light = project(environment, MOST_DEGREE)
        rho = material.coefficients(MOST_DEGREE, MOST_DEGREE, tolerance=accuracy / 10)
        if rho.ndim != 3:
            raise ArgumentError("a reflected field takes a material in one channel")
        power = energy_per_degree(light).reshape(-1, MOST_DEGREE + 1).sum(axis=0)
        energy = power / (2 * np.arange(MOST_DEGREE + 1) + 1) * (_above(rho) ** 2 @ _both(rho)).T
        most = []
        for axis in (0, 1):
            tail = np.cumsum(energy.sum(axis=axis)[::-1])[::-1]
            few = np.flatnonzero(tail[1:] <= accuracy**2 / 2 * tail[0])
            if not len(few) or few[0] > MOST_DEGREE // 2:
                raise ArgumentError(
                    f"{material} takes more than degree {MOST_DEGREE // 2} for an accuracy of "
                    f"{accuracy:g}; take a duller one, or prefilter the map"
                )
            most.append(int(few[0]))
        l, p = most  # noqa: E741 - the field's names
        return cls(light[..., : harmonic_count(l)], rho[: l + 1, : p + 1, : min(l, p) + 1])

    def coefficients(
        self, frames: Float[np.ndarray, "P 3 3"]
    ) -> Float[np.ndarray, "*channels P K"]:
        """Return the radiance of normals as coefficients over the outgoing direction.

        Parameters
        ----------
        frames
            Rotations whose third column is the normal: the outgoing direction is in them.

        Returns
        -------
        numpy.ndarray
            Shape `(*channels, P, K)`, which `sphere.synthesize` takes.
        """
        local = in_frames(self.light, frames)
        rho = _above(self.material)
        shown = np.zeros((*local.shape[:-1], harmonic_count(rho.shape[1] - 1)))
        for k in range(shown.shape[-1]):
            p, q = degree_order(k)
            degrees = np.arange(abs(q), len(rho))
            if len(degrees):
                shown[..., k] = local[..., degrees * (degrees + 1) + q] @ rho[degrees, p, abs(q)]
        return shown

    def radiance(
        self, normals: Float[np.ndarray, "P 3"], to_camera: Float[np.ndarray, "P 3"]
    ) -> Float[np.ndarray, "*channels P"]:
        """Return the radiance that a camera sees.

        Parameters
        ----------
        normals
            Unit normals.
        to_camera
            Unit directions to the camera; what lies behind the surface is dark.

        Returns
        -------
        numpy.ndarray
            Shape `(*channels, P)`. Where a series is cut off it can dip below zero.

        Raises
        ------
        ArgumentError
            If a direction is not of unit length.
        """
        frames = frames_facing(normals, to_camera)
        local = np.einsum("pij,pi->pj", frames, to_camera)
        local /= np.linalg.norm(local, axis=-1, keepdims=True)
        harmonics = real_harmonics(local, self.material.shape[1] - 1)
        shown = np.einsum("...pk,kp->...p", self.coefficients(frames), harmonics)
        return shown * (local[:, 2] > 0)


def _above(rho: Float[np.ndarray, "L P Q"]) -> Float[np.ndarray, "L P Q"]:
    """Return the coefficients of the function made even about the outgoing horizon."""
    p, q = np.indices(rho.shape[1:])
    return 2 * rho * ((p + q) % 2 == 0)


def _both(rho: Float[np.ndarray, "L P Q"]) -> Float[np.ndarray, "Q"]:
    """Return how many orders each `q` stands for: it and its negative."""
    return np.where(np.arange(rho.shape[2]) > 0, 2.0, 1.0)
