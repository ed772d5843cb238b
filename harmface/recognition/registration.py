"""A probe that is shifted, turned or scaled by a little, registered to a subject's subspace.

The fit of the subspace and the motion are found by turns: the reconstruction has the probe's own
light, so that aligning it with the probe, by OpenCV's enhanced correlation coefficient ([EP08]_),
is a matter of geometry alone. First the probe is registered to what all subjects have in common;
then to each of the few subjects that are nearest by that.

References
----------
.. [EP08] Evangelidis and Psarakis, Parametric Image Alignment Using Enhanced Correlation
   Coefficient Maximization, PAMI 2008.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.probes import checked_probes
from harmface.recognition.spanned import SubspaceDistance
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

CANDIDATES = 10
"""Subjects that a probe is registered to, each on its own."""

ROUNDS = 2
"""Turns of fit and registration."""

STEPS = 10
"""Of the registration in a turn."""

SMOOTHING = 3
"""Pixels of the Gaussian window in front of gradients."""

LARGEST_SHIFT = 0.1
"""Of the image's height: a registration that ends beyond has failed."""

LARGEST_SCALE = 1.2
"""The same for enlargement and reduction."""

_CRITERIA = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, STEPS, 1e-4)


@dataclass(frozen=True)
class Motion:
    """How a probe lies against the frame of the gallery, about the middle of the image.

    Parameters
    ----------
    right, down
        Pixels by which the probe is shifted.
    rotation
        Degrees by which it is turned counterclockwise, as seen.
    scale
        How much larger it is.
    """

    right: float = 0.0
    down: float = 0.0
    rotation: float = 0.0
    scale: float = 1.0

    def matrix(self, shape: tuple[int, int]) -> Float[np.ndarray, "2 3"]:
        """Return the map from pixels (x, y) of the frame to those of the probe, in float32.

        Parameters
        ----------
        shape
            Rows and columns of the image.

        Returns
        -------
        numpy.ndarray
            Shape (2, 3), for coordinates from the middle of the first pixel.
        """
        cosine, sine = np.cos(np.radians(self.rotation)), np.sin(np.radians(self.rotation))
        linear = self.scale * np.array([[cosine, sine], [-sine, cosine]])
        shift = _middle(shape) - linear @ _middle(shape) + [self.right, self.down]
        return np.column_stack([linear, shift]).astype(np.float32)


def undone(image: Float[np.ndarray, "H W"], motion: Motion) -> Float[np.ndarray, "H W"]:
    """Return a probe as it would lie without its motion, its edges repeated, in float32.

    Parameters
    ----------
    image
        The probe, (rows, columns).
    motion
        How it lies.

    Returns
    -------
    numpy.ndarray
        Shape (rows, columns), in float32.
    """
    rows, columns = image.shape
    return cv2.warpAffine(
        image.astype(np.float32),
        motion.matrix(image.shape),
        (columns, rows),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )


def register(
    probe: Float[np.ndarray, "H W"],
    basis: Float[np.ndarray, "d p"],
    mask: Bool[np.ndarray, "H W"],
    start: Motion | None = None,
) -> Motion:
    """Return the motion of a probe against a subspace; `start` if none can be made out.

    Parameters
    ----------
    probe
        Linear photograph.
    basis
        Orthonormal rows over the pixels of the mask.
    mask
        Pixels of the frame that the subspace knows.
    start
        Where to look first, by default no motion.

    Returns
    -------
    Motion
        In pixels, degrees and as a ratio.

    Raises
    ------
    ArgumentError
        On NaN.
    """
    motion = start or Motion()
    probe = checks.finite("probe", probe).astype(np.float32)
    template, inside = np.zeros(mask.shape, np.float32), mask.astype(np.uint8)
    for _ in range(ROUNDS):
        pixels = undone(probe, motion)[mask]
        template[mask] = (basis @ pixels) @ basis
        try:
            _, matrix = cv2.findTransformECC(
                template,
                probe,
                motion.matrix(mask.shape),
                cv2.MOTION_AFFINE,
                _CRITERIA,
                inside,
                SMOOTHING,
            )
        except cv2.error:  # that is how it says that the images do not correlate
            break
        found = _similarity(matrix, mask.shape)
        if not _credible(found, mask.shape):
            break
        motion = found
    return motion


