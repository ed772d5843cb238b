"""Functions on the sphere in many frames at a time: each normal's view of the light.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

import functools

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degree_order, harmonic_count, orders
from harmface.errors import ArgumentError
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.rotation import rotation_matrices
from harmface.sphere.transforms import degree_of_coefficients

_TILT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Carries +z to +y: a turn about y is a turn about z between it and its inverse."""


def in_frames(
    coefficients: Float[np.ndarray, "... K"], frames: Float[np.ndarray, "P 3 3"]
) -> Float[np.ndarray, "... P K"]:
    """Return the coefficients of functions as seen from frames, `w -> f(R w)`.

    The matrices `D^l_mq` of [R05]_ eq. 15-18 are turns about z, y and z again; those about z only
    mix the orders `m` and `-m`, and one about y is one about z in a frame laid on its side. So no
    matrix is made for each frame, and gimbal lock does no harm: any angles that make up the
    rotation do.

    Parameters
    ----------
    coefficients
        Finite coefficients of `f`, shape `(..., K)`.
    frames
        Rotations `R`, whose columns are a frame's axes, shape `(P, 3, 3)`.

    Returns
    -------
    numpy.ndarray
        Shape `(..., P, K)`, float64.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a value is not finite, or a frame is no rotation.

    Examples
    --------
    A lobe about x, seen from a frame whose third axis is x:

    >>> frame = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    >>> in_frames(np.array([0.0, 0.0, 0.0, 1.0]), frame[None]).round(12) + 0.0
    array([[0., 0., 1., 0.]])
    """
    coefficients = checks.finite("coefficients", coefficients)
    frames = checks.finite("frames", frames)
    product = np.einsum("pji,pjk->pik", frames, frames)
    if frames.size and (
        np.abs(product - np.eye(3)).max() > checks.UNIT_TOLERANCE or np.linalg.det(frames).min() < 0
    ):
        raise ArgumentError("frames must be rotations: right-handed, with orthogonal unit axes")
    degree = degree_of_coefficients(coefficients)
    polar = np.arctan2(np.hypot(frames[:, 0, 2], frames[:, 1, 2]), frames[:, 2, 2])
    upright = np.hypot(frames[:, 0, 2], frames[:, 1, 2]) < 1e-12
    first = np.where(upright, 0, np.arctan2(frames[:, 1, 2], frames[:, 0, 2]))
    # What is left after the first two turns is one about z.
    cosine, sine = np.cos(first), np.sin(first)
    across = np.stack([-sine, cosine, np.zeros_like(sine)], axis=-1)
    last = np.arctan2(
        np.einsum("pi,pi->p", across, frames[:, :, 0]),
        np.einsum("pi,pi->p", across, frames[:, :, 1]),
    )
    tilt = _tilt(degree)
    seen = _about_z(coefficients[..., None, :], first)
    seen = _about_z(seen @ tilt, polar) @ tilt.T
    return _about_z(seen, last)


@functools.lru_cache(maxsize=16)
def _tilt(max_degree: int) -> Float[np.ndarray, "K K"]:
    """Return the matrix of the fixed quarter turn, all degrees on its diagonal."""
    from scipy.linalg import block_diag

    matrix = block_diag(*rotation_matrices(_TILT, max_degree))
    matrix.flags.writeable = False
    return matrix


def _about_z(
    coefficients: Float[np.ndarray, "... #P K"], angle: Float[np.ndarray, "P"]
) -> Float[np.ndarray, "... P K"]:
    """Return the coefficients of `w -> f(R_z(angle) w)`: cosines and sines of one order mix."""
    degree = degree_of_coefficients(coefficients)
    order = orders(degree)
    partner = np.arange(len(order)) - 2 * order
    phase = np.multiply.outer(angle, order)
    return coefficients * np.cos(phase) + coefficients[..., partner] * np.sin(phase)


def mixed_functions(
    frames: Float[np.ndarray, "P 3 3"],
    outgoing: Float[np.ndarray, "P 3"],
    max_l: int,
    max_p: int,
) -> Float[np.ndarray, "K L Q P"]:
    """Return `sum over q, -q of D^l_mq(R) Y_pq(w)`, in which a reflected field is expanded.

    Without the factor `sqrt((2l + 1) / (4 pi))` of [R05]_ eq. 38, which goes with its `Lambda_l`.

    Parameters
    ----------
    frames
        Rotations whose third column is the normal.
    outgoing
        Unit directions to the viewer, in these frames.
    max_l, max_p
        Greatest degree of the light and of the outgoing direction.

    Returns
    -------
    numpy.ndarray
        Shape `((max_l + 1)**2, max_p + 1, min(max_l, max_p) + 1, P)`, the third index `q` from 0.

    Raises
    ------
    ArgumentError
        If a degree is negative, a frame no rotation, or a direction not of unit length.
    """
    count = harmonic_count(max_l)
    most = min(max_l, checks.degree("max_p", max_p))
    turned = in_frames(np.eye(count), frames)
    harmonics = real_harmonics(outgoing, max_p)
    functions = np.zeros((count, max_p + 1, most + 1, len(frames)))
    for k in range(count):
        l = degree_order(k)[0]  # noqa: E741 - the field's name for it
        for p in range(max_p + 1):
            for q in range(min(l, p) + 1):
                for order in {q, -q}:
                    product = turned[k, :, l * (l + 1) + order] * harmonics[p * (p + 1) + order]
                    functions[k, p, q] += product
    return functions


def frames_facing(
    normals: Float[np.ndarray, "P 3"], towards: Float[np.ndarray, "P 3"]
) -> Float[np.ndarray, "P 3 3"]:
    """Return frames whose third axis is a normal and whose first points towards the viewer.

    Parameters
    ----------
    normals
        Unit normals.
    towards
        Unit directions; one along its normal leaves any first axis.

    Returns
    -------
    numpy.ndarray
        Rotations, the axes as columns, shape (P, 3, 3).

    Raises
    ------
    ArgumentError
        If a vector is not of unit length.
    """
    normals = checks.unit_vectors("normals", normals).astype(np.float64)
    towards = checks.unit_vectors("towards", towards).astype(np.float64)
    across = towards - np.einsum("pi,pi->p", towards, normals)[:, None] * normals
    spare = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=-1)])
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    first = np.where(length > 1e-6, across, spare)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    return np.stack([first, np.cross(normals, first), normals], axis=-1)
