"""The command line run as a user would, in an empty folder, in this process."""

import re
from dataclasses import dataclass

import pytest

from harmface.cli import main
from harmface.reproduce import population


@dataclass
class Outcome:
    code: int
    out: str
    err: str


@pytest.fixture(scope="session")
def kept_people(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def few_people(monkeypatch, kept_people):
    """Procedural people to learn from: few and small, and none of the user's."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept_people))
    for name, value in (("PEOPLE", 8), ("SIZE", 64), ("LIGHTS", 20)):
        monkeypatch.setattr(population, name, value)


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
