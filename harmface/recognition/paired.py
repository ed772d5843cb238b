"""Whether one recogniser does better than another on the same probes.

References
----------
.. [M47] McNemar, Note on the Sampling Error of the Difference between Correlated Proportions or
   Percentages, Psychometrika 1947.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Shaped
from scipy.stats import binomtest

from harmface.errors import ArgumentError
from harmface.recognition.evaluation import bootstrap_interval


@dataclass(frozen=True)
class Difference:
    """How the errors of two recognisers differ.

    Parameters
    ----------
    only_first, only_second
        Probes that the one misnamed and the other did not.
    rate
        Error rate of the first less that of the second.
    interval
        In which the difference of the rates lies with 95 % confidence, subjects being what chance
        draws.
    p_value
        Probability of errors as unequal as these, or more, were both equally good: McNemar's exact
        test, in which probes err independently of one another.
    """

    only_first: int
    only_second: int
    rate: float
    interval: tuple[float, float]
    p_value: float


def difference(
    first: Bool[np.ndarray, "n"],
    second: Bool[np.ndarray, "n"],
    truth: Shaped[np.ndarray, "n"],
    rng: np.random.Generator | int,
) -> Difference:
    """Compare two recognisers, probe by probe.

    Were both equally good, each probe that only one of them misnames would be as likely the one's
    error as the other's ([M47]_); the exact test is that of a fair coin, on both sides. The probes
    of a subject fail together, which the test takes no notice of, but the interval does.

    Parameters
    ----------
    first, second
        Which probes each misnamed.
    truth
        Subject of each probe.
    rng
        Generator or seed of the bootstrap.

    Returns
    -------
    Difference
        Counts, rates, interval and test.

    Raises
    ------
    ArgumentError
        If the probes are not the same in number, or there is none.

    Examples
    --------
    One probe is the first's error alone, and seven are the second's: 2 (1 + 8) / 2^8.

    >>> first, second = np.arange(8) < 1, np.arange(8) >= 1
    >>> difference(first, second, np.arange(8), 0).p_value
    0.0703125
    """
    if first.shape != second.shape:
        raise ArgumentError(
            f"second must be of the same {first.size} probes as first, got {second.size}"
        )
    apart = first.astype(np.int64) - second
    interval = bootstrap_interval(apart, truth, rng)
    alone = int((apart > 0).sum()), int((apart < 0).sum())
    p_value = binomtest(alone[0], sum(alone)).pvalue if any(alone) else 1.0
    return Difference(*alone, float(apart.mean()), interval, float(p_value))
