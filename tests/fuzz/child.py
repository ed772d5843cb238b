"""Reads damaged files one after the other, in forks of this process that may crash.

Run as `python -m fuzz.child`. Takes lines of JSON: reader, first case, count, and a folder for the
files of failures or null. For each line a fork prints one before and after each case, and this
process one when the fork has ended. What takes long to import is there before the forks.
"""

import json
import os
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import IO

import cv2  # noqa: F401 - readers import it where they need it
import numpy as np
import OpenImageIO  # noqa: F401
import trimesh  # noqa: F401

from fuzz.odd import FIFO
from fuzz.pitfalls import PITFALLS
from fuzz.readers import READERS, damaged
from harmface import errors
from harmface.errors import HarmfaceError

SECONDS = 5.0
"""Longest that a small file may keep a processor busy, whatever else the machine does."""

GIVEN_UP = 7
"""Seconds of a processor after which a fork ends itself, whatever it is doing."""

WAITED = 180
"""Seconds after which it ends itself if it waits; long, as the machine may have others to serve."""

MEMORY = 2**30
"""Most memory that a small file may take."""

CEILING = 6 * 2**30
"""Address space beyond that of the start; the machine is not to suffer."""

LONGEST = 600
"""Longest message beside the name of the file: at most 200 characters of it are from a file."""


def main() -> None:
    """Read cases in a fork for each line of stdin."""
    say = os.fdopen(os.dup(1), "w")

    def tell(**record: object) -> None:
        print(json.dumps(record), file=say, flush=True)

    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            try:
                read_cases(tell, *json.loads(line))
            except BaseException:
                tell(broken=traceback.format_exc())
            os._exit(0)
        tell(ended=os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))


def read_cases(
    tell: Callable[..., None], name: str, first: int, count: int, keep: str | None
) -> None:
    """Read some cases of a reader; `keep` names a folder for the files of those that fail.

    The first cases are the odd files of the format, all others sound ones after random damage.
    """
    warnings.simplefilter("always")
    for kind in vars(errors).values():
        # The package's own notes are meant; any other library's are noise.
        if isinstance(kind, type) and issubclass(kind, Warning):
            warnings.simplefilter("ignore", kind)
    reader = (READERS | PITFALLS)[name]
    sound, odd = reader.seeds(), reader.odd()
    with tempfile.TemporaryDirectory() as folder:
        for files in sound:
            # Sound files are read, so that all is imported and in memory before it is measured.
            _written(files, Path(folder))
            try:
                reader.read(Path(folder, next(iter(files))))
            except HarmfaceError:
                continue
    resource.setrlimit(resource.RLIMIT_AS, (_status("VmSize") + CEILING, resource.RLIM_INFINITY))
    noise = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
    for stream in (1, 2):
        os.dup2(noise.fileno(), stream)
    for number in range(first, first + count):
        rng = np.random.default_rng([zlib.crc32(name.encode()), number])
        files = odd[number] if number < len(odd) else damaged(reader, sound, rng)
        tell(case=number)
        with tempfile.TemporaryDirectory() as folder:
            found = _outcome(reader.read, files, Path(folder), noise)
        if keep and found["outcome"] not in ("read", "refused"):
            _written(files, Path(keep, f"{name}-{number}"))
        tell(case=number, **found)


def _outcome(read, files: dict[str, bytes], folder: Path, noise: IO[bytes]) -> dict[str, object]:
    """Return what reading came to: "read", "refused", or what is wrong with it."""
    _written(files, folder)
    noise.truncate(0)
    noise.seek(0)
    Path("/proc/self/clear_refs").write_text("5")
    before = _status("VmHWM")
    signal.setitimer(signal.ITIMER_PROF, GIVEN_UP)
    signal.alarm(WAITED)
    start = time.process_time()
    said = ""
    try:
        read(folder / next(iter(files)))
        outcome = "read"
    except HarmfaceError as error:
        outcome, said = "refused", str(error)
    except Exception as error:
        outcome, said = f"{type(error).__name__} in {_places(error)}", str(error)
    seconds = time.process_time() - start
    signal.setitimer(signal.ITIMER_PROF, 0)
    signal.alarm(0)
    taken = _status("VmHWM") - before
    sys.stdout.flush()
    sys.stderr.flush()
    noise.seek(0)
    heard = noise.read(300).decode("utf-8", "replace").strip()
    if outcome in ("read", "refused"):
        if seconds > SECONDS:
            outcome = "slow"
        elif taken > MEMORY:
            outcome = "memory"
        elif len(said.replace(str(folder), "")) > LONGEST:
            outcome = "long message"
        elif heard:
            outcome, said = f"noise: {re.sub('[^A-Za-z ].*', '', heard)}", heard
    said = said.replace(str(folder), "")[:160]
    return {"outcome": outcome, "seconds": seconds, "memory": taken, "said": said}


def _written(files: dict[str, bytes], folder: Path) -> None:
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if data == FIFO:
            os.mkfifo(path)
        else:
            path.write_bytes(data)


def _places(error: Exception) -> str:
    """Return the last place of the package, and the last of all, that an error came through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "harmface" in Path(frame.filename).parts]
    shown = dict.fromkeys(f"{Path(f.filename).name}:{f.name}" for f in [*ours[-1:], *frames[-1:]])
    return ", ".join(shown)


def _status(field: str) -> int:
    """Return a number of this process's memory in bytes."""
    line = re.search(rf"^{field}:\s+(\d+) kB", Path("/proc/self/status").read_text(), re.MULTILINE)
    assert line is not None
    return 1024 * int(line[1])


if __name__ == "__main__":
    main()
