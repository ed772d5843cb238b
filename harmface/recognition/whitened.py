"""How light changes faces as a class, learned from other people, and what is left of it.

One photograph of a person does not tell what the person looks like under other light; other people
under several lights do. In the logarithm of a window (see `local_subspace`) a photograph is what is
its subject's own, plus what light makes of faces. The covariance `W` of the latter is the scatter
of other people's photographs about each person's mean ([MJP00]_, the intrapersonal space). Windows
are whitened by `(W + ridge)^(-1/2)`, in which all that light does is as likely in all directions,
and brought to norm 1 about the other people's mean: what light does to a window as a whole, strong
or weak, then plays no part. There a probe's window is compared with all mixtures of the subject's
own, see `ridge_rows`, by the cosine of the angle to the nearest: of one photograph that is the
photograph itself, of several the light between and beside theirs.

The ridge is the one under which people that were left out are most likely, so that it follows from
how many people there are and how alike they are. Windows of a probe are tried one step aside, too,
which absorbs small misalignment; each votes by its best position.

References
----------
.. [MJP00] Moghaddam, Jebara and Pentland, Bayesian Face Recognition, Pattern Recognition 2000.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import ArgumentError
from harmface.recognition.distance import Distance, Model
from harmface.recognition.gallery import PHOTOGRAPHS, RELIT, Gallery, Photographs
from harmface.recognition.local_subspace import (
    CONTRAST_NOISE,
    FLOOR_PER_NOISE,
    Windows,
    log_intensity,
    ridge_rows,
)

RIDGES = 10.0 ** np.arange(-4, 1.1, 0.5)
"""Ridges tried, as fractions of the mean eigenvalue of the covariance."""

FOLDS = 4
"""Parts of the other people, each left out once to tell the ridge."""

FEWEST_PEOPLE = 4
"""Other people that a covariance and its ridge can be told from, one of them left out."""

WINDOWS_PER_HEIGHT = 6
"""Heights of a window in the image. What light does to a small window has few dimensions, and a
shadow's edge spoils few of them; real and procedural faces agree on a sixth to an eighth."""

SMALLEST = 6
"""Rows of a window at least: of fewer pixels light's dimensions leave nothing."""

FLOOR = 0.05
"""Of full scale. In the logarithm what is dark varies most, by noise and by shadows' edges, and a
covariance tells ill what varies so unlike a Gaussian. Of procedural people, half learned from the
other half, the names are most likely, over one, seven and nine photographs, with about a tenth."""

CHUNK = 2**24
"""Projections held at a time: 64 MB in single precision."""


