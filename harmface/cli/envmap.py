"""`harmface envmap`: environment maps, their nine numbers, and irradiance from them."""

import json
import os
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from harmface import checks
from harmface.cli.common import (
    FIGURE_HELP,
    DpiOption,
    JsonOption,
    MaxDegreeOption,
    SchedulerOption,
    SkipBadOption,
    WorkersOption,
    claim_outputs,
    output,
    progress,
    read_apart,
    tell_skipped,
    working,
)
from harmface.cli.light_source import MapArgument, MapReading
from harmface.cli.material import MaterialOption, load_material, material_files
from harmface.cli.option_groups import with_options
from harmface.conventions import degree_order, max_degree_of
from harmface.errors import ArgumentError, FileError
from harmface.light import EnvironmentMap

app = typer.Typer(
    help="Environment maps: project, prefilter, convert, rotate, show.", no_args_is_help=True
)
COMPARED_ROWS = 32
MAP_SUFFIXES = (".hdr", ".pfm", ".exr")
"""Endings of the maps that are found in a folder: of floating-point formats."""
OutMap = Annotated[Path, typer.Option(help="Map to write: .hdr, .pfm or .exr.")]


@app.command()
@with_options("reading", MapReading)
def project(
    environment: MapArgument,
    max_degree: MaxDegreeOption = 2,
    out: Annotated[
        Path | None,
        typer.Option(
            help="JSON file to write, of a folder of maps a folder to make; `render` and `envmap "
            "irradiance` read it as light."
        ),
    ] = None,
    tool: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="TOOL",
            help="Print, or write, as another tool has them: json, glsl, three, unity, filament "
            "and more (see `light convert`).",
        ),
    ] = None,
    as_json: JsonOption = False,
    skip_bad: SkipBadOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    *,
    reading: MapReading,
) -> None:
    """Print the lighting coefficients L_lm of a map (RH01 eq. 10), for each channel.

    Of a folder all maps are projected, each to a file of its own; where a run was stopped the same
    command goes on.

    Example: harmface envmap project forest.hdr --out forest.json

    Example: harmface envmap project maps --workers 2 --out coefficients
    """
    from harmface.io import tool_text, write_tool_coefficients
    from harmface.light import project as project_map

    checks.degree("--max-degree", max_degree)
    if tool is not None and as_json:
        raise ArgumentError("--json and --format are two ways to print; give one of them")
    if len(environment) == 1 and environment[0].is_dir():
        if tool is not None or as_json or out is None:
            raise ArgumentError("a folder of maps is projected to --out FOLDER, as JSON files")
        _project_all(environment[0], out, max_degree, skip_bad, workers, scheduler, reading)
        return
    if skip_bad or workers is not None or scheduler is not None:
        raise ArgumentError("--skip-bad, --workers and --scheduler are for a folder of maps")
    claim_outputs(out, inputs=environment)
    coefficients = np.atleast_2d(project_map(reading.load_map(environment), max_degree))
    text = tool_text(coefficients, tool or "harmface")
    if out is not None:
        write_tool_coefficients(out, coefficients, tool or "harmface")
    elif tool is not None:
        typer.echo(text, nl=False)
    if tool is not None:
        return
    if as_json:
        typer.echo(json.dumps({"coefficients": coefficients.tolist()}, indent=1))
        return
    names = ("red", "green", "blue") if len(coefficients) == 3 else ("grey",)
    table = Table("l, m", *names)
    for k, values in enumerate(coefficients.T):
        l, m = degree_order(k)  # noqa: E741 - the field's name for it
        table.add_row(f"{l}, {m}", *(f"{value:.6f}" for value in values))
    output.print(table)


