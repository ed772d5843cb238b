"""Which lights to photograph a subject under, so that the photographs span its subspace.

References
----------
.. [LHK05] Lee, Ho and Kriegman, Acquiring Linear Subspaces for Face Recognition under Variable
   Lighting, PAMI 2005.
"""

import numpy as np
from jaxtyping import Float, Integer
from scipy.optimize import linear_sum_assignment

from harmface import checks
from harmface.conventions import directions_from_angles
from harmface.errors import ArgumentError
from harmface.recognition.subspace import orthonormal_basis

_POLAR_AND_AZIMUTH = (
    *((0, 0), (68, -90), (74, 108), (80, 52), (85, -42), (85, -137), (85, 146), (85, -4)),
    (51, 67),
)


def nine_points() -> Float[np.ndarray, "9 3"]:
    """Return the directions to the nine lights of [LHK05]_, the same for every face.

    Returns
    -------
    numpy.ndarray
        Shape (9, 3): unit directions, in float64; the first is the camera's.

    Examples
    --------
    >>> nine_points()[0]
    array([0., 0., 1.])
    """
    polar, azimuth = np.radians(_POLAR_AND_AZIMUTH).T
    return directions_from_angles(polar, azimuth)


def nearest_lights(
    available: Float[np.ndarray, "J 3"], wanted: Float[np.ndarray, "n 3"]
) -> Integer[np.ndarray, "n"]:
    """Return the index of the light to take for each wanted direction, none taken twice.

    The sum of the angles between what is wanted and what is taken is the least there is.

    Parameters
    ----------
    available
        Unit directions of the lights that there are photographs of.
    wanted
        Unit directions, such as `nine_points`.

    Returns
    -------
    numpy.ndarray
        Shape (n,): indices into `available`.

    Raises
    ------
    ArgumentError
        If there are fewer lights than directions.
    """
    available = checks.unit_vectors("available", available)
    wanted = checks.unit_vectors("wanted", wanted)
    if len(available) < len(wanted):
        raise ArgumentError(
            f"available must hold a light for each of {len(wanted)} directions, "
            f"got {len(available)}"
        )
    angles = np.arccos(np.clip(wanted @ available.T, -1, 1))
    return linear_sum_assignment(angles)[1]


def greedy_lights(
    photographs: Float[np.ndarray, "N J p"], harmonic: Float[np.ndarray, "N K p"], count: int = 9
) -> Integer[np.ndarray, "n"]:
    """Choose lights one by one, each far from those before and near the harmonic subspace.

    The next is the light `j` with the greatest sum over the subjects of
    `dist(x_j, span chosen) / dist(x_j, harmonic subspace)`, as [LHK05]_ found the nine points.

    Parameters
    ----------
    photographs
        Images of every subject under the same `J` lights, as rows of pixels.
    harmonic
        Harmonic images of every subject.
    count
        How many lights to choose.

    Returns
    -------
    numpy.ndarray
        Indices of lights in the order chosen.

    Raises
    ------
    ArgumentError
        If there are fewer lights than wanted, or the photographs do not match the subjects.
    """
    photographs = checks.finite("photographs", photographs)
    count = checks.positive_integer("count", count)
    if photographs.shape[1] < count:
        raise ArgumentError(
            f"photographs must show at least {count} lights, got {photographs.shape[1]}"
        )
    if photographs.shape[::2] != harmonic.shape[::2]:
        raise ArgumentError(
            f"harmonic must be of the subjects and pixels of photographs "
            f"{photographs.shape[::2]}, got {harmonic.shape[::2]}"
        )
    basis = orthonormal_basis(harmonic, harmonic.shape[1])
    outside = photographs - photographs @ basis.swapaxes(1, 2) @ basis
    to_harmonic = np.linalg.norm(outside, axis=2)
    scale = np.linalg.norm(photographs, axis=2)
    to_harmonic = np.maximum(to_harmonic, np.sqrt(np.finfo(photographs.dtype).eps) * scale)
    rest = photographs.copy()
    chosen: list[int] = []
    for _ in range(count):
        quality = np.linalg.norm(rest, axis=2) / np.where(scale > 0, to_harmonic, 1)
        total = quality.sum(axis=0)
        total[chosen] = -1
        chosen.append(int(total.argmax()))
        along = rest[:, chosen[-1]]
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along = np.divide(along, length, out=np.zeros_like(along), where=length > 0)
        rest = rest - (rest @ along[:, :, None]) * along[:, None]
    return np.array(chosen)