def registered_distances(
    probes: Float[np.ndarray, "n H W"],
    bases: Float[np.ndarray, "N d p"],
    mask: Bool[np.ndarray, "H W"],
    candidates: int = CANDIDATES,
) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
    """Return the distance of every registered probe to every subspace, and the probes' motions.

    Distances are the least of `subspace_distances` as the probe is, registered to what subjects
    have in common, and, for the few that are nearest by then, to the subject itself. Motions are
    those against the nearest subject.

    Parameters
    ----------
    probes
        Linear photographs; none may be all black where faces are.
    bases
        Orthonormal rows of each subject over the pixels of the mask.
    mask
        Pixels that take part.
    candidates
        Subjects that a probe is registered to, each on its own.

    Returns
    -------
    distances : numpy.ndarray
        Shape (n, N), in [0, 1], in float32.
    motions : list of Motion
        One for each probe.

    Raises
    ------
    ArgumentError
        On NaN, a black probe, or a mask that does not match.
    """
    _, dimension, pixels = bases.shape
    candidates = checks.positive_integer("candidates", candidates)
    if probes.shape[1:] != mask.shape or mask.sum() != pixels:
        raise ArgumentError(
            f"mask must be of the probes' size {probes.shape[1:]} and leave the {pixels} pixels of "
            f"bases, got {mask.shape} with {int(mask.sum())}"
        )
    checked_probes(probes[:, mask], pixels)
    bases = bases.astype(np.float32)
    common = orthonormal_basis(bases.reshape(1, -1, pixels), dimension)[0]
    motions = [register(probe, common, mask) for probe in probes]
    moved = np.stack([undone(*each)[mask] for each in zip(probes, motions, strict=True)])
    unmoved = subspace_distances(probes[:, mask].astype(np.float32), bases)
    distances = subspace_distances(moved, bases)
    for row, probe in enumerate(probes):
        start, closer = motions[row], distances[row] < unmoved[row]
        starts = [start if moving else Motion() for moving in closer]
        distances[row] = np.minimum(distances[row], unmoved[row])
        for subject in distances[row].argsort()[:candidates]:
            motion = register(probe, bases[subject], mask, starts[subject])
            aligned = undone(probe, motion)[mask][None]
            distance = subspace_distances(aligned, bases[subject][None])[0, 0]
            if distance < distances[row, subject]:
                distances[row, subject], starts[subject] = distance, motion
        motions[row] = starts[distances[row].argmin()]
    return distances, motions


def _similarity(matrix: Float[np.ndarray, "2 3"], shape: tuple[int, int]) -> Motion:
    """Return the similarity nearest to an affine map, the middle moving alike."""
    linear = matrix[:, :2].astype(np.float64)
    along, across = linear[0, 0] + linear[1, 1], linear[0, 1] - linear[1, 0]
    right, down = linear @ _middle(shape) + matrix[:, 2] - _middle(shape)
    rotation = np.degrees(np.arctan2(across, along))
    return Motion(float(right), float(down), float(rotation), float(np.hypot(along, across) / 2))


def _credible(motion: Motion, shape: tuple[int, int]) -> bool:
    # Written so that NaN fails too.
    near = np.hypot(motion.right, motion.down) <= LARGEST_SHIFT * shape[0]
    return bool(near and 1 / LARGEST_SCALE <= motion.scale <= LARGEST_SCALE)


def _middle(shape: tuple[int, int]) -> Float[np.ndarray, "2"]:
    return np.array([shape[1] - 1, shape[0] - 1]) / 2


@dataclass(frozen=True)
class RegisteredDistance(SubspaceDistance):
    """The `registered_distances`, for probes that are framed a little differently.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    dimension
        Greatest dimension of each subject's subspace.
    first
        Flat index of the first harmonic image.
    candidates
        Subjects that a probe is registered to, each on its own.
    """

    candidates: int = CANDIDATES

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every registered probe to every subject.

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
            Shape (n, N), in [0, 1].
        """
        return registered_distances(probes * mask, model["bases"], mask, self.candidates)[0]
