"""The command line: parse, call, print.

Exit codes: 0 done, 1 a claim or check failed, 2 bad input.
"""

import sys

import typer

from harmface import __version__
from harmface.cli import basis, envmap, evaluate, pca, recognition, render, reproduce, stereo, synth
from harmface.errors import HarmfaceError

app = typer.Typer(
    name="harmface",
    help="Spherical harmonics of faces and other diffuse objects under any distant light.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)
app.add_typer(synth.app, name="synth")
app.add_typer(envmap.app, name="envmap")
app.command("basis")(basis.basis)
app.command("render")(render.render)
app.command("enroll")(recognition.enroll)
app.command("recognize")(recognition.recognize)
app.command("pca")(pca.pca)
app.command("evaluate")(evaluate.evaluate)
app.command("stereo")(stereo.stereo)
app.command("reproduce")(reproduce.reproduce)


def _version(wanted: bool) -> bool:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit
    return wanted


@app.callback()
def root(
    version: bool = typer.Option(
        False, "--version", callback=_version, is_eager=True, help="Print the version and stop."
    ),
) -> None:
    """Spherical harmonics of faces and other diffuse objects under any distant light."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exits with 0, 1 (a claim failed) or 2 (bad input)."""
    try:
        code = app(arguments, standalone_mode=False, prog_name="harmface")
    except (HarmfaceError, typer.TyperException) as error:
        message = error.format_message() if isinstance(error, typer.TyperException) else str(error)
        if message:
            typer.echo("harmface: " + " ".join(message.split()), err=True)
        sys.exit(2)
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("harmface: stopped", err=True)
        sys.exit(130)
    sys.exit(code if isinstance(code, int) else 0)
