"""How well a recogniser does on probes whose subject is known.

References
----------
.. [CP34] Clopper and Pearson, The Use of Confidence or Fiducial Limits Illustrated in the Case of
   the Binomial, Biometrika 1934.
.. [P75] Pickands, Statistical Inference Using Extreme Order Statistics, Annals of Statistics 1975.
.. [P99] Platt, Probabilistic Outputs for Support Vector Machines, 1999.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer, Shaped
from scipy.optimize import minimize_scalar
from scipy.special import logsumexp
from scipy.stats import genpareto
from sklearn.metrics import roc_curve

from harmface import checks
from harmface.errors import ArgumentError

RESAMPLES = 2000
"""Bootstrap samples: the ends of a 95 % interval then rest on 50 of them each."""

FEWEST_STRANGERS = 10
"""Images that two parameters of a distribution can be fitted to."""

MOST_PIXELS = 1e6
"""Most pixels that can err independently: those of an image of a thousand by a thousand."""


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


def spread(count: int, most: int) -> Integer[np.ndarray, "_"]:
    """Return at most so many of the indices 0 to `count - 1`, evenly spread.

    Parameters
    ----------
    count
        How many indices there are, at least 1.
    most
        How many are wanted, at least 1.

    Returns
    -------
    numpy.ndarray
        Shape (min(count, most),), ascending, in int64.

    Examples
    --------
    >>> spread(9, 3).tolist(), spread(2, 3).tolist()
    ([0, 4, 8], [0, 1])
    """
    return np.linspace(0, count - 1, min(count, most)).astype(np.int64)


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

    Returns
    -------
    numpy.ndarray
        Shape (n,), boolean.
    """
    distances, truth = _checked(distances, truth)
    return distances.argmin(axis=1) != truth


