"""The command line run as a user would, in an empty folder, in this process."""

import re
from dataclasses import dataclass

import pytest

from harmface.cli import main


@dataclass
class Outcome:
    code: int
    out: str
    err: str


@pytest.fixture
def run(tmp_path, monkeypatch, capfd):
    """Run `harmface ...` in an empty folder; returns exit code and output."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments) -> Outcome:
        with pytest.raises(SystemExit) as stop:
            main([str(argument) for argument in arguments])
        return Outcome(stop.value.code, *capfd.readouterr())

    return call


@pytest.fixture
def check_refused(run, tmp_path):
    """Check that a command is refused in one line that matches, with nothing written."""

    def check(pattern, *arguments):
        before = sorted(tmp_path.rglob("*"))
        outcome = run(*arguments)
        assert outcome.code == 2
        assert outcome.out == ""
        assert outcome.err.count("\n") == 1, outcome.err
        assert re.search(pattern, outcome.err), outcome.err
        assert sorted(tmp_path.rglob("*")) == before

    return check
