"""Tables of the documentation, made from what was measured: `docs/measured/*.json`.

`speed.json` is written by `python scripts/bench.py --json docs/measured/speed.json`, `claims.json`
is the `results.json` of `harmface reproduce`.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harmface.reproduce.claims import load_claims
from harmface.reproduce.report import numbers, published

DOCS = Path(__file__).parents[1] / "docs"
MEASURED, TABLES = DOCS / "measured", DOCS / "_tables"


def write_tables() -> None:
    """Write `docs/_tables/speed.md` and `docs/_tables/claims.md`."""
    TABLES.mkdir(exist_ok=True)
    for name, make in (("speed", speed), ("claims", claims)):
        found = json.loads((MEASURED / f"{name}.json").read_text())
        (TABLES / f"{name}.md").write_text(make(found))


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