@app.command()
@with_options("reading", MapReading)
def irradiance(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="MAP|COEFFICIENTS|PROBE",
            help="A map, a JSON file of `project`, or grace, eucalyptus, st-peters.",
        ),
    ],
    out: OutMap,
    size: Annotated[int, typer.Option(help="Rows of the irradiance map.")] = 128,
    max_degree: MaxDegreeOption = 2,
    window: Annotated[
        str | None,
        typer.Option(help="Against ringing: hann, lanczos, or non-negative. Off unless asked."),
    ] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Print the error against brute-force integration.")
    ] = False,
    *,
    reading: MapReading,
) -> None:
    """Write the irradiance map of any light as a lat-long map (RH01 eq. 7).

    Example: harmface envmap irradiance grace --out grace_irradiance.hdr
    """
    from harmface.io import write_environment_map
    from harmface.light import layout_named, windowed
    from harmface.light import project as project_map
    from harmface.rendering import irradiance_error, irradiance_map

    checks.degree("--max-degree", max_degree)
    claim_outputs(out, inputs=[source])
    light = reading.load_light(source)
    if isinstance(light, EnvironmentMap):
        coefficients = project_map(light, max_degree)
    elif compare:
        raise ArgumentError("--compare needs a map; coefficients alone cannot tell their error")
    else:
        coefficients = light
    if window is not None:
        coefficients = windowed(coefficients, _window(window, coefficients.shape[-1]))
    image = irradiance_map(coefficients, "latlong", size)
    # Nine coefficients of a light with sharp features can dip below zero; a map file cannot.
    negative = float((image < 0).mean())
    picture = np.moveaxis(image, 0, -1) if image.ndim == 3 else image
    write_environment_map(out, np.maximum(picture, 0).astype(np.float32))
    output.print(f"irradiance in {out}" + (f", {negative:.1%} clipped at 0" if negative else ""))
    if compare:
        assert isinstance(light, EnvironmentMap)
        grid = layout_named("latlong")
        weights = grid.solid_angles(COMPARED_ROWS) / (4 * np.pi)
        error = np.abs(
            irradiance_error(coefficients, light.as_distant_light(), grid.directions(COMPARED_ROWS))
        )
        average = (error * weights).sum(axis=(-2, -1)).max()
        output.print(
            "error against brute force, as a share of the total intensity: "
            f"average {average:.2%}, largest {error.max():.2%}"
        )


@app.command()
@with_options("reading", MapReading)
def reflect(
    environment: MapArgument,
    material: MaterialOption,
    out: OutMap,
    size: Annotated[int, typer.Option(help="Rows of the result.")] = 128,
    accuracy: Annotated[
        float,
        typer.Option(help="Greatest factor of the lobe that is cut off, as a share of all."),
    ] = 1e-3,
    figure: Annotated[
        Path | None, typer.Option(help=f"Figure: the map and its reflection. {FIGURE_HELP}")
    ] = None,
    dpi: DpiOption = None,
    *,
    reading: MapReading,
) -> None:
    """Write what a glossy material shows of a map, by the mirrored direction (R05 eq. 39).

    The lobe of `--material` is taken as it is along the normal, the same from every side.

    Example: harmface envmap reflect forest.hdr --material phong:50 --out glossy.hdr
    """
    from harmface.io import write_environment_map
    from harmface.rendering import reflection_map
    from harmface.viz import reflection_figure, write_figure

    claim_outputs(out, figure, inputs=[*environment, *material_files(material)])
    made_of = load_material(material)
    found = reading.load_map(environment)
    shown = reflection_map(found, made_of, size, accuracy=accuracy)
    negative = float((shown < 0).mean())
    picture = np.moveaxis(shown, 0, -1) if shown.ndim == 3 else shown
    picture = np.maximum(picture, 0).astype(np.float32)
    write_environment_map(out, picture)
    if figure is not None:
        glossy = EnvironmentMap.from_image(picture)
        write_figure(figure, reflection_figure(found, glossy, material), dpi=dpi)
    output.print(f"reflection in {out}" + (f", {negative:.1%} clipped at 0" if negative else ""))