def errors_by_subset(
    distances: Float[np.ndarray, "n N"],
    truth: Integer[np.ndarray, "n"],
    subset: Integer[np.ndarray, "n"],
) -> dict[int, ErrorRate]:
    """Return the rank-1 errors of every subset of the probes, such as those of the Yale grid.

    Parameters
    ----------
    distances
        Of every probe to every subject, (n, N).
    truth
        Column of each probe's subject.
    subset
        Number of each probe's subset.

    Returns
    -------
    dict of int to ErrorRate
        By the number of the subset.

    Raises
    ------
    ArgumentError
        If probes, truth and subset differ in number.
    """
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

    Parameters
    ----------
    distances
        Of every probe to every subject, (n, N).
    truth
        Column of each probe's subject.

    Returns
    -------
    numpy.ndarray
        Shape (N,), ascending to 1.
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

    Parameters
    ----------
    distances
        Of every probe to every subject, (n, N).
    truth
        Column of each probe's subject.

    Returns
    -------
    false_accepts : numpy.ndarray
        Shape (t,), ascending from 0 to 1.
    true_accepts : numpy.ndarray
        Shape (t,), ascending from 0 to 1.
    """
    distances, truth = _checked(distances, truth)
    genuine = np.arange(distances.shape[1]) == truth[:, None]
    false_accepts, true_accepts, _ = roc_curve(genuine.ravel(), -distances.ravel())
    return false_accepts, true_accepts


def relative_distances(distances: Float[np.ndarray, "n N"]) -> Float[np.ndarray, "n N"]:
    """Return each distance over the least of the probe to any other subject.

    Hard light makes a probe far from everybody; who is near in comparison is told as well as in
    easy light. Of the nearest subject it is 1 less the margin of `margins`. False accepts by it
    are of people who are enrolled under another name; of strangers see `rejection_by_margin`.

    Parameters
    ----------
    distances
        Of every probe to every subject, (n, N), at least 0.

    Returns
    -------
    numpy.ndarray
        Shape (n, N), at least 0; below 1 for one subject of a probe at most.

    Raises
    ------
    ArgumentError
        If there are fewer than two subjects.
    """
    distances = checks.non_negative("distances", distances)
    if distances.shape[1] < 2:
        raise ArgumentError(
            f"distances must be to at least two subjects, got {distances.shape[1]}; enroll more"
        )
    first, second = np.partition(distances, 1, axis=1)[:, :2].T[..., None]
    others = np.where(distances == first, second, first)
    # With a tie at 0 nobody is nearer than another.
    return np.divide(distances, others, out=np.ones_like(distances), where=others > 0)


def bootstrap_interval(
    wrong: Bool[np.ndarray, "n"] | Integer[np.ndarray, "n"],
    truth: Shaped[np.ndarray, "n"],
    rng: np.random.Generator | int,
    level: float = 0.95,
) -> tuple[float, float]:
    """Return the percentile interval of the error rate, subjects being what chance draws.

    Whole subjects are drawn with replacement, since the probes of one fail together. Where no probe
    failed, or all did, every draw is alike and tells nothing; the interval is then the exact one of
    a binomial share ([CP34]_), which takes probes for independent: 0 of `n` errors may still be a
    rate of `1 - ((1 - level) / 2)^(1 / n)`. It is too narrow if probes of a subject fail together.

    Parameters
    ----------
    wrong
        Which probes were misnamed, boolean; or how many errors more each is than in another method:
        1, 0 or -1. Of these, none at all gives the same bound to both sides.
    truth
        Subject of each probe.
    rng
        Generator or seed.
    level
        Coverage, in (0, 1).

    Returns
    -------
    low : float
        Lower end, as a fraction.
    high : float
        Upper end, as a fraction.

    Raises
    ------
    ArgumentError
        If the level is not in (0, 1), or there is not a subject for each probe.
    """
    rng = checks.generator(rng)
    if not 0 < level < 1:
        raise ArgumentError(f"level must lie between 0 and 1, got {level}")
    if wrong.shape != truth.shape or not wrong.size:
        raise ArgumentError(
            f"truth must name the subject of each of {wrong.size} probes, at least one, "
            f"got {truth.size}"
        )
    if not wrong.any() or (wrong.dtype == bool and wrong.all()):
        most = 1 - ((1 - level) / 2) ** (1 / wrong.size)
        if wrong.dtype != bool:
            return -most, most
        return (1 - most, 1.0) if wrong[0] else (0.0, most)
    _, which = np.unique(truth, return_inverse=True)
    probes = np.bincount(which)
    errors = np.bincount(which, weights=wrong)
    drawn = rng.integers(len(probes), size=(RESAMPLES, len(probes)))
    rates = errors[drawn].sum(axis=1) / probes[drawn].sum(axis=1)
    low, high = np.quantile(rates, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def independence(distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]) -> float:
    """Return how many pixels err independently, as images of known subjects tell.

    It is the exponent with which `posteriors` makes the names of these images most likely. Names
    are believed to `(n + 1) / (n + 2)` only, as [P99]_ does, so that a few images that are all
    told apart do not make it infinite.

    Parameters
    ----------
    distances
        Of every image to every subject.
    truth
        Column of each image's subject.

    Returns
    -------
    float
        From 0 to `MOST_PIXELS`.

    Raises
    ------
    ArgumentError
        If there are fewer than two subjects.
    """
    distances, truth = _checked(distances, truth)
    count, subjects = distances.shape
    if subjects < 2:
        raise ArgumentError(f"distances must be to at least two subjects, got {subjects}")
    logarithms = np.log(np.maximum(distances, np.finfo(distances.dtype).tiny)).astype(np.float64)
    belief = np.full(distances.shape, 1 / (count + 2) / (subjects - 1))
    belief[np.arange(count), truth] = (count + 1) / (count + 2)
    expected = (belief * logarithms).sum()

    def surprise(exponent: float) -> float:
        return exponent * expected + logsumexp(-exponent * logarithms, axis=1).sum()

    return float(minimize_scalar(surprise, bounds=(0, MOST_PIXELS), method="bounded").x)


@dataclass(frozen=True)
class Rejection:
    """Where to stop believing that a probe is of an enrolled subject.

    Parameters
    ----------
    least_margin
        Margin, see `margins`, below which a probe is taken for a stranger's.
    false_accept_rate
        Share of strangers that are expected to exceed it.
    strangers
        Number of images that the estimate rests on.
    """

    least_margin: float
    false_accept_rate: float
    strangers: int


def rejection_by_margin(
    distances: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"], rate: float = 0.01
) -> Rejection:
    """Return how much nearer the first subject must be than the second for a probe to be known.

    Every image plays a stranger to all subjects but its own. What counts is the logarithm of the
    ratio of its two least distances to the others: unlike the distance it is much the same in all
    light. As a gap between extremes it follows a generalised Pareto distribution from 0
    ([P75]_), which is fitted, so that a small rate does not rest on one or two images.

    Parameters
    ----------
    distances
        Distances of images of enrolled subjects, such as the gallery's, to all subjects.
    truth
        Column of each image's own subject.
    rate
        Wanted false-accept rate, in (0, 1).

    Returns
    -------
    Rejection
        The least margin, and what it rests on.

    Raises
    ------
    ArgumentError
        If there are fewer than three subjects (one to be, and two to be mistaken for), or too few
        images for a fit.
    """
    distances, truth = _checked(distances, truth)
    if not 0 < rate < 1:
        raise ArgumentError(f"rate must lie between 0 and 1, got {rate}")
    if distances.shape[1] < 3:
        raise ArgumentError(
            f"distances must be to at least three subjects, got {distances.shape[1]}; enroll more"
        )
    if len(truth) < FEWEST_STRANGERS:
        raise ArgumentError(
            f"distances must be of at least {FEWEST_STRANGERS} images to tell strangers, got "
            f"{len(truth)}; enroll more"
        )
    others = np.arange(distances.shape[1]) != truth[:, None]
    ratios = relative_distances(distances[others].reshape(len(truth), -1)).min(axis=1)
    gaps = -np.log(np.maximum(ratios, np.finfo(ratios.dtype).tiny)).astype(np.float64)
    shape, _, scale = genpareto.fit(gaps, floc=0)
    least_margin = -np.expm1(-genpareto.isf(rate, shape, 0, scale))
    return Rejection(float(least_margin), rate, len(truth))


@dataclass(frozen=True, eq=False)
class Reliability:
    """Whether probabilities are what they say.

    Parameters
    ----------
    claimed, right, count
        Of the answers in each tenth of the range of probabilities: the mean probability, the share
        that is right (both 0 where there are none), and how many there are.
    """

    claimed: Float[np.ndarray, "10"]
    right: Float[np.ndarray, "10"]
    count: Integer[np.ndarray, "10"]

    @property
    def expected_error(self) -> float:
        """Mean difference between what is claimed and what is right, over all answers."""
        return float(np.abs(self.claimed - self.right) @ self.count / self.count.sum())


def reliability(
    probabilities: Float[np.ndarray, "n N"], truth: Integer[np.ndarray, "n"]
) -> Reliability:
    """Return how often the likeliest subject is right, by its probability.

    Parameters
    ----------
    probabilities
        Of every subject for every probe.
    truth
        Column of each probe's subject.

    Returns
    -------
    Reliability
        Claims and shares in tenths.
    """
    probabilities, truth = _checked(probabilities, truth)
    top = probabilities.max(axis=1)
    which = np.minimum((10 * top).astype(int), 9)
    count = np.bincount(which, minlength=10)
    sums = [
        np.bincount(which, weights=each, minlength=10)
        for each in (top, probabilities.argmax(axis=1) == truth)
    ]
    claimed, right = (total / np.maximum(count, 1) for total in sums)
    return Reliability(claimed, right, count)


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
