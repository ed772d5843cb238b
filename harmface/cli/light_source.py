"""What the command line takes as light: maps, coefficients, published probes."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from harmface.light import PUBLISHED_PROBES, EnvironmentMap, published_probe

MapArgument = Annotated[
    list[Path],
    typer.Argument(metavar="MAP...", help="An .hdr, .pfm, .exr or 8/16-bit file; six for a cube."),
]
LayoutOption = Annotated[
    str, typer.Option(help="latlong, angular (light probe), mirror-ball or cube.")
]
FrameOption = Annotated[
    str | None,
    typer.Option(
        help="Whose convention the file follows: openexr, rh01, figure-3, debevec, opengl, "
        "three.js, y-up or z-up; by default openexr, for angular maps rh01, for balls figure-3."
    ),
]


def load_map(paths: list[Path], layout: str, frame: str | None) -> EnvironmentMap:
    """Read a map from one file, or a cube from six."""
    from harmface.io import read_environment_map

    return read_environment_map(paths[0] if len(paths) == 1 else paths, layout, frame=frame)


def load_light(source: Path, layout: str, frame: str | None) -> EnvironmentMap | np.ndarray:
    """Return a map, or the coefficients of a published probe or a JSON file."""
    from harmface.io import read_coefficients

    if str(source) in PUBLISHED_PROBES:
        return published_probe(str(source))
    if source.suffix.lower() == ".json":
        return read_coefficients(source)
    return load_map([source], layout, frame)