@app.command()
@with_options("reading", MapReading)
def convert(
    environment: MapArgument,
    out: OutMap,
    to: Annotated[str, typer.Option(help="Layout of the result.")] = "latlong",
    size: Annotated[int, typer.Option(help="Rows of the result, or of a cube's face.")] = 256,
    arrangement: Annotated[
        str, typer.Option(help="How a cube's faces are laid out.")
    ] = "vertical-strip",
    *,
    reading: MapReading,
) -> None:
    """Draw a map anew in another layout, antialiased, in our own frame.

    Example: harmface envmap convert probe.hdr --layout angular --to cube --size 256 --out cube.hdr
    """
    from harmface.io import file_layout, write_environment_map
    from harmface.light import resample

    claim_outputs(out, inputs=environment)
    drawn = resample(reading.load_map(environment), file_layout(to), size)
    write_environment_map(out, drawn.as_image(), arrangement=arrangement)
    output.print(f"{to} map in {out}")


@app.command()
@with_options("reading", MapReading)
def rotate(
    environment: MapArgument,
    out: OutMap,
    azimuth: Annotated[float, typer.Option(help="Degrees about +y, from +z towards +x.")] = 0.0,
    elevation: Annotated[float, typer.Option(help="Then degrees about +x, +z towards +y.")] = 0.0,
    *,
    reading: MapReading,
) -> None:
    """Turn a map's light, and draw it in the same layout and size, in our own frame.

    Example: harmface envmap rotate forest.hdr --azimuth 90 --out turned.hdr
    """
    from scipy.spatial.transform import Rotation

    from harmface.io import write_environment_map
    from harmface.light import resample

    checks.finite("--azimuth and --elevation", np.array([azimuth, elevation]))
    turn = Rotation.from_euler("yx", [azimuth, -elevation], degrees=True).as_matrix()
    claim_outputs(out, inputs=environment)
    found = reading.load_map(environment)
    turned = resample(found.rotated(turn), found.layout, found.height)
    write_environment_map(out, turned.as_image())
    output.print(f"turned map in {out}")


@app.command()
@with_options("reading", MapReading)
def show(
    environment: MapArgument,
    out: Annotated[Path, typer.Option(help=f"Figure to write. {FIGURE_HELP}")],
    max_degree: MaxDegreeOption = 2,
    dpi: DpiOption = None,
    *,
    reading: MapReading,
) -> None:
    """Draw a map, tone-mapped, beside what its coefficients keep and the irradiance they give.

    Example: harmface envmap show forest.hdr --out forest.png
    """
    from harmface.light import project as project_map
    from harmface.viz import environment_figure, write_figure

    checks.degree("--max-degree", max_degree)
    claim_outputs(out, inputs=environment)
    found = reading.load_map(environment)
    write_figure(out, environment_figure(found, project_map(found, max_degree)), dpi=dpi)
    output.print(f"picture in {out}")


def _project_all(
    folder: Path,
    out: Path,
    max_degree: int,
    skip_bad: bool,
    workers: int | None,
    scheduler: str | None,
    reading: MapReading,
) -> None:
    """Project all maps of a folder."""
    from harmface.scale import Job, project_maps

    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in MAP_SUFFIXES)
    if not files:
        raise FileError(f"{folder}: holds no map; give {', '.join(MAP_SUFFIXES)} files")
    if not read_apart(Path(os.path.realpath(out)), [folder.resolve()]):
        raise FileError(f"{out}: lies in {folder}, which is read; give a folder elsewhere")
    with working(workers, scheduler) as engine, progress("projecting") as report:
        job = Job(engine, report, skip_bad)
        kept, skipped = project_maps(out, files, partial(_read_one, reading), max_degree, job)
    tell_skipped(skipped)
    output.print(f"coefficients of {len(kept)} maps in {out}")


def _read_one(reading: MapReading, path: Path) -> EnvironmentMap:
    return reading.load_map([path])


def _window(name: str, count: int) -> np.ndarray:
    """Return the weights of a window by its name, one for each degree."""
    from harmface.light import hann_window, lanczos_window, non_negative_window
    from harmface.reflectance import lambert_coefficients

    degree = max_degree_of(count)
    if name == "non-negative":
        return non_negative_window(lambert_coefficients(degree))
    windows = {"hann": hann_window, "lanczos": lanczos_window}
    if name not in windows:
        raise ArgumentError(f"--window must be hann, lanczos or non-negative, got {name!r}")
    return windows[name](degree)
