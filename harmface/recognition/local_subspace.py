"""A robust distance: a subspace, and a light, for every window of the face.

Cast shadows, highlights and everything else that the images of a gallery do not span ruin a fit
of the whole image, but each of them ruins only some windows of it. So each window is fitted on
its own, and all windows vote alike:

* In the logarithm of `intensity + floor` light multiplies the albedo as a sum, and noise counts
  for little where the photograph is dark: the floor is three deviations of the camera's noise.
* A window's mean is taken off, and with it the light that falls on the window as a whole.
* What remains is fitted by a subject's images of that window. Where the framing is not exact
  they come with copies moved by a pixel in each direction, so the fit absorbs misalignment and
  expression by itself. It is a ridge regression: directions that the images hardly have cost
  what they are worth.
* The vote is the square root of the share of energy left over: a window spoilt by a shadow's edge
  or a highlight weighs little more than one that fits ill, and a window without contrast beyond
  the noise says nothing.

The constants are one setting for all galleries; lengths are fractions of the image's height.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import PHOTOGRAPHS, RELIT, Gallery
from harmface.recognition.subspace import orthonormal_basis, subspace_distances

FLOOR_PER_NOISE = 3
"""Deviations of the camera's noise that are added to the intensity."""

CONTRAST_NOISE = 0.03
"""Standard deviation of the logarithm that a window must exceed to say anything."""

RIDGE = 0.003
"""Ridge as a fraction of a window's largest eigenvalue."""

DIMENSION = 20
"""Dimension of a window's subspace: light, and the movement of the copies."""

WINDOWS_PER_HEIGHT = 4
"""Heights of a window in the image."""

SHIFTS_PER_HEIGHT = 48
"""Steps of the moved copies in the image's height."""

CHUNK = 2**25
"""Projections held at a time: 128 MB in single precision."""

WHOLE_POWER = 0.06
"""Power of the whole image's distance: enough to decide ties, too little to outvote windows that
a shadow leaves alone."""

WHOLE_DIMENSION = 9
"""Dimension of the whole image's subspace, that of the light."""


@dataclass(frozen=True)
class Windows:
    """Square windows that cover an image, neighbours overlapping by half.

    Parameters
    ----------
    mask
        Pixels that take part; windows with less than half of theirs are left out.
    per_height
        Heights of a window in the image; neighbours overlap by half.

    Raises
    ------
    ArgumentError
        If no window remains.
    """

    mask: Bool[np.ndarray, "H W"]
    per_height: int = WINDOWS_PER_HEIGHT

    def __post_init__(self) -> None:
        if not self.corners:
            raise ArgumentError("mask must fill half of some window, but leaves none; widen it")

    @property
    def side(self) -> tuple[int, int]:
        """Rows and columns of a window."""
        rows, columns = self.mask.shape
        side = max(2, round(rows / self.per_height))
        return min(side, rows), min(max(side, 2), columns)

    @property
    def shift(self) -> int:
        """Pixels by which copies are moved."""
        return max(1, round(self.mask.shape[0] / SHIFTS_PER_HEIGHT))

    @cached_property
    def corners(self) -> list[tuple[int, int]]:
        """Top left pixel of every window."""
        (high, wide), (rows, columns) = self.side, self.mask.shape
        return [
            (top, left)
            for top in _starts(rows, high)
            for left in _starts(columns, wide)
            if self.mask[top : top + high, left : left + wide].mean() >= 0.5
        ]

    @cached_property
    def _inside(self) -> Bool[np.ndarray, "J 1 m"]:
        high, wide = self.side
        every = np.lib.stride_tricks.sliding_window_view(self.mask, (high, wide))
        return every[tuple(np.array(self.corners).T)].reshape(len(self.corners), 1, -1)

    def cut(
        self, images: Float[np.ndarray, "n H W"], offset: tuple[int, int] = (0, 0)
    ) -> Float[np.ndarray, "J n m"]:
        """Return every window of the images less its mean; pixels outside the mask are zero.

        Parameters
        ----------
        images
            Of the mask's size.
        offset
            Rows and columns by which the images are moved first, their edges repeated.

        Returns
        -------
        numpy.ndarray
            Shape (windows, n, pixels of a window).
        """
        high, wide = self.side
        by = max(abs(value) for value in offset)
        padded = np.pad(images, ((0, 0), (by, by), (by, by)), mode="edge") if by else images
        down, right = by - offset[0], by - offset[1]
        corners = np.array(self.corners)
        top, left = (corners + np.array([down, right])).T
        every = np.lib.stride_tricks.sliding_window_view(padded, (high, wide), axis=(1, 2))
        cut = every[:, top, left].swapaxes(0, 1).reshape(len(corners), len(images), -1)
        inside = self._inside.astype(images.dtype)
        mean = (cut * inside).sum(axis=-1, keepdims=True) / inside.sum(axis=-1, keepdims=True)
        return (cut - mean) * inside


