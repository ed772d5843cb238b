"""The command line: parse, call, print.

Exit codes: 0 done, 1 a claim or check failed, 2 bad input, or too large for the memory there is,
3 a defect of the package.
"""

import logging
import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from typing import NoReturn

import typer

from harmface import __version__
from harmface.cli import (
    align,
    basis,
    cluster,
    envmap,
    evaluate,
    film,
    light,
    nearlight,
    pca,
    recognition,
    relight,
    render,
    reproduce,
    stereo,
    synth,
    transfer,
    view,
)
from harmface.cli.common import errors, output, releasing_outputs
from harmface.errors import HarmfaceError

app = typer.Typer(
    name="harmface",
    help="Spherical harmonics of faces and other diffuse objects under any distant light.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(synth.app, name="synth")
app.add_typer(envmap.app, name="envmap")
app.add_typer(light.app, name="light")
app.command("basis")(basis.basis)
app.command("render")(render.render)
app.command("relight")(relight.relight)
app.command("view")(view.view)
app.command("transfer")(transfer.transfer)
app.command("nearlight")(nearlight.nearlight)
app.command("align")(align.align)
app.command("enroll")(recognition.enroll)
app.command("pack")(recognition.pack)
app.command("recognize")(recognition.recognize)
app.command("cluster")(cluster.cluster)
app.command("pca")(pca.pca)
app.command("evaluate")(evaluate.evaluate)
app.command("stereo")(stereo.stereo)
app.command("film")(film.film)
app.command("reproduce")(reproduce.reproduce)


EVERYWHERE = ("--debug", "--quiet", "--verbose")
"""Options that all commands take."""


@contextmanager
def _logging(wanted: bool) -> Iterator[None]:
    """Show the package's log on stderr, if wanted."""
    log = logging.getLogger("harmface")
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("harmface: %(message)s"))
    level = log.level
    if wanted:
        log.addHandler(handler)
        log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(level)


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
    quiet: bool = typer.Option(
        False, "--quiet", help="Print only errors, and what --json asks for."
    ),
    verbose: bool = typer.Option(
        False, "--verbose", help="Say on stderr what is read, written and measured."
    ),
    debug: bool = typer.Option(
        False, "--debug", help="Show the traceback of an error that is not the input's."
    ),
) -> None:
    """Spherical harmonics of faces and other diffuse objects under any distant light."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exits with 0, 1 (a claim failed), 2 (bad input) or 3 (a defect)."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    debug = "--debug" in given
    output.quiet = errors.quiet = "--quiet" in given
    for stream in (sys.stdout, sys.stderr):
        # A name need not be text: what cannot be written is spelt out.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        with releasing_outputs(), _logging("--verbose" in given):
            # Like any option they may stand behind the command, too.
            code = app(
                [word for word in given if word not in EVERYWHERE],
                standalone_mode=False,
                prog_name="harmface",
            )
        sys.stdout.flush()
    except (HarmfaceError, typer.TyperException) as error:
        message = error.format_message() if isinstance(error, typer.TyperException) else str(error)
        _stop(2, message)
    except BrokenPipeError:
        # Whoever read the output has seen enough; nothing more can be said to them.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        name = "" if error.filename is None else f"{os.fsdecode(error.filename)}: "
        _stop(2, f"{name}{error.strerror or error}", debug)
    except MemoryError as error:
        reason = f" ({str(error)[:200]})" if str(error) else ""
        _stop(2, f"not enough memory{reason}; give smaller input", debug)
    except (KeyboardInterrupt, typer.Abort):
        _stop(130, "stopped")
    except Exception as error:
        _stop(
            3,
            f"a defect of harmface, not of your input: {type(error).__name__}: {str(error)[:200]}; "
            "the same command with --debug tells where",
            debug,
        )
    sys.exit(code if isinstance(code, int) else 0)


def _stop(code: int, message: str, debug: bool = False) -> NoReturn:
    """Exit with one line of text, without anything in it that a terminal would obey."""
    if debug:
        traceback.print_exc()
    if message:
        line = " ".join(message.split())
        shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
        typer.echo(f"harmface: {shown}", err=True)
    sys.exit(code)
