"""Damaged files by the thousand, read in child processes: a crash ends one and is counted."""

import atexit
import json
import os
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

TESTS = Path(__file__).parents[1]

EXPECTED = ("read", "refused")
"""What may come of a damaged file: it is sound enough, or refused by name."""


@dataclass
class Tally:
    """What came of the cases of one reader.

    Parameters
    ----------
    outcomes
        How often each was met.
    failures
        The first case of each that was not expected, with what was said.
    seconds, memory
        The most that a case took; memory in bytes.
    """

    outcomes: Counter[str] = field(default_factory=Counter)
    failures: dict[str, tuple[int, str]] = field(default_factory=dict)
    seconds: float = 0.0
    memory: int = 0

    def add(
        self, case: int, outcome: str, seconds: float = 0.0, memory: int = 0, said: str = ""
    ) -> None:
        """Count the outcome of a case."""
        self.outcomes[outcome] += 1
        self.seconds, self.memory = max(self.seconds, seconds), max(self.memory, memory)
        if outcome not in EXPECTED:
            self.failures.setdefault(outcome, (case, said))

    def __str__(self) -> str:
        """Return a line for each failure."""
        return "\n".join(
            f"{self.outcomes[outcome]} x {outcome}, first in case {case}: {said}"
            for outcome, (case, said) in self.failures.items()
        )


def fuzz(reader: str, first: int, count: int, keep: Path | None = None) -> Tally:
    """Read `count` damaged files, from number `first` on; the same number is the same file."""
    tally = Tally()
    case, end = first, first + count
    while case < end:
        started, ended = _batch(reader, case, end - case, keep, tally)
        if started is None:
            raise RuntimeError(f"{reader}: the child ended before its first case: {ended}")
        if ended is not None:
            tally.add(started, ended)
        case = started + 1
    return tally


@cache
def _child() -> subprocess.Popen[str]:
    """Return the process that forks for each batch; it ends with this one."""
    threads = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(
        [sys.executable, "-m", "fuzz.child"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=TESTS.parent,
        env={**os.environ, **threads, "PYTHONPATH": str(TESTS)},
        text=True,
    )
    atexit.register(process.communicate)
    return process


def _batch(
    reader: str, first: int, count: int, keep: Path | None, tally: Tally
) -> tuple[int | None, str | None]:
    """Run cases until all are done or the fork ends; return the last, and how it ended."""
    process = _child()
    assert process.stdin is not None
    assert process.stdout is not None
    where = None if keep is None else str(keep.absolute())
    print(json.dumps([reader, first, count, where]), file=process.stdin, flush=True)
    started, done = None, None
    for line in process.stdout:
        record = json.loads(line)
        if "broken" in record:
            raise RuntimeError(f"{reader}: the harness fails: {record['broken']}")
        if "ended" in record:
            code = record["ended"]
            break
        started = record["case"]
        if "outcome" in record:
            done = started
            tally.add(**record)
    else:
        raise RuntimeError(f"{reader}: the harness has ended")
    if code == 0 or done == started is not None:
        return started, None
    how = signal.Signals(-code).name if code < 0 else f"exit {code}"
    return started, "hang" if -code in (signal.SIGALRM, signal.SIGPROF) else f"crash: {how}"
