"""Damaged files by the thousand, read in child processes: a crash ends one and is counted."""

import json
import os
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field
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
        started, finished = _batch(reader, case, end - case, keep, tally)
        if started is None:
            raise RuntimeError(f"{reader}: the child ended before its first case: {finished}")
        if finished is not None:
            tally.add(started, finished)
        case = started + 1
    return tally


def _batch(
    reader: str, first: int, count: int, keep: Path | None, tally: Tally
) -> tuple[int | None, str | None]:
    """Run cases until all are done or the process ends; return the last, and how it ended."""
    threads = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "fuzz.child", reader, str(first), str(count)]
    with subprocess.Popen(
        command + ([] if keep is None else [str(keep)]),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=TESTS.parent,
        env={**os.environ, **threads, "PYTHONPATH": str(TESTS)},
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        started, done = None, None
        for line in process.stdout:
            record = json.loads(line)
            started = record["case"]
            if "outcome" in record:
                done = started
                tally.add(**record)
        words = process.stderr.read().strip()
    if started is None:
        return None, words
    if process.returncode == 0:
        return started, None
    ended = process.returncode
    how = signal.Signals(-ended).name if ended < 0 else f"exit {ended} {words[-200:]}"
    how = "hang" if ended == -signal.SIGALRM else f"crash: {how}"
    return started, None if done == started else how
