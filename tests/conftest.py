"""Shapes and types of every public function are checked while the tests run."""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from jaxtyping import config, install_import_hook

install_import_hook("harmface", "typechecking.check")

settings.register_profile(
    "harmface",
    derandomize=True,
    deadline=None,
    max_examples=25,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("harmface")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240711)


@pytest.fixture
def unchecked(monkeypatch):
    """Leave shapes to the guards alone, as outside the tests."""
    monkeypatch.setattr(config, "jaxtyping_disable", True)


@pytest.fixture
def terminal():
    """Return a device that is lost with the test, if what ought to spare it does not."""
    ends = os.openpty()
    yield Path(os.ttyname(ends[1]))
    for end in ends:
        os.close(end)
