"""Kill commands at the moments when they touch files, or at any other, and run them again.

Commands run in forks of this process, which has imported what they need.
"""

import contextlib
import importlib
import json
import os
import shutil
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from harmface.cli import main as harmface
from harmface.io.atomic import HIDDEN
from kill.commands import COMMANDS, UNREPEATABLE, prepare

TOUCHES = ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir")
"""Audit events of Python: moments before a file is touched."""

IMPORTED = ("enrollment", "io", "pca", "recognition.methods", "reproduce.run", "stereo", "viz")
"""Rooms of the package that forks then need not import again."""

Tree = dict[str, bytes]


@dataclass
class Command:
    """A command, and what came of killing it."""

    words: list[str]
    whole: Tree = field(default_factory=dict)
    touches: int = 0
    seconds: float = 0.0
    kills: int = 0
    failures: list[str] = field(default_factory=list)


def kill_all(
    folder: Path,
    kills: int,
    names: list[str],
    progress: Callable[[int, str], None] = lambda number, name: None,
    program: Callable[[list[str]], Any] = harmface,
) -> dict[str, Command]:
    """Kill commands in turn, in a folder; return what came of each."""
    for room in IMPORTED:
        importlib.import_module(f"harmface.{room}")
    (folder / "input").mkdir(parents=True)
    prepare(folder / "input")
    given = tree(folder / "input")
    commands = {name: Command(COMMANDS[name].split()) for name in names}
    rng = np.random.default_rng(0)
    for number in range(kills):
        name = names[number % len(names)]
        command = commands[name]
        progress(number, name)
        if not command.whole:
            _measure(command, folder, program)
        place = _fresh(folder)
        if number // len(names) % 2 == 0:
            moment = int(rng.integers(1, command.touches + 1))
            _run(program, command.words, place, folder / "log", at_touch=moment)
            when = f"touch {moment} of {command.touches}"
        else:
            after = float(rng.random()) * command.seconds
            _run(program, command.words, place, folder / "log", after=after)
            when = f"{after:.2f} of {command.seconds:.2f} s"
        command.kills += 1
        left = tree(place)
        wrong = [file for file in left if not _sound(file, left[file], command.whole | given)]
        code = _run(program, command.words, place, folder / "log")
        again = tree(place)
        if wrong:
            command.failures.append(f"killed at {when}: corrupt {wrong[0]}")
        if code != 0:
            said = (folder / "log").read_text().strip()[-300:]
            command.failures.append(f"killed at {when}: the next run exits with {code}: {said}")
        elif different := _different(again, command.whole):
            command.failures.append(f"killed at {when}: after the next run {different} differs")
    return commands


def tree(folder: Path) -> Tree:
    """Return the content of all files below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def _measure(command: Command, folder: Path, program: Callable[[list[str]], Any]) -> None:
    """Run a command whole, to know what it writes, how often it touches files, and how long."""
    place = _fresh(folder)
    start = time.monotonic()
    code = _run(program, command.words, place, folder / "log", counted=folder / "touches")
    command.seconds = time.monotonic() - start
    if code != 0:
        raise RuntimeError(f"{command.words} fails by itself: {(folder / 'log').read_text()}")
    command.touches = int((folder / "touches").read_text())
    command.whole = tree(place)


def _fresh(folder: Path) -> Path:
    place = folder / "work"
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(folder / "input", place)
    return place


def _sound(name: str, data: bytes, whole: Tree) -> bool:
    """Return whether a file that a killed command left is one of the whole, or not in the way."""
    path = Path(name)
    # Zarr has a temporary name of its own.
    if path.name.startswith(HIDDEN) or path.suffix == ".partial" or path.name in UNREPEATABLE:
        return True
    if name in whole:
        return data == whole[name]
    # Notes of a job that is under way.
    try:
        return path.suffix == ".json" and bool(json.loads(data))
    except ValueError:
        return False


def _different(found: Tree, whole: Tree) -> str | None:
    """Return a file that is not the same in both, or in one only."""
    for name in sorted(found.keys() | whole.keys()):
        if Path(name).name not in UNREPEATABLE and found.get(name) != whole.get(name):
            return name
    return None


def _run(
    program: Callable[[list[str]], Any],
    words: list[str],
    place: Path,
    log: Path,
    *,
    at_touch: int = 0,
    after: float | None = None,
    counted: Path | None = None,
) -> int:
    """Run a command in a fork; kill it at a touch of a file or after some seconds, if asked to."""
    child = os.fork()
    if child == 0:
        with contextlib.suppress(BaseException):
            descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(descriptor, 1)
            os.dup2(descriptor, 2)
            os.chdir(place)
            touches = _watch(place, at_touch)
            code: Any = 70
            try:
                code = program(words) or 0
            except SystemExit as stop:
                code = stop.code
            finally:
                if counted is not None:
                    counted.write_text(str(touches[0]))
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(code)
        os._exit(70)
    if after is not None:
        time.sleep(after)
        # A fork that has ended waits to be asked for its code, so its number is still its own.
        os.kill(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _watch(place: Path, at_touch: int) -> list[int]:
    """Count touches of files below a folder; end this process before the one asked for."""
    count = [0]
    root = str(place)

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event not in TOUCHES or not isinstance(arguments[0], str | bytes | os.PathLike):
            return
        if not os.path.abspath(os.fsdecode(arguments[0])).startswith(root):  # noqa: PTH100
            return
        count[0] += 1
        if count[0] == at_touch:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)
    return count
