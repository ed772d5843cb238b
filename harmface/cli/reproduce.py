"""`harmface reproduce`: the package against the papers."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.padding import Padding
from rich.table import Column, Table
from rich.text import Text

from harmface.cli.common import JsonOption, errors, output


def reproduce(
    more: Annotated[list[str] | None, typer.Argument(metavar="[ID]...", hidden=True)] = None,
    out: Annotated[
        Path, typer.Option(help="Folder to write report.html to, with results.json.")
    ] = Path("report"),
    only: Annotated[
        list[str] | None, typer.Option(metavar="ID...", help="Measure only these claims.")
    ] = None,
    environments: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="MAP", help="Measure irradiance-error-natural on this map too; repeatable."
        ),
    ] = None,
    jobs: Annotated[
        int, typer.Option(help="Claims measured at a time; ratios of times suffer.")
    ] = 1,
    list_claims: Annotated[
        bool, typer.Option("--list", help="Print the claims and how each would fail; no more.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Measure the published figures and write a report; exits with 1 if a claim fails.

    A run that was stopped goes on where it was when the same command is given again.

    Example: harmface reproduce --only lambert-decay worst-pixel-error --out report
    """
    from harmface.errors import ArgumentError
    from harmface.reproduce.report import numbers, published
    from harmface.reproduce.run import reproduce as run

    if list_claims:
        _list(as_json)
        return
    if more and not only:
        raise ArgumentError(f"unexpected argument {more[0]!r}; name claims after --only")
    with errors.status("") as status:
        wanted = [name for text in [*(only or []), *(more or [])] for name in text.split(",")]
        results = run(out, wanted, environments or (), lambda name: status.update(name), jobs=jobs)
    if as_json:
        typer.echo((out / "results.json").read_text(), nl=False)
    else:
        # Names are what --only takes, so they are never cut short.
        table = Table(Column("claim", no_wrap=True), "published", "measured", "verdict", "s")
        colors = {"holds": "green", "reached": "green", "FAILS": "bold red"}
        for result in results:
            color = colors.get(result.verdict, "yellow")
            table.add_row(
                result.claim.id,
                published(result.claim),
                numbers(result.values),
                Text(result.verdict, color),
                f"{result.seconds:.1f}",
            )
        output.print(table)
        output.print(f"report in {out / 'report.html'}")
    if any(result.failed for result in results):
        raise typer.Exit(1)


def _list(as_json: bool) -> None:
    """Print every claim: what it measures, where it is published, and how it would fail."""
    from harmface.reproduce.claims import load_claims

    claims = load_claims().values()
    if as_json:
        facts = [
            {"id": claim.id, "source": claim.source, "what": claim.what, "fails": claim.bound}
            for claim in claims
        ]
        typer.echo(json.dumps(facts, indent=1))
        return
    for claim in claims:
        output.print(claim.id, style="bold", highlight=False)
        for text in (f"{claim.what}.", f"Source: {claim.source}.", f"It {claim.bound}."):
            output.print(Padding(text, (0, 0, 0, 4)), highlight=False)
