"""Change the code of a room a little, many times, and count how often its tests notice.

A seeded sample, uniform over the lines that can be changed. Each change is made in a copy, on which
the room's own tests, the doctests of the changed file, laws and equations are run. What survives is
printed: a change that makes no difference, or a test that is missing.

    python scripts/mutate.py light --count 40 --seed 1
"""

import argparse
import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

import numpy as np
from rich.console import Console

ROOT = Path(__file__).parents[1]
COPIED = ("harmface", "data_synth", "tests", "docs", "scripts", "pyproject.toml", "README.md")
SLOWER = 5
"""How many times as long as the whole code's the tests of a change may take, till they count as
stopped by it."""

COMPARISONS = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}
OPERATORS = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Pow: ("**", "*"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}


@dataclass(frozen=True)
class Mutant:
    """A change of one place of a file: the characters from `start` to `end` become `text`."""

    path: Path
    line: int
    start: int
    end: int
    text: str

    def applied(self, source: str) -> str:
        """Return the changed file."""
        return source[: self.start] + self.text + source[self.end :]


def mutants(path: Path) -> Iterator[Mutant]:
    """Yield the changes of a file; annotations, texts and the words of errors stay as they are."""
    source = path.read_text()
    starts = [0]
    for line in source.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line.decode()))

    def place(line: int, column: int) -> int:
        # Columns count bytes.
        text = source[starts[line - 1] : starts[line]]
        return starts[line - 1] + len(text.encode()[:column].decode())

    def change(node: ast.AST, start: int, end: int, text: str) -> Mutant:
        return Mutant(path, node.lineno, start, end, text)  # type: ignore[attr-defined]

    for node in _code(ast.parse(source)):
        begin = place(node.lineno, node.col_offset)  # type: ignore[attr-defined]
        end = place(node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]
        pairs: list[tuple[ast.AST, ast.AST, tuple[str, str]]] = []
        if isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
            pairs = [(node.left, node.comparators[0], COMPARISONS[type(node.ops[0])])]
        elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            pairs = [(node.left, node.right, OPERATORS[type(node.op)])]
        elif isinstance(node, ast.BoolOp):
            pairs = [(node.values[0], node.values[1], OPERATORS[type(node.op)])]
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield change(node, begin, end, repr(not node.value))
        elif isinstance(node, ast.Constant) and isinstance(node.value, int):
            yield change(node, begin, end, repr(node.value + 1))
        elif isinstance(node, ast.Constant) and isinstance(node.value, float):
            yield change(node, begin, end, repr(1.5 * node.value + 0.01))
        elif isinstance(node, ast.If | ast.IfExp):
            test = node.test
            first = place(test.lineno, test.col_offset)
            last = place(test.end_lineno or test.lineno, test.end_col_offset or 0)
            yield change(node, first, last, f"not ({source[first:last]})")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            yield change(node, begin, begin + (1 if isinstance(node.op, ast.USub) else 3), "")
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            yield change(node, begin, end, "pass")
        for left, right, (old, new) in pairs:
            first = place(left.end_lineno, left.end_col_offset)  # type: ignore[attr-defined]
            last = place(right.lineno, right.col_offset)  # type: ignore[attr-defined]
            at = source.find(old, first, last)
            if at >= 0:
                yield change(node, at, at + len(old), new)


def _code(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes that do something."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(
            node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom | ast.arguments
        ):
            if isinstance(node, ast.arguments):
                for default in [*node.defaults, *filter(None, node.kw_defaults)]:
                    yield from [default, *_code(default)]
            continue
        if isinstance(node, ast.AnnAssign):
            if node.value is not None:
                yield from [node.value, *_code(node.value)]
            continue
        if isinstance(node, ast.keyword) and node.arg == "strict":
            continue  # it matters only to what nothing reaches
        if hasattr(node, "lineno"):
            yield node
        if isinstance(node, ast.FunctionDef):
            for inner in [node.args, *node.body]:
                yield from _code(ast.Module([inner], []))  # type: ignore[list-item]
        else:
            yield from _code(node)


def sample(room: str, count: int, seed: int) -> list[Mutant]:
    """Return changes, one a line of lines drawn without replacement."""
    by_line: dict[tuple[Path, int], list[Mutant]] = {}
    for path in sorted((ROOT / "harmface" / room).rglob("*.py")):
        for mutant in mutants(path):
            by_line.setdefault((path, mutant.line), []).append(mutant)
    rng = np.random.default_rng(seed)
    lines = list(by_line)
    chosen = rng.permutation(len(lines))[:count]
    return [by_line[lines[i]][rng.integers(len(by_line[lines[i]]))] for i in chosen]


def tests_of(room: str) -> list[str]:
    """Return where a room is tested, in the order in which faults are found soonest."""
    places = (f"tests/unit/{room}", "tests/laws", "tests/equations", "tests/misuse")
    return [place for place in places if (ROOT / place).exists()]


def passes(folder: Path, tests: list[str], seconds: float) -> bool:
    """Return whether the tests of a copy pass in time."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(folder),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def main() -> None:
    """Print what survived, and the share that did not; exits with 1 if it is below `--least`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", help="subpackage of harmface")
    parser.add_argument("--count", type=int, default=40, help="changes to try")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sample")
    parser.add_argument("--jobs", type=int, default=1, help="changes tried at a time")
    parser.add_argument("--least", type=float, default=0.0, help="share that must be noticed")
    options = parser.parse_args()
    console = Console(markup=False, highlight=False)
    chosen = sample(options.room, options.count, options.seed)
    copies: Queue[Path] = Queue()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.jobs):
            copies.put(_copy(Path(folder, str(number))))
        tests = tests_of(options.room)
        started = os.times().elapsed
        first = copies.get()
        if not passes(first, tests, 3600):
            sys.exit("the tests fail without any change")
        limit = 30 + SLOWER * (os.times().elapsed - started)
        copies.put(first)

        def survives(mutant: Mutant) -> bool:
            copy = copies.get()
            path = copy / mutant.path.relative_to(ROOT)
            source = path.read_text()
            path.write_text(mutant.applied(source))
            alive = passes(copy, [*tests, str(path.relative_to(copy))], limit)
            path.write_text(source)
            copies.put(copy)
            return alive

        survivors = 0
        with ThreadPoolExecutor(options.jobs) as pool:
            for mutant, alive in zip(chosen, pool.map(survives, chosen), strict=True):
                if alive:
                    survivors += 1
                    source = mutant.path.read_text()
                    old = source[mutant.start : mutant.end] or "nothing"
                    where = f"{mutant.path.relative_to(ROOT)}:{mutant.line}"
                    console.print(f"{where}: {old!r} -> {mutant.text!r}")
                    console.print(f"    {source.splitlines()[mutant.line - 1].strip()}")
    share = 1 - survivors / len(chosen)
    console.print(f"{options.room}: {share:.0%} of {len(chosen)} changes noticed")
    if share < options.least:
        sys.exit(1)


def _copy(folder: Path) -> Path:
    """Copy what the tests need."""
    folder.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "_build", "gallery")
            shutil.copytree(source, folder / name, ignore=ignored)
        else:
            shutil.copy(source, folder / name)
    return folder


if __name__ == "__main__":
    main()
