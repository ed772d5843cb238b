import numpy as np
import pytest
from scipy.stats import binomtest, genpareto

from harmface.errors import ArgumentError
from harmface.recognition import margins, posteriors
from harmface.recognition.evaluation import (
    ErrorRate,
    bootstrap_interval,
    cumulative_match,
    errors_by_subset,
    independence,
    misnamed,
    receiver_operating,
    rejection_by_margin,
    relative_distances,
    reliability,
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


def test_no_error_does_not_mean_that_none_is_possible():
    """Against SciPy's interval of Clopper and Pearson."""
    none, subjects = np.zeros(545, bool), np.arange(545) % 10
    exact = binomtest(0, 545).proportion_ci(0.95, "exact")
    assert bootstrap_interval(none, subjects, 1) == pytest.approx((exact.low, exact.high))
    assert exact.high == pytest.approx(3.7 / 545, rel=0.01)
    low, high = bootstrap_interval(~none, subjects, 1)
    assert (low, high) == pytest.approx((1 - exact.high, 1))
    both = bootstrap_interval(none.astype(int), subjects, 1)
    assert both == pytest.approx((-exact.high, exact.high))


def test_the_same_seed_gives_the_same_interval():
    wrong = np.arange(50) % 3 == 0
    assert bootstrap_interval(wrong, np.arange(50), 7) == bootstrap_interval(
        wrong, np.arange(50), 7
    )


def test_relative_distance_is_to_the_nearest_other():
    found = relative_distances(DISTANCES)
    assert found[0] == pytest.approx([0.1 / 0.5, 0.5 / 0.1, 0.9 / 0.1])
    assert found.min(axis=1) == pytest.approx(1 - margins(DISTANCES))
    assert relative_distances(np.zeros((1, 2))).tolist() == [[1.0, 1.0]]


@pytest.mark.parametrize(("shape", "scale"), [(0.0, 0.05), (-0.3, 0.1)])
def test_the_tail_of_strangers_is_found_from_few_images(shape, scale):
    """Gaps come from a known distribution, distances spread over a decade by light."""
    rng, found = np.random.default_rng(4), []
    expected = -np.expm1(-genpareto.isf(0.01, shape, 0, scale))
    for _ in range(40):
        gaps = genpareto.rvs(shape, 0, scale, 200, random_state=rng)
        distances = np.stack([np.full(200, 0.01), np.exp(-gaps), np.ones(200), np.ones(200)], 1)
        lit = 10 ** rng.uniform(-1, 0, (200, 1))
        rejection = rejection_by_margin(lit * distances, np.zeros(200, int), 0.01)
        found.append(rejection.least_margin)
    assert (rejection.false_accept_rate, rejection.strangers) == (0.01, 200)
    # Likelihood estimates scatter; the mean of 40 does by a sixth of that.
    assert np.mean(found) == pytest.approx(expected, rel=0.06)


def test_reliability_counts_what_is_claimed_and_right():
    chances = np.array([[0.95, 0.05], [0.97, 0.03], [0.4, 0.6], [1.0, 0.0]])
    found = reliability(chances, np.array([0, 1, 1, 0]))
    assert found.count.tolist() == [0, 0, 0, 0, 0, 0, 1, 0, 0, 3]
    assert found.claimed[[6, 9]] == pytest.approx([0.6, (0.95 + 0.97 + 1) / 3])
    assert found.right[[6, 9]] == pytest.approx([1, 2 / 3])
    assert found.expected_error == pytest.approx((0.4 + 3 * abs(0.97333 - 2 / 3)) / 4, abs=1e-4)


def test_independence_is_found_again(rng):
    """Subjects are drawn from the posteriors of known strength: the likeliest strength is that."""
    count, strength = 3000, 12.0
    distances = rng.uniform(0.5, 1, (count, 5))
    chances = posteriors(distances, strength)
    truth = (chances.cumsum(axis=1) < rng.random((count, 1))).sum(axis=1)
    # The Fisher information of the exponent is the mean variance of log d under the posterior.
    logarithms = np.log(distances)
    mean = (chances * logarithms).sum(axis=1, keepdims=True)
    information = (chances * (logarithms - mean) ** 2).sum()
    assert independence(distances, truth) == pytest.approx(strength, abs=4 / np.sqrt(information))


def test_images_that_are_all_told_apart_do_not_make_certain():
    distances = np.where(np.eye(3) > 0, 0.1, 0.9)
    chances = posteriors(distances, independence(distances, np.arange(3)))
    assert np.diag(chances) == pytest.approx(4 / 5, abs=1e-3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: relative_distances(DISTANCES[:, :1]), "two subjects"),
        (lambda: relative_distances(-DISTANCES), "negative"),
        (lambda: rejection_by_margin(DISTANCES[:, :2], TRUTH * 0, 0.5), "three subjects"),
        (lambda: rejection_by_margin(DISTANCES, TRUTH, 0.0), "between 0 and 1"),
        (lambda: rejection_by_margin(DISTANCES, TRUTH, 0.5), "at least 10 images"),
        (lambda: independence(DISTANCES[:, :1], TRUTH * 0), "two subjects"),
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
