"""Every claim that binds holds, measured from scratch."""

import pytest

from harmface.reproduce.claims import load_claims
from harmface.reproduce.registry import EXPERIMENTS

TIMED = {"prefilter-speed"}
"""Claims on speed: a busy machine must not fail a test; `harmface reproduce` judges them."""

BINDING = [c for c in load_claims().values() if c.binding and c.id not in TIMED]


@pytest.mark.parametrize("claim", BINDING, ids=lambda claim: claim.id)
def test_claim(claim):
    measured = EXPERIMENTS[claim.id]().values
    assert claim.holds(measured), f"{measured} against {claim.expected}"
