from math import comb

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition.paired import difference


def wrong_alone(first, second, both=0, neither=0):
    """Return errors of two recognisers, so many of the one alone, the other, both and neither."""
    ours = np.repeat([True, False, True, False], [first, second, both, neither])
    theirs = np.repeat([False, True, True, False], [first, second, both, neither])
    return ours, theirs


@pytest.mark.parametrize(("first", "second"), [(1, 7), (7, 1), (0, 5), (4, 4), (2, 13)])
def test_p_is_the_tail_of_a_fair_coin_on_both_sides(first, second):
    # Errors and successes in common tell nothing.
    ours, theirs = wrong_alone(first, second, both=3, neither=40)
    found = difference(ours, theirs, np.arange(len(ours)), 0)
    count, fewer = first + second, min(first, second)
    tail = sum(comb(count, k) for k in range(fewer + 1)) / 2**count
    assert (found.only_first, found.only_second) == (first, second)
    assert found.p_value == pytest.approx(min(1.0, 2 * tail), rel=1e-12)
    assert found.rate == pytest.approx((first - second) / len(ours))


def test_equal_recognisers_do_not_differ():
    ours, _ = wrong_alone(0, 0, both=5, neither=20)
    found = difference(ours, ours, np.arange(25), 0)
    assert (found.p_value, found.rate) == (1.0, 0.0)
    # Either may still be wrong alone on another probe, see `bootstrap_interval`.
    assert found.interval == pytest.approx((0.025 ** (1 / 25) - 1, 1 - 0.025 ** (1 / 25)))


def test_the_interval_is_that_of_the_mean_over_subjects():
    # 200 subjects of 2 probes; in 60 the first is wrong alone, in 20 the second, on both probes.
    ours, theirs = (np.repeat(each, 2) for each in wrong_alone(60, 20, both=10, neither=110))
    found = difference(ours, theirs, np.repeat(np.arange(200), 2), 0)
    mean = (60 - 20) / 200
    deviation = np.sqrt(((60 + 20) / 200 - mean**2) / 200)
    # The ends scatter by about 1 / sqrt(50) of a deviation, see RESAMPLES, and lie on a grid.
    expected = mean + 1.96 * deviation * np.array([-1, 1])
    assert np.allclose(found.interval, expected, atol=0.2 * deviation)


@pytest.mark.usefixtures("unchecked")
def test_other_probes_are_refused():
    with pytest.raises(ArgumentError, match="the same 3 probes as first, got 2"):
        difference(np.ones(3, bool), np.ones(2, bool), np.arange(3), 0)
