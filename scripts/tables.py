"""Tables of the documentation, made from what was measured: `docs/measured/*.json`.

`speed.json` is written by `python scripts/bench.py --json docs/measured/speed.json`, `claims.json`
is the `results.json` of `harmface reproduce`.
"""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harmface.reproduce.claims import load_claims
from harmface.reproduce.report import numbers, published

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
MEASURED, TABLES = DOCS / "measured", DOCS / "_tables"


# A source as docstrings define it: `.. [RH01] Authors, Title, Place.`, its next lines indented.
_SOURCE = re.compile(r"^ *\.\. \[(\w+)\] (.+\n(?: {3,}(?!\.\.)\S.*\n)*)", re.MULTILINE)


def write_tables() -> None:
    """Write tables of speed and accuracy, and the sources that docstrings cite."""
    TABLES.mkdir(exist_ok=True)
    (TABLES / "bibliography.txt").write_text(bibliography())
    for name, make in (("speed", speed), ("claims", claims)):
        found = json.loads((MEASURED / f"{name}.json").read_text())
        (TABLES / f"{name}.md").write_text(make(found))


def bibliography() -> str:
    """Return every source that a docstring defines, once, in the order of its key."""
    sources: dict[str, str] = {}
    for path in sorted((ROOT / "harmface").rglob("*.py")):
        for key, text in _SOURCE.findall(path.read_text()):
            line = " ".join(text.replace('"""', "").split())
            sources[key] = max(sources.get(key, ""), line, key=len)
    return "".join(f".. [{key}] {text}\n" for key, text in sorted(sources.items()))


def speed(found: dict[str, Any]) -> str:
    """Return ratios as a Markdown table."""
    rows = [(row["what"], _ratio(row["ratio"]), row["bar"]) for row in found["rows"]]
    return markdown(("what / against", "ratio", "bar"), rows)


def claims(found: dict[str, Any]) -> str:
    """Return published and measured figures as a Markdown table."""
    known = load_claims()
    verdicts = {True: "holds", False: "fails", None: "shown"}
    rows = [
        (
            f"`{each['id']}`",
            each["source"],
            published(known[each["id"]]),
            numbers(each["measured"]),
            verdicts[each["holds"]],
        )
        for each in found["results"]
    ]
    return markdown(("claim", "source", "published", "measured", "verdict"), rows)


def markdown(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """Return a table in Markdown; bars in cells are escaped."""
    lines = [head, ("---",) * len(head), *rows]
    cells = [[cell.replace("|", r"\|") for cell in line] for line in lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def _ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