def log_intensity(images: Float[np.ndarray, "*n H W"], noise: float) -> Float[np.ndarray, "*n H W"]:
    """Return `log(I + 3 noise)` in single precision.

    Parameters
    ----------
    images
        Linear photographs, nowhere negative.
    noise
        Standard deviation of the camera's noise in the dark, in the images' unit.

    Returns
    -------
    numpy.ndarray
        Shape of the images, in float32.

    Raises
    ------
    ArgumentError
        On NaN, a negative pixel, or a noise that is not above 0.
    """
    images = checks.non_negative("images", images)
    if not (np.isfinite(noise) and noise > 0):
        raise ArgumentError(f"noise must be above 0, got {noise}: 0.005 of full scale is usual")
    return np.log(images.astype(np.float32) + np.float32(FLOOR_PER_NOISE * noise))


def local_basis(
    logarithms: Float[np.ndarray, "g H W"], windows: Windows, aligned: bool = False
) -> Float[np.ndarray, "J d m"]:
    """Return a subject's subspace of every window, its rows scaled for ridge regression.

    See `ridge_rows`.

    Parameters
    ----------
    logarithms
        The subject's photographs, see `log_intensity`; one is enough.
    windows
        Where the windows are.
    aligned
        Whether probes are framed exactly as these images: then no moved copies join in.

    Returns
    -------
    numpy.ndarray
        Shape (windows, `DIMENSION`, pixels of a window), in float32; rows of zeros fill up.
    """
    step = windows.shift
    moves = [(0, 0)] if aligned else [(0, 0), (step, 0), (-step, 0), (0, step), (0, -step)]
    cut = np.concatenate([windows.cut(logarithms, move) for move in moves], axis=1)
    rows = ridge_rows(cut, cut.shape[-1] * CONTRAST_NOISE**2)
    missing = DIMENSION - rows.shape[1]
    return np.pad(rows, ((0, 0), (0, missing), (0, 0)))


def ridge_rows(
    vectors: Float[np.ndarray, "J n m"], weakest: float = 0.0
) -> Float[np.ndarray, "J d m"]:
    """Return rows that tell how much of a vector a ridge regression on others explains.

    With the vectors `A`, of singular values `s_i` and right singular vectors `v_i`, the least
    `|x - A^T c|^2 + lambda |c|^2` over `c` is `|x|^2 - sum_i (b_i . x)^2` with rows
    `b_i = v_i s_i / sqrt(s_i^2 + lambda)`. They are the rows returned, the strongest first.

    Parameters
    ----------
    vectors
        What is regressed on, in each of several windows.
    weakest
        Energy of vectors that are no more than noise.

    Returns
    -------
    numpy.ndarray
        As many rows as there are vectors, `DIMENSION` at most, in single precision.
    """
    vectors = vectors.astype(np.float64)
    # The eigenvectors of the small matrix of inner products give the singular vectors.
    energy, mixing = np.linalg.eigh(vectors @ vectors.swapaxes(1, 2))
    energy, mixing = energy[:, ::-1][:, :DIMENSION], mixing[:, :, ::-1][:, :, :DIMENSION]
    ridge = RIDGE * np.maximum(energy[:, :1], weakest)
    scale = 1 / np.sqrt(np.maximum(energy, 0) + ridge)
    rows = (mixing * scale[:, None]).swapaxes(1, 2) @ vectors
    return rows.astype(np.float32)


