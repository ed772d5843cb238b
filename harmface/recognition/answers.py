"""What a distance means: how sure a name is, whether anybody is known at all, and why.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
"""

import numpy as np
from jaxtyping import Float
from scipy.special import softmax

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.probes import checked_probes


def margins(distances: Float[np.ndarray, "n N"]) -> Float[np.ndarray, "n"]:
    """Return how much farther the second subject is than the first, relative to the second.

    0 is a tie, 1 certainty.

    Parameters
    ----------
    distances
        Of every probe to every subject, at least two, (n, N), at least 0.

    Returns
    -------
    numpy.ndarray
        Shape (n,), in [0, 1].

    Raises
    ------
    ArgumentError
        If there are fewer than two subjects to tell apart.
    """
    distances = _of_subjects(distances)
    first, second = np.partition(distances, 1, axis=1)[:, :2].T
    return np.divide(second - first, second, out=np.zeros_like(first), where=second > 0)


def posteriors(distances: Float[np.ndarray, "n N"], independent: float) -> Float[np.ndarray, "n N"]:
    """Return the probability of every subject, given that the probe shows one of them.

    Pixels err by independent Gaussian noise of unknown strength, so the likelihood of a subject
    at distance `d` is proportional to `d**-independent`; all are as probable beforehand.

    Parameters
    ----------
    distances
        Distances relative to the probe's norm.
    independent
        How many pixels err independently: their number less the dimension of the subspace for
        the camera's noise, far fewer for errors that neighbours share.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), each row of sum 1.

    Raises
    ------
    ArgumentError
        If there are fewer than two subjects, a distance is negative or NaN, or `independent` is not
        above 0.
    """
    distances = _of_subjects(distances)
    if not (np.isfinite(independent) and independent > 0):
        raise ArgumentError(f"independent must be above 0, got {independent}")
    smallest = np.finfo(distances.dtype).tiny
    return softmax(-independent * np.log(np.maximum(distances, smallest)), axis=1)


def likelihood_posteriors(log: Float[np.ndarray, "n N"]) -> Float[np.ndarray, "n N"]:
    """Return the probability of every subject, all as probable beforehand, by the camera's noise.

    Parameters
    ----------
    log
        Logarithms of the likelihoods, see `likelihoods`.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), each row of sum 1.

    Raises
    ------
    ArgumentError
        On NaN or infinity.
    """
    return softmax(checks.finite("log", log), axis=1)


def estimated_light(
    probes: Float[np.ndarray, "n p"], images: Float[np.ndarray, "n K p"]
) -> Float[np.ndarray, "n K"]:
    """Return the light under which a subject looks most like a probe, free to be negative.

    `L = argmin |L S - x|`, the shortest if there are several; `rendering.relight` of it is the
    reconstruction to show beside the probe, and `non_negative_light` the light that is nowhere
    negative.

    Parameters
    ----------
    probes
        Images as rows of pixels.
    images
        Harmonic images of the subject that each probe is compared with.

    Returns
    -------
    numpy.ndarray
        Shape (n, K): harmonic coefficients of the light, in the unit of the probes over that of
        the images.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, or images of other pixels or of another number than the probes.
    """
    images = checks.finite("images", images)
    probes = checked_probes(probes, images.shape[-1])
    if len(images) != len(probes):
        raise ArgumentError(
            f"images must hold a subject for each of {len(probes)} probes, got {len(images)}"
        )
    return (probes[:, None] @ np.linalg.pinv(images))[:, 0]


def _of_subjects(distances: Float[np.ndarray, "n N"]) -> Float[np.ndarray, "n N"]:
    distances = checks.non_negative("distances", distances)
    if distances.shape[1] < 2:
        raise ArgumentError(
            f"distances must be to at least two subjects, got {distances.shape[1]}; enroll more"
        )
    return distances
