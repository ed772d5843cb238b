"""What all commands share: help, quiet, verbose, version; what one writes another reads."""

import json
import logging

import numpy as np
import pytest
from typer.main import get_command

import harmface
from harmface.cli import app


def commands(group=None, path=()):
    """Yield the words of every command."""
    for name, command in (group or get_command(app)).commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, (*path, name))
        else:
            yield (*path, name)


COMMANDS = list(commands())


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_fits_80_columns_and_shows_an_example(run, words, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    outcome = run(*words, "--help")
    assert outcome.code == 0
    lines = outcome.out.splitlines()
    assert max(map(len, lines)) <= 80
    assert len(lines) <= 75
    assert "<bool>" not in outcome.out
    assert any(line.strip().startswith(("Example: harmface", "Examples:")) for line in lines)


def test_the_version_is_the_package_s(run):
    assert run("--version").out == f"{harmface.__version__}\n"


def test_quiet_leaves_errors_and_json(run, tmp_path):
    loud = run("synth", "shapes", "--out", "a")
    assert loud.out.startswith("shapes in")
    assert run("synth", "shapes", "--out", "b", "--quiet").out == ""
    outcome = run("--quiet", "reproduce", "--only", "energy-by-degree", "--out", "r")
    assert (outcome.code, outcome.out, outcome.err) == (0, "", "")
    found = run("reproduce", "--list", "--json", "--quiet")
    assert json.loads(found.out)
    wrong = run("basis", "no.ply", "--out", "b.npz", "--quiet")
    assert wrong.code == 2
    assert "does not exist" in wrong.err
    # Quiet is of one run.
    assert run("synth", "shapes", "--out", "c").out


def test_verbose_says_what_is_written(run):
    outcome = run("--verbose", "reproduce", "--only", "energy-by-degree", "--out", "r")
    assert "harmface: wrote r/report.html" in outcome.err
    assert "measured energy-by-degree in" in outcome.err
    assert run("reproduce", "--only", "energy-by-degree", "--out", "q").err == ""
    assert logging.getLogger("harmface").level == logging.NOTSET


def test_coefficients_go_from_one_command_to_the_next(run, tmp_path):
    run("synth", "environments", "--size", 32, "--out", "env")
    outcome = run("envmap", "project", "env/room.hdr", "--max-degree", 3, "--out", "room.json")
    assert outcome.code == 0
    kept = np.array(json.loads((tmp_path / "room.json").read_text())["coefficients"])
    assert kept.shape == (3, 16)
    printed = run("envmap", "project", "env/room.hdr", "--degree", 3, "--json").out
    assert np.array_equal(json.loads(printed)["coefficients"], kept)
    assert run("envmap", "irradiance", "room.json", "--out", "e.hdr").code == 0
    run("synth", "shapes", "--out", "shapes")
    ball = ("render", "shapes/sphere.ply", "--size", 16)
    assert run(*ball, "--environment", "room.json", "--out", "a.png").code == 0


def test_what_a_command_reads_it_does_not_write_over(run, check_refused):
    run("synth", "environments", "--size", 16, "--out", "env")
    check_refused("is read as well", "envmap", "project", "env/room.hdr", "--out", "env/room.hdr")
