"""`harmface relight`: a photograph of a known surface in other light."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from harmface.cli.common import claim_outputs, errors, output
from harmface.cli.light_source import FrameOption, LayoutOption, MapReading, PartOption
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.cli.photographed import PhotoArgument, SurfaceReading
from harmface.cli.render import lamp_direction
from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError
from harmface.light import DistantLight, EnvironmentMap

DEGREE = 4
"""Degree of the light that is divided out: with cast shadows more is told than degree 2."""


@with_options("mesh_reading", MeshReading)
@with_options("reading", SurfaceReading)
def relight(
    photo: PhotoArgument,
    out: Annotated[Path, typer.Option(help="PNG or JPEG file to write, in sRGB, which it says.")],
    environment: Annotated[
        Path | None,
        typer.Option(
            metavar="MAP|PROBE", help="New light: a map, or grace, eucalyptus, st-peters."
        ),
    ] = None,
    coefficients: Annotated[
        Path | None, typer.Option(help="New light: JSON of `light` or `envmap project`.")
    ] = None,
    light: Annotated[
        list[str] | None,
        typer.Option(
            metavar="AZIMUTH,ELEVATION",
            help="New light: a lamp, degrees right of and above the viewing axis; repeatable.",
        ),
    ] = None,
    from_light: Annotated[
        Path | None,
        typer.Option(help="The light of the photograph, JSON of `light`; else it is estimated."),
    ] = None,
    exposure: Annotated[
        float | None,
        typer.Option(help="Factor on the new light; by default the mean brightness stays."),
    ] = None,
    layout: LayoutOption = "latlong",
    frame: FrameOption = None,
    srgb_environment: Annotated[
        bool | None,
        typer.Option("--srgb-environment/--linear-environment", help="Encoding of the map."),
    ] = None,
    part: PartOption = None,
    *,
    reading: SurfaceReading,
    mesh_reading: MeshReading,
) -> None:
    """Show a photograph of a known surface in other light, its texture kept.

    The surface is multiplied by the ratio of what every pixel receives in the new light and in its
    own, shadows that a mesh casts included; all else is left as it is.

    Example: harmface relight photo.png --mesh head.glb --environment city.hdr --out relit.png
    """
    from harmface.inverse import estimate_light, relight_photograph
    from harmface.io import read_coefficients, write_image

    if sum(each is not None for each in (environment, coefficients, light)) != 1:
        raise ArgumentError("give one of --environment MAP, --coefficients JSON, --light A,E")
    given = [environment, coefficients, from_light]
    claim_outputs(out, inputs=[*reading.files(photo), *(path for path in given if path)])
    image = reading.load_photo(photo)
    surface = reading.load_surface((image.shape[0], image.shape[1]), mesh_reading)
    wanted: EnvironmentMap | DistantLight | np.ndarray
    if light is not None:
        directions = np.stack([lamp_direction(text) for text in light])
        wanted = DistantLight(directions, np.ones(len(directions)))
    elif coefficients is not None:
        wanted = read_coefficients(coefficients)
    else:
        assert environment is not None
        maps = MapReading(layout, frame, srgb_environment, part, reading.max_pixels)
        wanted = maps.load_light(environment)
    with errors.status("relighting"):
        if from_light is not None:
            own = read_coefficients(from_light)
        else:
            degree = DEGREE if surface.caster is not None else 2
            albedo = surface.albedo if surface.albedo is not None else 1.0
            if isinstance(albedo, np.ndarray) and albedo.ndim == 3 and image.ndim == 2:
                albedo = luminance(albedo)
            found = estimate_light(
                image,
                surface.normals,
                albedo,
                degree=degree,
                mask=surface.inner,
                believed=image < 1,
                visibility=surface.harmonic_irradiances(degree),
            )
            own = np.atleast_2d(found.least_norm)
        before, after = (_received(surface, each, image) for each in (own, wanted))
    relit = relight_photograph(image, before, after, surface.mask, exposure=exposure)
    clipped = float((relit[surface.mask] > 1).mean())
    write_image(out, relit, bits=8, srgb=True)
    said = f", {clipped:.1%} of the surface clipped" if clipped else ""
    output.print(f"{image.shape[0]} x {image.shape[1]} pixels in {out} (sRGB{said})")


def _received(
    surface: object, light: EnvironmentMap | DistantLight | np.ndarray, image: np.ndarray
) -> np.ndarray:
    """Return the irradiance of every pixel, with the photograph's channels or one."""
    received: np.ndarray = surface.irradiance(light)  # type: ignore[attr-defined]
    if received.ndim == 2 or len(received) == 1:
        return received.reshape(received.shape[-2:])
    if len(received) != 3:
        raise FileError(f"light must have one channel or three, got {len(received)}")
    return luminance(np.moveaxis(received, 0, -1)) if image.ndim == 2 else received
