"""`harmface light`: the light a photograph was taken in, and coefficients of other tools."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from typer.core import TyperGroup

from harmface import checks
from harmface.cli.common import JsonOption, claim_outputs, errors, output, told
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.cli.photographed import PhotoArgument, SurfaceReading
from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.inverse import LightEstimate, LightPrior

MUCH_CLIPPED = 0.5
"""Share of the surface that may be clipped; more is refused."""

SHADOWED_DEGREE = 4
"""Degree fitted where cast shadows are known: they tell of it, see `LightEstimate.up_to`."""

MAP_SUFFIXES = (".hdr", ".pfm", ".exr")

BETTER = 0.8
"""Residual after sRGB is undone, as a share of that before, from which a photograph seems to be
encoded."""


class _PhotographFirst(TyperGroup):
    """A group of which `estimate` is the command that need not be named."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the name of the command in front that may be left out."""
        if args and args[0] not in (*self.commands, "--help"):
            args = ["estimate", *args]
        return super().parse_args(ctx, args)


app = typer.Typer(
    cls=_PhotographFirst,
    help="Light from a photograph (harmface light PHOTO --mesh HEAD), and coefficients between "
    "tools (harmface light convert).",
    no_args_is_help=True,
)


@app.command()
@with_options("mesh_reading", MeshReading)
@with_options("reading", SurfaceReading)
def estimate(
    photo: PhotoArgument,
    degree: Annotated[int, typer.Option(help="Highest degree; above 2 give a --prior.")] = 2,
    non_negative: Annotated[
        bool, typer.Option("--non-negative", help="The best light that is nowhere negative.")
    ] = False,
    prior: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Lat-long environment maps to learn from what light is like."
        ),
    ] = None,
    rotations: Annotated[
        bool, typer.Option("--rotations", help="Maps of the prior may be turned any way round.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="JSON: coefficients, covariance and all that is printed.")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option(help="PNG: photograph, fit, residual, the light, error bars.")
    ] = None,
    as_json: JsonOption = False,
    *,
    reading: SurfaceReading,
    mesh_reading: MeshReading,
) -> None:
    """Estimate the light of a photograph of a known surface; the word `estimate` may be left out.

    Coefficients come with standard errors, in the photograph's unit; what the photograph does not
    tell is said to be unobserved. Shadows, highlights and clipped pixels have no vote; shadows that
    a mesh casts are computed. Photographs are taken as linear unless --srgb is given.

    Example: harmface light photo.png --mesh head.glb --figure light.png --out light.json
    """
    from harmface.inverse import estimate_light, estimate_light_and_albedo

    checks.degree("--degree", degree)
    if rotations and prior is None:
        raise ArgumentError("--rotations says how to learn a --prior; give that too")
    inputs = reading.files(photo)
    claim_outputs(out, figure, inputs=inputs)
    image = reading.load_photo(photo)
    surface = reading.load_surface((image.shape[0], image.shape[1]), mesh_reading)
    believed = image < 1
    clipped = 1 - believed[surface.inner].mean()
    if clipped > MUCH_CLIPPED:
        raise FileError(f"{photo}: is clipped on {clipped:.0%} of the surface; expose it less")
    unknown = reading.albedo_unknown(surface)
    known = None if prior is None else _learned(prior, max(degree, SHADOWED_DEGREE), rotations)
    with errors.status("estimating"):
        fitted = degree if surface.caster is None else max(degree, SHADOWED_DEGREE)
        basis = surface.harmonic_irradiances(fitted)
        albedo = _matching(surface.albedo, image)
        options: dict[str, Any] = {
            "degree": fitted,
            "mask": surface.inner,
            "believed": believed,
            "visibility": basis,
            "prior": known,
            "non_negative": non_negative,
        }
        if unknown:
            fit, _ = estimate_light_and_albedo(image, surface.normals, **options)
        else:
            fit = estimate_light(image, surface.normals, albedo, **options)
    found = fit.up_to(degree)
    notes = _notes(found, clipped, unknown, constant=reading.albedo == "constant")
    asked = not (reading.srgb or unknown)
    if asked and _seems_encoded(image, surface, albedo, options, fit):
        notes.append("the photograph seems to be sRGB-encoded: try --srgb")
    summary = _summary(found, notes)
    if figure is not None:
        from harmface.viz import light_figure, write_figure

        write_figure(figure, light_figure(image, fit, surface.inner))
    if out is not None:
        from harmface.io import atomic_write

        with atomic_write(out) as file:
            file.write(json.dumps(summary, indent=1).encode() + b"\n")
    if as_json:
        typer.echo(json.dumps(summary, indent=1))
        return
    with told() as tell:
        for note in notes:
            tell(note)
    output.print(str(found), highlight=False)
    for path in (out, figure):
        if path is not None:
            output.print(f"written: {path}")


def _matching(albedo: np.ndarray | None, image: np.ndarray) -> np.ndarray | float:
    """Return the albedo with the channels of a photograph."""
    if albedo is None:
        return 1.0
    return luminance(albedo) if albedo.ndim == 3 and image.ndim == 2 else albedo