@dataclass(frozen=True)
class WhitenedDistance(Distance):
    """The mean over windows of `sqrt(1 - cosine)` to the nearest mixture, after whitening.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
    floor
        Added to intensities before the logarithm, as a fraction of full scale.
    """

    sources = (PHOTOGRAPHS, RELIT)
    learns = True
    positive_only = True
    floor: float = FLOOR

    def fit(self, gallery: Gallery) -> Model:
        """Return the mean and the whitening of every window, and what each subject's windows span.

        Parameters
        ----------
        gallery
            Who was enrolled, and `others` to learn from.

        Returns
        -------
        mapping of str to numpy.ndarray
            Of `m` pixels a window, `mean`, (windows, 1, m), `whitening`, (windows, m, m), and
            `spans`, (N, windows, rows, m); and the scalars `full_scale`, in the photographs'
            unit, and `moved`, the step aside in pixels.

        Raises
        ------
        ArgumentError
            If the gallery has no other people to learn from, or too few.
        """
        if gallery.others is None:
            raise ArgumentError(
                "the gallery must come with photographs of other people under several lights to "
                "learn from: `others` in Python, --learn-from on the command line"
            )
        windows = windows_of(gallery.mask)
        mean, whitening = self._learned(gallery.others, windows)
        each = gallery.spanning(self.source)
        full_scale = max(float(own.max()) for own in each)
        if full_scale <= 0:
            raise ArgumentError("images must not all be black")
        spans = []
        for own in each:
            cut = windows.cut(self._logarithms(own * gallery.mask / full_scale))
            spans.append(ridge_rows(_features(cut, mean, whitening), weakest=1.0))
        most = max(rows.shape[1] for rows in spans)
        return {
            "mean": mean,
            "whitening": whitening,
            "spans": np.stack(
                [np.pad(rows, ((0, 0), (0, most - rows.shape[1]), (0, 0))) for rows in spans]
            ),
            "full_scale": np.array(full_scale),
            "moved": np.array(0 if gallery.aligned else windows.shift),
        }

    def searched(self, model: Model) -> Model:
        """Return the model by which windows stay where they are.

        Parameters
        ----------
        model
            From `fit`.

        Returns
        -------
        mapping of str to numpy.ndarray
            Such as `distances` takes.
        """
        return {**model, "moved": np.array(0)}

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
            Shape (n, N), in [0, 1], in float32.
        """
        windows = windows_of(mask)
        logarithms = self._logarithms(probes * mask / float(model["full_scale"]))
        subjects, _, most, _ = model["spans"].shape
        found = np.empty((len(probes), subjects), np.float32)
        step = max(1, CHUNK // (subjects * most * len(windows.corners)))
        for start in range(0, len(probes), step):
            some = slice(start, start + step)
            explained = self._explained_energy(model, logarithms[some], windows)
            found[some] = np.sqrt(np.maximum(1 - np.sqrt(explained), 0)).mean(axis=0)
        return found

    def _logarithms(self, images: Float[np.ndarray, "n H W"]) -> Float[np.ndarray, "n H W"]:
        return log_intensity(images, self.floor / FLOOR_PER_NOISE)

    def _explained_energy(
        self, model: Model, logarithms: Float[np.ndarray, "n H W"], windows: Windows
    ) -> Float[np.ndarray, "J n N"]:
        """Return the share of every window that each subject's explain, in its best position."""
        step = int(model["moved"])
        moves = [(0, 0), (step, 0), (-step, 0), (0, step), (0, -step)] if step else [(0, 0)]
        subjects, count, most, pixels = model["spans"].shape
        spans = model["spans"].transpose(1, 3, 0, 2).reshape(count, pixels, subjects * most)
        best = np.zeros((count, len(logarithms), subjects), np.float32)
        for move in moves:
            cut = windows.cut(logarithms, move)
            features = _features(cut, model["mean"], model["whitening"])
            along = (features @ spans).reshape(count, -1, subjects, most)
            np.maximum(best, np.einsum("jnsd,jnsd->jns", along, along), out=best)
        return best

    def _learned(
        self, others: Photographs, windows: Windows
    ) -> tuple[Float[np.ndarray, "J 1 m"], Float[np.ndarray, "J m m"]]:
        """Return the mean of every window of other people, and its whitening."""
        names, which, counts = np.unique(others.subjects, return_inverse=True, return_counts=True)
        if len(names) < FEWEST_PEOPLE or counts.min() < 2:
            raise ArgumentError(
                f"others must be at least {FEWEST_PEOPLE} people with two photographs each to "
                f"learn from, got {len(names)} with {counts.min()} at least; give more"
            )
        scale = float(others.images.max())
        # Faces are as likely the other way round, and so is light.
        images = np.concatenate([others.images, others.images[..., ::-1]]) / scale
        which = np.concatenate([which, which])
        cut = windows.cut(self._logarithms(images)).astype(np.float64)
        people = [cut[:, which == person] for person in range(len(names))]
        mean = np.mean([own.mean(axis=1, keepdims=True) for own in people], axis=0)
        scatters = np.stack([_scatter(own) for own in people])
        ridge = likeliest_ridge(scatters)
        values, vectors = np.linalg.eigh(scatters.mean(axis=0))
        values = _variances(values, ridge)
        whitening = vectors / np.sqrt(values)[:, None]
        return mean.astype(np.float32), whitening.astype(np.float32)


def windows_of(mask: Bool[np.ndarray, "H W"]) -> Windows:
    """Return the windows of pictures of a size."""
    return Windows(mask, max(1, min(WINDOWS_PER_HEIGHT, mask.shape[0] // SMALLEST)))


def likeliest_ridge(scatters: Float[np.ndarray, "P J m m"]) -> float:
    """Return the ridge under which people who were left out are most likely.

    The log likelihood of a scatter `S` under a covariance `C` is `-(log det C + tr(S C^-1)) / 2` a
    photograph; it is summed over windows and people.

    Parameters
    ----------
    scatters
        Covariance of each person's windows about the person's mean.

    Returns
    -------
    float
        One of `RIDGES`, as a fraction of the mean eigenvalue of the people's mean scatter.
    """
    fold = np.arange(len(scatters)) % FOLDS
    surprise = np.zeros(len(RIDGES))
    for each in np.unique(fold):
        values, vectors = np.linalg.eigh(scatters[fold != each].mean(axis=0))
        left_out = scatters[fold == each].sum(axis=0)
        energy = ((left_out @ vectors) * vectors).sum(axis=1)
        people = (fold == each).sum()
        for number, ridge in enumerate(RIDGES):
            variances = _variances(values, ridge)
            surprise[number] += (people * np.log(variances) + energy / variances).sum()
    return float(RIDGES[surprise.argmin()])


def _variances(values: Float[np.ndarray, "J m"], ridge: float) -> Float[np.ndarray, "J m"]:
    """Return eigenvalues of a covariance and its ridge; none is less than the camera's noise."""
    return np.maximum(values, 0) + ridge * values.mean(axis=1, keepdims=True) + CONTRAST_NOISE**2


def _scatter(cut: Float[np.ndarray, "J n m"]) -> Float[np.ndarray, "J m m"]:
    centred = cut - cut.mean(axis=1, keepdims=True)
    return centred.swapaxes(1, 2) @ centred / centred.shape[1]


def _features(
    cut: Float[np.ndarray, "J n m"],
    mean: Float[np.ndarray, "J 1 m"],
    whitening: Float[np.ndarray, "J m m"],
) -> Float[np.ndarray, "J n m"]:
    """Return windows whitened and of norm 1."""
    white = (cut - mean) @ whitening
    norms = np.linalg.norm(white, axis=2, keepdims=True)
    return np.divide(white, norms, out=np.zeros_like(white), where=norms > 0)
