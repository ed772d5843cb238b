"""Readers that misbehave, to see that the harness notices."""

import ctypes
import os
from pathlib import Path
from typing import Any

from fuzz.readers import Reader


def _segfault(path: Path) -> Any:
    return ctypes.string_at(0)


def _exception(path: Path) -> Any:
    raise KeyError("x")


def _noise(path: Path) -> Any:
    os.write(2, b"library: I am talking\n")


def _memory(path: Path) -> Any:
    return len(b"x" * (2**30 + 2**24))


def _endless(path: Path) -> Any:
    while True:
        pass


def _sound(path: Path) -> Any:
    return path.read_bytes()


def _reader(read: Any) -> Reader:
    # The sound file is read once before anything counts.
    return Reader(
        lambda: [{"x": b"sound"}], lambda path: path.read_bytes() == b"sound" or read(path)
    )


PITFALLS = {
    name: _reader(read)
    for name, read in (
        *(("segfault", _segfault), ("exception", _exception), ("noise", _noise)),
        *(("memory", _memory), ("endless", _endless), ("sound", _sound)),
    )
}
