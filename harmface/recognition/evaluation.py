"""How well a recogniser does on probes whose subject is known."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer
from sklearn.metrics import roc_curve

from harmface import checks
from harmface.errors import ArgumentError

RESAMPLES = 2000
"""Bootstrap samples: the ends of a 95 % interval then rest on 50 of them each."""


@dataclass(frozen=True)
class ErrorRate:
    """Errors of rank-1 recognition on a set of probes.

    Parameters
    ----------
    errors
        Probes that were given another subject's name.
    probes
        All of them.
    """

    errors: int
    probes: int

    @property
    def rate(self) -> float:
        """Fraction of the probes that were misnamed."""
        return self.errors / self.probes


def misnamed(
    distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]
) -> Bool[np.ndarray, "n"]:
    """Return which probes are nearer to some other subject than to their own.

    Parameters
    ----------
    distances
        Of every probe to every subject.
    truth
        Column of each probe's subject.
    """
    distances, truth = _checked(distances, truth)
    return distances.argmin(axis=1) != truth


def errors_by_subset(
    distances: Float[np.ndarray, "n N"],
    truth: Integer[np.ndarray, "n"],
    subset: Integer[np.ndarray, "n"],
) -> dict[int, ErrorRate]:
    """Return the rank-1 errors of every subset of the probes, such as those of the Yale grid."""
    wrong = misnamed(distances, truth)
    if subset.shape != wrong.shape:
        raise ArgumentError(f"subset must number each of {wrong.size} probes, got {subset.shape}")
    return {
        int(each): ErrorRate(int(wrong[subset == each].sum()), int((subset == each).sum()))
        for each in np.unique(subset)
    }


def cumulative_match(
    distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]
) -> Float[np.ndarray, "N"]:
    """Return the CMC: the fraction of probes whose subject is among the nearest 1, 2, ..., N.

    Subjects as near as the probe's own count as nearer.
    """
    distances, truth = _checked(distances, truth)
    own = distances[np.arange(len(truth)), truth]
    rank = (distances <= own[:, None]).sum(axis=1)
    counts = np.bincount(rank - 1, minlength=distances.shape[1])
    return np.cumsum(counts) / len(truth)


def receiver_operating(
    distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "t"], Float[np.ndarray, "t"]]:
    """Return the ROC of verification: false-accept rates and the true-accept rates reached.

    Every pair of a probe and a subject is a claim, accepted if the distance is small enough.
    """
    distances, truth = _checked(distances, truth)
    genuine = np.arange(distances.shape[1]) == truth[:, None]
    false_accepts, true_accepts, _ = roc_curve(genuine.ravel(), -distances.ravel())
    return false_accepts, true_accepts


def bootstrap_interval(
    wrong: Bool[np.ndarray, "n"],
    truth: Integer[np.ndarray, "n"],
    rng: np.random.Generator | int,
    level: float = 0.95,
) -> tuple[float, float]:
    """Return the percentile interval of the error rate, subjects being what chance draws.

    Whole subjects are drawn with replacement, since the probes of one fail together.

    Parameters
    ----------
    wrong
        Which probes were misnamed.
    truth
        Subject of each probe.
    rng
        Generator or seed.
    level
        Coverage, in (0, 1).
    """
    rng = checks.generator(rng)
    if not 0 < level < 1:
        raise ArgumentError(f"level must lie between 0 and 1, got {level}")
    if wrong.shape != truth.shape or not wrong.size:
        raise ArgumentError(
            f"truth must name the subject of each of {wrong.size} probes, at least one, "
            f"got {truth.size}"
        )
    _, which = np.unique(truth, return_inverse=True)
    probes = np.bincount(which)
    errors = np.bincount(which, weights=wrong)
    drawn = rng.integers(len(probes), size=(RESAMPLES, len(probes)))
    rates = errors[drawn].sum(axis=1) / probes[drawn].sum(axis=1)
    low, high = np.quantile(rates, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def _checked(
    distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "n N"], Integer[np.ndarray, "n"]]:
    distances = checks.finite("distances", distances)
    if truth.shape != distances.shape[:1] or not truth.size:
        raise ArgumentError(
            f"truth must name the subject of each of {len(distances)} probes, at least one, "
            f"got {truth.size}"
        )
    if truth.min() < 0 or truth.max() >= distances.shape[1]:
        raise ArgumentError(
            f"truth must be columns of {distances.shape[1]} subjects, got {truth.min()} "
            f"to {truth.max()}"
        )
    return distances, truth
