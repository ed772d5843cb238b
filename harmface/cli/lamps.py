"""Where the lamps of `harmface stereo` are, from a file or from a mirror sphere."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.io import Capture


@dataclass(frozen=True)
class LampOptions:
    """What is known of the lamps."""

    lights: Annotated[
        Path | None,
        typer.Option(
            help="Text or .npy file, a line an image: x y z to the light (x right, y up, z towards "
            "the camera) and, if known, its intensity, which is estimated otherwise; or an .lp "
            "file; else lights.txt in the folder or beside it."
        ),
    ] = None
    near_lamps: Annotated[
        bool,
        typer.Option(
            "--near-lamps",
            help="The file of lights holds the lamps' positions, in units of the width of the "
            "mask, from its middle, at the mean height of the surface: light falls with distance "
            "and its direction changes over the object.",
        ),
    ] = False
    coloured_lamps: Annotated[
        bool,
        typer.Option(
            "--coloured-lamps",
            help="A red, a green and a blue lamp shone at once on an object of one colour: the "
            "channels of each photograph count as three, each with a line of the file of lights.",
        ),
    ] = False
    chrome_ball: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Photographs of a mirror sphere under the same lamps in the same order, with its "
            "mask: its highlights tell the directions, in place of --lights.",
        ),
    ] = None
    chrome_ball_mask: Annotated[
        Path | None,
        typer.Option(
            metavar="MASK",
            help="Image that is white on a mirror sphere which the photographs show beside the "
            "object: its highlights tell the directions, in place of --lights.",
        ),
    ] = None


def check_lamp_options(options: LampOptions, method: str) -> None:
    """Refuse options that contradict each other or the method."""
    given = [
        option
        for option, value in (
            ("--lights", options.lights),
            ("--chrome-ball", options.chrome_ball),
            ("--chrome-ball-mask", options.chrome_ball_mask),
        )
        if value is not None
    ]
    if len(given) > 1:
        raise ArgumentError(f"{given[0]} and {given[1]} both tell the lamps; give one of them")
    if options.near_lamps and given and given[0] != "--lights":
        raise ArgumentError(f"{given[0]} tells directions, but --near-lamps needs positions")
    given += ["--near-lamps"] * options.near_lamps
    if given and given[-1] != "--lights" and method != "known-lights":
        raise ArgumentError(f"{given[-1]} serves --method known-lights, got {method!r}")


def with_lamps(
    capture: "Capture", options: LampOptions, *, srgb: bool | None, max_pixels: int
) -> "Capture":
    """Return photographs with the directions that a mirror sphere shows, if there is one.

    Raises
    ------
    HarmfaceError
        If the sphere has no mask, photographs differ in number or size, or one shows no clear
        highlight.
    """
    from harmface.io import read_capture, read_mask
    from harmface.stereo import directions_from_mirror_sphere, object_mask

    if options.chrome_ball is not None:
        ball = read_capture(
            [options.chrome_ball],
            srgb=srgb,
            coloured=options.coloured_lamps,
            max_pixels=max_pixels,
        )
        if len(ball.names) != len(capture.names):
            raise FileError(
                f"{options.chrome_ball}: holds {len(ball.names)} photographs of the mirror sphere, "
                f"but there are {len(capture.names)} of the object; take one for each lamp"
            )
        images, names = ball.images, ball.names
        mask = object_mask(images) if ball.mask is None else ball.mask
        if mask is None:
            raise FileError(
                f"{options.chrome_ball}: needs the mask of the mirror sphere; paint it white on "
                "black and save it there as mask.png"
            )
    elif options.chrome_ball_mask is not None:
        if capture.mask is None:
            raise ArgumentError(
                "--chrome-ball-mask needs the object's own mask too; paint it and give it as --mask"
            )
        images, names = capture.images, capture.names
        mask = read_mask(options.chrome_ball_mask)
        if mask.shape != images.shape[1:]:
            raise FileError(
                f"{options.chrome_ball_mask}: has {mask.shape[0]} x {mask.shape[1]} pixels, the "
                f"photographs have {images.shape[1]} x {images.shape[2]}"
            )
    else:
        return capture
    found = directions_from_mirror_sphere(images, mask, names=names)
    note = (
        f"the lamps are those that the mirror sphere shows, {found.radius:.1f} pixels in radius: a "
        f"pixel is worth {np.median(found.degrees_per_pixel):.1f} degrees of their directions"
    )
    return replace(capture, lights=found.directions, notes=(*capture.notes, note))
