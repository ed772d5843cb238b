"""What the command line takes as light: maps, coefficients, published probes."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from harmface.cli.common import MaxPixelsOption, pixel_limit, told
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
PartOption = Annotated[
    str | None,
    typer.Option(help="Which part, layer or view of an .exr file: its name, or its number from 0."),
]
_ENCODING = (
    "Whether a map of 8 or 16 bits is sRGB-encoded, to be made linear, or linear: at 8 bits a note "
    "asks for one of the two."
)


@dataclass(frozen=True)
class MapReading:
    """The options that say how a map's file is to be read."""

    layout: LayoutOption = "latlong"
    frame: FrameOption = None
    srgb: Annotated[bool | None, typer.Option("--srgb/--linear", help=_ENCODING)] = None
    part: PartOption = None
    max_pixels: MaxPixelsOption = None

    def load_map(self, paths: list[Path]) -> EnvironmentMap:
        """Read a map from one file, or a cube from six; say on stderr what was assumed."""
        from harmface.io import read_environment_map

        with told():
            return read_environment_map(
                paths[0] if len(paths) == 1 else paths,
                self.layout,
                frame=self.frame,
                srgb=self.srgb,
                part=self.part,
                max_pixels=pixel_limit(self.max_pixels),
            )

    def load_light(self, source: Path) -> EnvironmentMap | np.ndarray:
        """Return a map, or the coefficients of a published probe or a JSON file."""
        from harmface.io import read_coefficients

        if str(source) in PUBLISHED_PROBES:
            return published_probe(str(source))
        if source.suffix.lower() == ".json":
            return read_coefficients(source)
        return self.load_map([source])


@dataclass(frozen=True)
class EnvironmentReading:
    """`MapReading` for commands whose --srgb is another: the encoding has a longer name."""

    layout: LayoutOption = "latlong"
    frame: FrameOption = None
    srgb_environment: Annotated[
        bool | None,
        typer.Option("--srgb-environment/--linear-environment", help=_ENCODING),
    ] = None
    part: PartOption = None
    max_pixels: MaxPixelsOption = None

    def load_light(self, source: Path) -> EnvironmentMap | np.ndarray:
        """Return a map, or the coefficients of a published probe or a JSON file."""
        return MapReading(
            self.layout, self.frame, self.srgb_environment, self.part, self.max_pixels
        ).load_light(source)