def _learned(folder: Path, degree: int, rotations: bool) -> "LightPrior":
    from harmface.inverse import LightPrior
    from harmface.io import read_environment_map

    if not folder.is_dir():
        raise FileError(f"{folder}: must be a folder of environment maps")
    paths = [path for path in sorted(folder.iterdir()) if path.suffix.lower() in MAP_SUFFIXES]
    if len(paths) < 2:
        raise FileError(f"{folder}: must hold two environment maps or more, got {len(paths)}")
    with told():
        maps = [read_environment_map(path) for path in paths]
    return LightPrior.learn(maps, degree, rotations=rotations)


def _seems_encoded(
    image: np.ndarray,
    surface: Any,
    albedo: np.ndarray | float,
    options: dict[str, Any],
    found: "LightEstimate",
) -> bool:
    """Return whether the photograph fits clearly better once sRGB is undone."""
    from harmface.conventions import srgb_to_linear
    from harmface.inverse import estimate_light

    linear = srgb_to_linear(image)
    other = estimate_light(linear, surface.normals, albedo, **options)
    return bool(other.residual.max() < BETTER * found.residual.max())


def _notes(found: "LightEstimate", clipped: float, unknown: bool, constant: bool) -> list[str]:
    """Return what to know of an estimate."""
    notes = []
    if clipped > 0:
        notes.append(f"{clipped:.1%} of the surface is clipped and has no vote")
    silent = ~found.determined
    if silent.any():
        from harmface.conventions import degree_order

        names = ", ".join("({}, {})".format(*degree_order(int(k))) for k in np.flatnonzero(silent))
        notes.append(f"the photograph tells nothing of coefficients {names}; a --prior would")
    vague = np.atleast_2d(found.vague).any(axis=0) & found.determined
    if vague.any():
        notes.append(
            f"{vague.sum()} coefficients are vague: all that light could be lies within their "
            "95 % intervals"
        )
    if found.negative:
        notes.append(
            "the light is more directed than one lamp could be: its shadows were left out as "
            "shadows; --non-negative keeps it possible"
        )
    if unknown:
        notes.append("albedo and light share one free factor: the median albedo counts as 1")
    elif constant:
        notes.append("the albedo counts as 1 everywhere: the light is told times the true one")
    return notes


def _summary(found: "LightEstimate", notes: list[str]) -> dict[str, Any]:
    """Return all that was found, as JSON can hold it: null where nothing is known."""

    def listed(array: np.ndarray) -> Any:
        array = np.asarray(array, float)
        return np.where(np.isfinite(array), array, None).tolist()  # type: ignore[call-overload]

    light = np.atleast_2d(found.coefficients)
    count = light.shape[-1]
    return {
        "coefficients": listed(light),
        "standard_errors": listed(np.atleast_2d(found.standard_errors)),
        "covariance": listed(found.covariance.reshape(-1, count, count)),
        "determined": found.determined.tolist(),
        "vague": np.atleast_2d(found.vague).tolist(),
        "direction": found.direction.tolist(),
        "direction_error_degrees": listed(np.array(found.direction_error)),
        "ambient_share": found.ambient_share,
        "condition": listed(np.array(found.condition)),
        "singular_values": found.singular_values.tolist(),
        "noise": np.atleast_1d(found.noise).tolist(),
        "residual": np.atleast_1d(found.residual).tolist(),
        "notes": notes,
    }


@app.command()
def convert(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="NPY, JSON or text.")],
    source: Annotated[str, typer.Option("--from", metavar="TOOL", help="Whose file it is.")],
    target: Annotated[
        str, typer.Option("--to", metavar="TOOL", help="Whose coefficients to write.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="File to write, .npy for an array; else it is printed.")
    ] = None,
    window: Annotated[
        float | None,
        typer.Option(
            metavar="CUTOFF",
            help="Multiply degree l by sinc(l / CUTOFF)^4 against ringing, as Filament's cmgen "
            "does by default; its files do not say by which cutoff.",
        ),
    ] = None,
) -> None:
    """Convert lighting coefficients between tools: order, signs, factors and frame.

    Tools: harmface, three.js, filament (sh.txt), filament-radiance, unity, unreal, directx, kaolin,
    mitsuba, pyshtools, healpy, scipy, pifu, deca, deep3d, dpr, sfsnet; glsl is only written. The
    beginning of a name will do, as in three.
    docs/conventions.md says what each means by its numbers.

    Example: harmface light convert deca.npy --from deca --to three.js
    """
    from harmface.conventions import max_degree_of
    from harmface.io import read_tool_coefficients, tool_text, write_tool_coefficients
    from harmface.light import windowed
    from harmface.light.interchange import filament_window

    claim_outputs(out, inputs=[file])
    light = read_tool_coefficients(file, source)
    if window is not None:
        light = windowed(light, filament_window(window, max_degree_of(light.shape[-1])))
    text = tool_text(light, target)
    if out is None:
        typer.echo(text, nl=False)
        return
    write_tool_coefficients(out, light, target)
    output.print(f"{light.shape[0]} x {light.shape[1]} coefficients in {out}")
