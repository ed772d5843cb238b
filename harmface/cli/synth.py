"""`harmface synth`: procedural faces and shapes."""

from pathlib import Path
from typing import Annotated

import typer

from harmface.cli.common import output, progress

app = typer.Typer(help="Make procedural faces and shapes.", no_args_is_help=True)
OutOption = Annotated[Path, typer.Option(help="Folder to make; it must not hold other files.")]


@app.command()
def faces(
    out: OutOption,
    count: Annotated[int, typer.Option(help="Number of subjects.")] = 12,
    seed: Annotated[int, typer.Option(help="Seed of the population.")] = 0,
) -> None:
    """Make heads as PLY files, with linear albedo as vertex colours, and a manifest.

    Example: harmface synth faces --count 12 --seed 1 --out faces
    """
    from harmface.reproduce.synthetic import synthesize_faces

    with progress("heads") as report:
        synthesize_faces(out, count, seed, report)
    output.print(f"{count} heads in {out}")


@app.command()
def shapes(out: OutOption) -> None:
    """Make the canonical shapes (sphere, cylinder, vase, ...) as PLY files, and a manifest.

    Example: harmface synth shapes --out shapes
    """
    from harmface.reproduce.synthetic import synthesize_shapes

    with progress("shapes") as report:
        synthesize_shapes(out, report)
    output.print(f"shapes in {out}")
