"""What several commands share: tables, progress, option types."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from harmface.geometry import Mesh

MeshArgument = Annotated[
    Path, typer.Argument(metavar="MESH", help="A PLY, OBJ, GLB or STL file, y up, facing +z.")
]
TextureOption = Annotated[
    Path | None, typer.Option(help="Image to use as albedo; the mesh needs UV coordinates.")
]
SrgbColorsOption = Annotated[
    bool,
    typer.Option("--srgb-colors", help="The mesh's colours are sRGB-encoded: make them linear."),
]
SizeOption = Annotated[int, typer.Option(help="Rows and columns of the picture.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON for programs.")]

output = Console()
errors = Console(stderr=True)


def load_mesh(path: Path, texture: Path | None, srgb_colors: bool) -> Mesh:
    """Read a mesh; trimesh is slow to import and stays away from commands without one."""
    from harmface.io import read_mesh

    return read_mesh(path, texture=texture, srgb=srgb_colors)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal's stderr; yields a function to be told the fraction done."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=errors, transient=True, disable=not errors.is_terminal) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda done: bar.update(task, completed=done)
