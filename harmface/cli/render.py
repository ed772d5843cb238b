"""`harmface render`: a picture of a mesh under lamps or an environment map."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from harmface.cli.common import SizeOption, claim_outputs, output, progress
from harmface.cli.light_source import EnvironmentReading
from harmface.cli.material import MATERIAL_HELP, load_material, material_files
from harmface.cli.mesh_options import MeshArgument, MeshReading
from harmface.cli.option_groups import with_options
from harmface.conventions import light_direction
from harmface.errors import ArgumentError
from harmface.geometry import GBuffer, Mesh, frame_orthographic, gbuffer
from harmface.light import DistantLight, EnvironmentMap

if TYPE_CHECKING:
    from harmface.reflectance import Material

SUPERSAMPLING = 2
ENVIRONMENT_DIRECTIONS = 600
GLOSSY_DIRECTIONS = 1200
"""Some six degrees apart, less than the width of lobes down to a roughness of 0.15."""
PART = 16
"""Directions rendered between two reports of progress."""

BRIGHTEST = 0.95
"""Where automatic exposure puts the 99.5th percentile of the surface, as a share of white."""


@with_options("mesh_reading", MeshReading)
@with_options("reading", EnvironmentReading)
def render(
    mesh: MeshArgument,
    out: Annotated[Path, typer.Option(help="Picture to write: .png or .jpg.")],
    light: Annotated[
        list[str] | None,
        typer.Option(
            metavar="AZIMUTH,ELEVATION",
            help="A directional light, degrees right of and above the viewing axis; repeatable.",
        ),
    ] = None,
    environment: Annotated[
        Path | None,
        typer.Option(
            metavar="MAP|COEFFICIENTS|PROBE",
            help="Environment map; or coefficients (.json of `envmap project`), or grace, "
            "eucalyptus, st-peters, which render through harmonics, without cast shadows.",
        ),
    ] = None,
    transfer: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="What `harmface transfer` made of the mesh: shadows and reflections on itself "
            "under the harmonics of the light, in place of brute force.",
        ),
    ] = None,
    material: Annotated[
        str,
        typer.Option(
            metavar="NAME[:NUMBER]",
            help=f"What the mesh is made of, tinted by its albedo: {MATERIAL_HELP}",
        ),
    ] = "lambert",
    cast_shadows: Annotated[bool, typer.Option(help="Whether the mesh shadows itself.")] = True,
    size: SizeOption = 256,
    exposure: Annotated[
        float | None,
        typer.Option(help="Factor on radiosity; by default the brightest half percent is white."),
    ] = None,
    bits: Annotated[
        int, typer.Option(help="8 or 16 bits a channel; those of 16 are linear unless --srgb.")
    ] = 8,
    srgb: Annotated[
        bool | None,
        typer.Option("--srgb/--linear", help="Encode for the screen (8 bits), or keep linear."),
    ] = None,
    *,
    reading: EnvironmentReading,
    mesh_reading: MeshReading,
) -> None:
    """Render a mesh from the front by brute force: no harmonics, shadows by ray casting.

    The file says how it is encoded, and all commands believe it; outside the mesh a PNG file is
    transparent.
    With --transfer, light is taken to the transfer's degree and reflected as often as it says.

    Example: harmface render head.ply --light 40,20 --size 64 --out probe.png
    """
    from harmface.io import write_image
    from harmface.reflectance import Lambert, Mirror
    from harmface.rendering import box_average, harmonic_irradiance, mirrored

    if (light is None) == (environment is None):
        raise ArgumentError("give either --light AZIMUTH,ELEVATION or --environment MAP")
    claim_outputs(
        out,
        inputs=[
            *mesh_reading.files(mesh),
            *filter(None, [environment, transfer]),
            *material_files(material),
        ],
    )
    made_of = load_material(material)
    matte = made_of == Lambert()
    if transfer is not None and not matte:
        raise ArgumentError("--transfer is of a matte surface; leave out it or --material")
    surface = mesh_reading.load(mesh)
    view = gbuffer(surface, frame_orthographic(surface, size * SUPERSAMPLING))
    albedo = np.moveaxis(view.albedo, -1, 0)
    if light is not None:
        directions = np.stack([lamp_direction(text) for text in light])
        source: EnvironmentMap | np.ndarray | DistantLight = DistantLight(
            directions, np.ones((3, len(directions)))
        )
    else:
        assert environment is not None
        source = reading.load_light(environment)
    if transfer is not None:
        image = albedo * _by_transfer(transfer, surface, view, source)
    elif isinstance(source, np.ndarray) and not matte:
        raise ArgumentError(
            "--material needs a map or lamps; coefficients know too little of light"
        )
    elif isinstance(source, np.ndarray):
        image = np.zeros(albedo.shape)
        received = harmonic_irradiance(source, view.normals[view.mask])
        image[:, view.mask] = albedo[:, view.mask] * np.maximum(received, 0)
    elif isinstance(made_of, Mirror):
        if not isinstance(source, EnvironmentMap):
            raise ArgumentError("a mirror shows lamps nowhere; give --environment MAP")
        caster = surface if cast_shadows else None
        image = albedo * made_of.share * mirrored(view, source, caster=caster)
    else:
        if isinstance(source, EnvironmentMap):
            count = ENVIRONMENT_DIRECTIONS if matte else GLOSSY_DIRECTIONS
            source = source.as_distant_light(count)
        with progress("rendering") as report:
            caster = surface if cast_shadows else None
            image = _brute_force(view, source, caster, None if matte else made_of, report)
    if exposure is None:
        brightest = np.percentile(image[:, view.mask], 99.5)
        exposure = BRIGHTEST / brightest if brightest > 0 else 1.0
    picture = np.moveaxis(box_average(image * exposure, SUPERSAMPLING), 0, -1)
    srgb = bits == 8 if srgb is None else srgb
    opacity = None
    if out.suffix.lower() == ".png":
        opacity = box_average(view.mask.astype(np.float64), SUPERSAMPLING)
    write_image(out, picture, bits=bits, srgb=srgb, opacity=opacity)
    encoding = "sRGB" if srgb else "linear"
    output.print(f"{size} x {size} pixels in {out} ({encoding}, exposure {exposure:.4g})")


def _brute_force(
    view: GBuffer,
    light: DistantLight,
    caster: Mesh | None,
    material: "Material | None",
    report: Callable[[float], None],
) -> np.ndarray:
    """Return radiosity, channels first, rendered a few directions at a time."""
    from harmface.rendering import render as render_part

    albedo = np.moveaxis(view.albedo, -1, 0)
    image = np.zeros(albedo.shape)
    count = len(light.directions)
    for first in range(0, count, PART):
        some = slice(first, first + PART)
        part = DistantLight(light.directions[some], light.irradiances[..., some])
        image += render_part(view, part, albedo=albedo, caster=caster, material=material)
        report(min(first + PART, count) / count)
    return image


def _by_transfer(
    path: Path, mesh: Mesh, view: GBuffer, source: EnvironmentMap | np.ndarray | DistantLight
) -> np.ndarray:
    """Return irradiance, channels first, from the transfer in a file."""
    from harmface.conventions import max_degree_of
    from harmface.geometry import vertex_weights
    from harmface.io import read_transfer
    from harmface.light import directional_lights, project

    found = read_transfer(path, mesh).coefficients
    degree = max_degree_of(found.shape[-2])
    if isinstance(source, EnvironmentMap):
        light = project(source, degree)
    elif isinstance(source, DistantLight):
        light = directional_lights(source, degree)
    else:
        light = source
    count = min(light.shape[-1], found.shape[-2])
    received = (light[..., None, :count] @ found[..., :count, :])[..., 0, :]
    weights = vertex_weights(mesh, view.camera)
    # Where the series of a sharp light falls below zero there is none.
    image = np.maximum(weights @ received.T, 0).T
    return image.reshape(-1, *view.mask.shape)


def lamp_direction(text: str) -> np.ndarray:
    """Return the direction of a light given as `AZIMUTH,ELEVATION` in degrees."""
    parts = text.split(",")
    try:
        azimuth, elevation = (float(part) for part in parts)
    except ValueError:
        raise ArgumentError(
            f"--light must be AZIMUTH,ELEVATION in degrees, such as 40,20, got {text!r}"
        ) from None
    if not (np.isfinite(azimuth) and -90 <= elevation <= 90):
        raise ArgumentError(f"--light needs an elevation from -90 to 90 degrees, got {text!r}")
    return light_direction(azimuth, elevation)