def local_distances(
    logarithms: Float[np.ndarray, "n H W"],
    bases: Float[np.ndarray, "N J d m"],
    windows: Windows,
) -> Float[np.ndarray, "n N"]:
    """Return the mean over the windows of the share of contrast that a subject does not explain.

    The share is `sqrt((residual + noise) / (energy + noise))`, in [0, 1], with the residual of
    `local_basis` and the energy of the window itself.

    Parameters
    ----------
    logarithms
        Probes, see `log_intensity`.
    bases
        Each subject's `local_basis`.
    windows
        Where the windows are.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), in [0, 1], in float32.
    """
    cut = windows.cut(logarithms)
    total = np.zeros((len(logarithms), len(bases)), np.float32)
    noise = np.float32(cut.shape[-1] * CONTRAST_NOISE**2)
    step = max(1, CHUNK // max(1, len(bases) * DIMENSION))
    for index, window in enumerate(cut):
        rows = np.ascontiguousarray(bases[:, index]).reshape(-1, cut.shape[-1])
        energy = np.einsum("nm,nm->n", window, window)[:, None]
        for first in range(0, len(window), step):
            some = slice(first, first + step)
            fits = (window[some] @ rows.T).reshape(-1, len(bases), DIMENSION)
            residual = np.maximum(energy[some] - np.einsum("nsd,nsd->ns", fits, fits), 0)
            total[some] += np.sqrt((residual + noise) / (energy[some] + noise))
    return total / np.float32(len(cut))


@dataclass(frozen=True)
class LocalDistance(Distance):
    """The `local_distances`, times a low power of `subspace_distances` of the whole image.

    The method of choice for photographs under extreme light: nine photographs a subject under
    the nine points of light, or a handful of frontal ones. Where the whole image fits well it
    decides between subjects whose windows look alike. Probes must be in the unit of the gallery,
    whose greatest value counts as the camera's full scale.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    noise
        Standard deviation of the camera's noise in the dark, as a fraction of full scale.
    """

    sources = (PHOTOGRAPHS, RELIT)
    positive_only = True
    noise: float = 0.005

    def fit(self, gallery: Gallery) -> Model:
        """Return each subject's `local_basis` and that of its whole images, and the full scale.

        One photograph of a subject is enough.

        Parameters
        ----------
        gallery
            Who was enrolled.

        Returns
        -------
        mapping of str to numpy.ndarray
            `bases`, (N, windows, `DIMENSION`, pixels of a window); `whole`, (N, `WHOLE_DIMENSION`,
            pixels of the mask); and the scalar `full_scale` in the photographs' unit.

        Raises
        ------
        ArgumentError
            If a photograph is negative or all are black, or the mask fills no window.
        """
        windows = Windows(gallery.mask)
        each = [own * gallery.mask for own in gallery.spanning(self.source)]
        full_scale = max(float(checks.non_negative("images", own).max()) for own in each)
        if full_scale == 0:
            raise ArgumentError("images must not all be black")
        logarithms = [log_intensity(own / full_scale, self.noise) for own in each]
        bases = [local_basis(own, windows, gallery.aligned) for own in logarithms]
        whole = [_whole_basis(own[:, gallery.mask]) for own in each]
        return {
            "bases": np.stack(bases),
            "whole": np.stack(whole),
            "full_scale": np.array(full_scale),
        }

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the distance of every probe to every subject, in [0, 1].

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
            Shape (n, N), in [0, 1], subjects in the order of `Gallery.names`.

        Raises
        ------
        ArgumentError
            If a probe is negative, or has the same value everywhere.
        """
        seen = probes[:, mask]
        flat = np.flatnonzero(seen.max(axis=1) == seen.min(axis=1))
        if flat.size:
            raise ArgumentError(
                f"probes must show something, but {flat.size} of {len(probes)} have the same value "
                f"everywhere (first: number {flat[0]})"
            )
        logarithms = log_intensity(probes * mask / float(model["full_scale"]), self.noise)
        local = local_distances(logarithms, model["bases"], Windows(mask))
        whole = subspace_distances(seen.astype(np.float32), model["whole"])
        return local * whole**WHOLE_POWER


def _whole_basis(images: Float[np.ndarray, "g p"]) -> Float[np.ndarray, "d p"]:
    """Return orthonormal rows of a subject's images, zeros where it has fewer than others."""
    basis = orthonormal_basis(images, min(len(images), WHOLE_DIMENSION)).astype(np.float32)
    return np.pad(basis, ((0, WHOLE_DIMENSION - len(basis)), (0, 0)))


def _starts(length: int, side: int) -> list[int]:
    """Return where windows start along an axis: every half side, the last at the far end."""
    step = max(1, side // 2)
    return sorted({*range(0, length - side + 1, step), length - side})
