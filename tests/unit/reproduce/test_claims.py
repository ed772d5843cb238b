from dataclasses import replace

import pytest

from harmface.errors import ArgumentError
from harmface.reproduce.claims import Claim, load_claims
from harmface.reproduce.registry import EXPERIMENTS

CLAIM = Claim("c", "source", "what", [1.0, 2.0], "equal", [0.1])


def test_every_claim_has_an_experiment_and_the_reverse():
    assert list(load_claims()) == list(EXPERIMENTS)


@pytest.mark.parametrize(
    ("kind", "measured", "holds"),
    [
        ("equal", [1.05, 1.95], True),
        ("equal", [1.05, 2.15], False),
        ("at_most", [1.0, 1.5], True),
        ("at_most", [1.0, 2.1], False),
        ("at_least", [1.0, 2.5], True),
        ("at_least", [0.9, 2.5], False),
        ("goal", [0.9, 2.0], True),
        ("goal", [1.1, 2.0], False),
        ("report", [9.0, 9.0], None),
        ("equal", [float("nan"), 2.0], False),
    ],
)
def test_verdicts(kind, measured, holds):
    assert replace(CLAIM, kind=kind).holds(measured) is holds


def test_each_value_may_have_its_own_tolerance():
    claim = replace(CLAIM, tolerance=[0.1, 0.5])
    assert claim.holds([1.0, 2.4])
    assert not claim.holds([1.4, 2.0])


def test_words_are_shown_and_not_judged():
    assert replace(CLAIM, expected="an order").holds([1.0]) is None


def test_only_bounds_can_fail_a_run():
    assert CLAIM.binding
    assert not replace(CLAIM, kind="goal").binding
    assert not replace(CLAIM, kind="report").binding


def test_a_wrong_number_of_values_is_refused():
    with pytest.raises(ArgumentError, match="expects 2 values, got 1"):
        CLAIM.holds([1.0])
