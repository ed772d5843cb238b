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


def pytest_terminal_summary(terminalreporter):
    """Say aloud what was not checked, where there is no browser to check it with."""
    skipped = [
        report
        for report in terminalreporter.stats.get("skipped", [])
        if "no browser" in str(report.longrepr)
    ]
    if skipped:
        terminalreporter.write_line(
            f"NOT CHECKED: {len(skipped)} tests of the viewer's page, for want of a browser: "
            "apt-get install chromium",
            red=True,
            bold=True,
        )
