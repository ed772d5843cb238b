"""The documentation does what it shows: every Python block of every page runs, in order."""

import re
import shlex
from pathlib import Path

import pytest

from harmface.cli import main

DOCS = Path(__file__).parents[2] / "docs"
PAGES = {
    str(page.relative_to(DOCS)): page.read_text()
    for page in sorted(DOCS.rglob("*.md"))
    if not {"_build", "_tables", "gallery"} & set(page.relative_to(DOCS).parts)
}
WITH_CODE = [name for name, text in PAGES.items() if "```python" in text]
COMMANDS = sorted(
    {
        line.split("#")[0].strip()
        for text in [*PAGES.values(), (DOCS.parent / "README.md").read_text()]
        for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
        for line in block.splitlines()
        if line.startswith("harmface ") and "--help" not in line
    }
)


def test_there_are_pages_with_code():
    assert len(WITH_CODE) > 5
    assert len(COMMANDS) > 30


@pytest.mark.parametrize("name", WITH_CODE)
def test_the_code_of_a_page_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for block in re.findall(r"```python\n(.*?)```", PAGES[name], re.DOTALL):
        exec(compile(block, name, "exec"), names)


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_have_the_options_that_are_shown(command, tmp_path, monkeypatch, capsys):
    """With `--help` at the end a command parses its options and goes no further."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        main([*shlex.split(command)[1:], "--help"])
    assert stop.value.code == 0, capsys.readouterr().err


def test_an_option_that_is_not_there_would_be_noticed(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["basis", "head.glb", "--nothing", "--help"])
    assert stop.value.code == 2
