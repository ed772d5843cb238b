"""`harmface reproduce`: the package against the papers."""

from pathlib import Path
from typing import Annotated

import typer
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
    as_json: JsonOption = False,
) -> None:
    """Measure the published figures and write a report; exits with 1 if a claim fails.

    A run that was stopped goes on where it was when the same command is given again.

    Example: harmface reproduce --only lambert-decay worst-pixel-error --out report
    """
    from harmface.errors import ArgumentError
    from harmface.reproduce.report import numbers, published
    from harmface.reproduce.run import reproduce as run

    if more and not only:
        raise ArgumentError(f"unexpected argument {more[0]!r}; name claims after --only")
    with errors.status("") as status:
        wanted = [name for text in [*(only or []), *(more or [])] for name in text.split(",")]
        results = run(out, wanted, environments or (), lambda name: status.update(name))
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
