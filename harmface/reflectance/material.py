"""What a material is: a reflectance function, and its coefficients.

Directions are in the frame of the surface: z is the normal, and x, y are any two tangents, since a
material is isotropic here.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

import math
from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.sphere import real_harmonics

MOST_NODES = 256
"""Polar angles of incidence, and as many of reflection, beyond which quadrature gives up."""


class Material(ABC):
    """An isotropic material: `evaluate` defines it, and all else follows from that."""

    @abstractmethod
    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Return the bidirectional reflectance, without the cosine of incidence.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal; shapes broadcast.

        Returns
        -------
        numpy.ndarray
            Per steradian, at least 0, shape `(*channels, *pairs)`; 0 where either direction is
            below the surface.
        """

    def radial(self, max_degree: int) -> Float[np.ndarray, "... L"]:
        """Return `r_l`, by which light of degree `l` is scaled, seen along the normal.

        There the transfer function depends on one angle, and `r_l = 2 pi int rho(c) c P_l(c) dc`
        ([R05]_ eq. 26 for any lobe): it is taken as the lobe about the mirrored direction from
        every side. `r_0` is the reflected share.

        Parameters
        ----------
        max_degree
            Greatest degree, at least 0.

        Returns
        -------
        numpy.ndarray
            Factors, shape `(*channels, max_degree + 1)`.

        Raises
        ------
        ArgumentError
            If the degree is negative or not whole.
        """
        # Nodes in the polar angle lie where a sharp lobe is: the map t^2 draws them to its middle.
        nodes, weights = _half_line(max(200, 4 * checks.degree("max_degree", max_degree)))
        angle = nodes**2 * math.pi / 2
        measure = weights * 2 * nodes * math.pi / 2 * np.sin(angle)
        incoming = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)
        lobe = self.evaluate(incoming, np.array([0.0, 0.0, 1.0])) * np.cos(angle)
        legendre = np.polynomial.legendre.legvander(np.cos(angle), max_degree)
        return 2 * math.pi * (lobe * measure) @ legendre

    def coefficients(
        self, max_l: int, max_p: int, *, tolerance: float = 1e-3
    ) -> Float[np.ndarray, "... L P Q"]:
        """Return `rho_lpq` of the transfer function, reflectance times cosine of incidence.

        In real harmonics that is `rho cos = sum_lpq rho_lpq Y_lq(incoming) Y_pq(outgoing)`, with
        the same coefficient for `q` and `-q` ([R05]_ eq. 37-39). Quadrature is Gauss-Legendre in
        both polar angles and a Fourier sum in azimuth; nodes are doubled until no coefficient
        changes by more than `tolerance` of the largest.

        Parameters
        ----------
        max_l, max_p
            Greatest degree of the light and of the outgoing direction.
        tolerance
            Largest change, as a share of the largest coefficient.

        Returns
        -------
        numpy.ndarray
            Shape `(*channels, max_l + 1, max_p + 1, min(max_l, max_p) + 1)`, the last index `q`
            from 0; zero where `q` is above `l` or `p`.

        Raises
        ------
        ArgumentError
            If a degree is negative, or the lobe is too sharp for quadrature.
        """
        nodes = max(16, max_l + 2, max_p + 2)
        before = transfer_coefficients(self, max_l, max_p, nodes)
        while (nodes := 2 * nodes) <= MOST_NODES:
            found = transfer_coefficients(self, max_l, max_p, nodes)
            if np.abs(found - before).max() <= tolerance * np.abs(found).max():
                return found
            before = found
        raise ArgumentError(
            f"the coefficients of {self} do not settle to {tolerance:g} with {nodes // 2} polar "
            "angles; take a duller material, or its lobe (`radial`)"
        )


def transfer_coefficients(
    material: Material, max_l: int, max_p: int, nodes: int
) -> Float[np.ndarray, "... L P Q"]:
    """Return `rho_lpq` by quadrature with a given number of nodes, see `Material.coefficients`.

    The integral over both azimuths leaves `2 pi int rho(phi) cos(q phi) dphi` of their difference.

    Parameters
    ----------
    material
        Any isotropic material.
    max_l, max_p
        Greatest degrees.
    nodes
        Polar angles of the hemisphere; azimuths are twice as many.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, max_l + 1, max_p + 1, min(max_l, max_p) + 1)`.
    """
    max_l, max_p = checks.degree("max_l", max_l), checks.degree("max_p", max_p)
    most = min(max_l, max_p)
    # Nodes of the angle, not its cosine: reflectance has roots of the cosine at the horizon.
    unit, weights = _half_line(checks.positive_integer("nodes", nodes))
    angle = unit * math.pi / 2
    measure = weights * math.pi / 2 * np.sin(angle)
    meridian = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)
    # Half of the azimuths, by the mirror symmetry of an isotropic material.
    azimuth = (np.arange(nodes) + 0.5) * math.pi / nodes
    cosine, sine = np.cos(azimuth), np.sin(azimuth)
    incoming = np.stack(
        [
            np.multiply.outer(meridian[:, 0], cosine),
            np.multiply.outer(meridian[:, 0], sine),
            np.repeat(meridian[:, 2:], nodes, axis=1),
        ],
        axis=-1,
    )
    waves = np.cos(np.outer(azimuth, np.arange(most + 1))) * (2 * math.pi / nodes)
    profile = _profiles(meridian, max(max_l, max_p)) * measure
    total = []
    for one in meridian:
        values = material.evaluate(incoming, one) * meridian[:, 2:]
        total.append(values @ waves)
    spectrum = np.stack(total, axis=-3)
    return (
        2
        * math.pi
        * np.einsum(
            "...oiq,lqi,pqo->...lpq",
            spectrum,
            profile[: max_l + 1, : most + 1],
            profile[: max_p + 1, : most + 1],
            optimize=True,
        )
    )


def _profiles(meridian: Float[np.ndarray, "n 3"], degree: int) -> Float[np.ndarray, "L Q n"]:
    """Return `N_lq(theta)`: harmonics at azimuth 0, without the root of 2 of their cosines."""
    harmonics = real_harmonics(meridian, degree)
    profile = np.zeros((degree + 1, degree + 1, len(meridian)))
    for row in range(degree + 1):
        profile[row, : row + 1] = harmonics[row * (row + 1) : (row + 1) ** 2]
    profile[:, 1:] /= math.sqrt(2)
    return profile


def _half_line(count: int) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Return Gauss-Legendre nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (nodes + 1) / 2, weights / 2


def above(
    incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
) -> Float[np.ndarray, "..."]:
    """Return 1 where both directions are above the surface, 0 elsewhere."""
    return ((incoming[..., 2] > 0) & (outgoing[..., 2] > 0)).astype(np.float64)


def halfway(
    incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
) -> Float[np.ndarray, "*#pairs 3"]:
    """Return the unit vector halfway; the normal for opposite directions, which have none."""
    total = incoming + outgoing
    length = np.linalg.norm(total, axis=-1, keepdims=True)
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), total.shape)
    return np.divide(total, length, out=up.copy(), where=length > 1e-9)


def share(name: str, value: float) -> float:
    """Return `value` if it is a share of light: in [0, 1]."""
    if not 0 <= value <= 1:
        raise ArgumentError(f"{name} must lie in [0, 1], got {value}")
    return float(value)
