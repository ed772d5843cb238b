"""Every claim that binds holds, measured from scratch."""

import pytest

from harmface.reproduce.claims import load_claims
from harmface.reproduce.registry import EXPERIMENTS

BINDING = [claim for claim in load_claims().values() if claim.binding]


@pytest.mark.parametrize("claim", BINDING, ids=lambda claim: claim.id)
def test_claim(claim):
    measured = EXPERIMENTS[claim.id]().values
    assert claim.holds(measured), f"{measured} against {claim.expected}"
