"""What the tests of PCA share."""

import jaxtyping
import pytest


@pytest.fixture
def unchecked(monkeypatch):
    """Let arguments of any shape through to the guards, as they come without the test hook."""
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)
