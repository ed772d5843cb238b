import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition.evaluation import (
    ErrorRate,
    bootstrap_interval,
    cumulative_match,
    errors_by_subset,
    misnamed,
    receiver_operating,
)

DISTANCES = np.array([[0.1, 0.5, 0.9], [0.4, 0.2, 0.3], [0.1, 0.2, 0.3], [0.6, 0.5, 0.4]])
TRUTH = np.array([0, 2, 2, 2])


def test_errors_are_counted_by_subset():
    assert misnamed(DISTANCES, TRUTH).tolist() == [False, True, True, False]
    found = errors_by_subset(DISTANCES, TRUTH, np.array([1, 1, 5, 5]))
    assert found == {1: ErrorRate(1, 2), 5: ErrorRate(1, 2)}
    assert found[1].rate == 0.5


def test_cumulative_match_counts_ranks():
    # Their own subjects stand at ranks 1, 2, 3 and 1.
    assert cumulative_match(DISTANCES, TRUTH).tolist() == [0.5, 0.75, 1.0]


def test_a_tie_counts_against_the_probe():
    assert cumulative_match(np.ones((1, 2)), np.array([0])).tolist() == [0.0, 1.0]


def test_receiver_operating_curve_accepts_pairs_by_distance():
    false_accepts, true_accepts = receiver_operating(DISTANCES, TRUTH)
    genuine = DISTANCES[np.arange(4), TRUTH]
    impostor = DISTANCES[np.arange(3) != TRUTH[:, None]]
    for threshold in np.unique(DISTANCES):
        point = (impostor <= threshold).mean(), (genuine <= threshold).mean()
        on_curve = np.interp(point[0], false_accepts, true_accepts)
        assert on_curve >= point[1] - 1e-12
    assert false_accepts[0] == true_accepts[0] == 0
    assert false_accepts[-1] == true_accepts[-1] == 1


def test_interval_of_independent_probes_is_the_binomial_one(rng):
    wrong = np.arange(400) < 40
    low, high = bootstrap_interval(wrong, np.arange(400), rng)
    # 10 % give or take 1.96 sqrt(0.1 0.9 / 400); 2,000 resamples tell its ends to a tenth of that.
    assert low == pytest.approx(0.1 - 0.0294, abs=0.005)
    assert high == pytest.approx(0.1 + 0.0294, abs=0.005)


def test_interval_is_wider_where_probes_of_a_subject_fail_together():
    wrong = np.arange(400) < 40
    together = bootstrap_interval(wrong, np.arange(400) // 40, 1)
    apart = bootstrap_interval(wrong, np.arange(400), 1)
    assert together[1] - together[0] > 2 * (apart[1] - apart[0])


def test_the_same_seed_gives_the_same_interval():
    wrong = np.arange(50) % 3 == 0
    assert bootstrap_interval(wrong, np.arange(50), 7) == bootstrap_interval(
        wrong, np.arange(50), 7
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: misnamed(DISTANCES, TRUTH[:3]), "each of 4 probes"),
        (lambda: misnamed(DISTANCES, TRUTH + 1), "columns of 3 subjects"),
        (lambda: misnamed(DISTANCES * np.nan, TRUTH), "finite"),
        (lambda: errors_by_subset(DISTANCES, TRUTH, TRUTH[:2]), "each of 4 probes"),
        (lambda: bootstrap_interval(np.ones(3, bool), np.arange(2), 1), "each of 3 probes"),
        (lambda: bootstrap_interval(np.ones(3, bool), np.arange(3), 1, 1.0), "between 0 and 1"),
        (lambda: bootstrap_interval(np.ones(3, bool), np.arange(3), -1), "rng"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
