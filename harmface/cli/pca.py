"""`harmface pca`: the principal components of lighting variability."""

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from harmface import checks
from harmface.cli import basis
from harmface.cli.common import (
    FIGURE_HELP,
    DpiOption,
    JsonOption,
    MaxDegreeOption,
    SizeOption,
    claim_outputs,
    output,
)
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError, FileError

SHOWN = 9
MODES = 5


@with_options("mesh_reading", MeshReading)
def pca(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="MESH_OR_BASIS", help="A mesh (y up, facing +z), or a file of `harmface basis`."
        ),
    ],
    size: SizeOption = 256,
    light: Annotated[
        str,
        typer.Option(
            help="One directional light: uniform (whole sphere), front (half), or cone:DEGREES "
            "about the viewing axis."
        ),
    ] = "uniform",
    max_degree: MaxDegreeOption = 8,
    subtract_mean: Annotated[
        bool, typer.Option("--subtract-mean/--keep-mean", help="Whether about the mean image.")
    ] = True,
    albedo: Annotated[
        str, typer.Option(help="mesh: the file's colours (luminance); constant: white.")
    ] = "constant",
    empirical: Annotated[
        int,
        typer.Option(metavar="N", help="Compare with a PCA of N images made without harmonics."),
    ] = 0,
    figure: Annotated[
        Path | None,
        typer.Option(help=f"Figure of the first five modes; zero is mid grey. {FIGURE_HELP}"),
    ] = None,
    dpi: DpiOption = None,
    as_json: JsonOption = False,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Write down the principal components of a mesh's images under varying light.

    Analytic: from the visible normals alone, attached shadows included, every visible pixel the
    same weight. The view is frontal and orthographic. R05's face has .42 .33 .16 .035 .021.

    Example: harmface pca head.glb --size 256 --empirical 2000 --figure modes.png
    """
    from harmface import pca as theory

    checks.degree("--max-degree", max_degree)
    if albedo not in ("mesh", "constant"):
        raise ArgumentError(f"--albedo must be mesh or constant, got {albedo!r}")
    if empirical and empirical < SHOWN:
        raise ArgumentError(
            f"--empirical must be at least {SHOWN} images, one a component, got {empirical}"
        )
    half_angle = _half_angle(light)
    claim_outputs(figure, inputs=mesh_reading.files(source))
    distribution = theory.cone_lights(max_degree, half_angle)
    normals, luminance_albedo = _seen(source, size, mesh_reading)
    mask = np.asarray(normals.any(axis=-1))
    reflectance = luminance_albedo if albedo == "mesh" else mask.astype(normals.dtype)
    found = theory.analytic_pca(
        normals, reflectance, light=distribution, max_degree=max_degree, subtract_mean=subtract_mean
    )
    result: dict[str, object] = {
        "eigenvalue_fractions": found.fractions[:SHOWN].tolist(),
        "cumulative": found.cumulative[:SHOWN].tolist(),
        "light": light,
        "degree": max_degree,
        "mean_subtracted": subtract_mean,
        "albedo": albedo,
        "pixels": int(mask.sum()),
        "mean_squared_normal": np.square(normals[mask]).mean(axis=0).tolist(),
    }
    rows = {"analytic": found.modes(min(MODES, len(found.expansion)))}
    fractions = {"analytic": found.fractions}
    if empirical:
        directions = _random_cone(empirical, half_angle)
        images = theory.attached_shadow_pca(
            normals, directions, reflectance, count=SHOWN, subtract_mean=subtract_mean
        )
        compared = theory.compare(found, images, min(MODES, len(found.expansion)))
        interval = theory.bootstrap_interval(images)
        result["empirical"] = {
            "images": empirical,
            "eigenvalue_fractions": images.fractions[:SHOWN].tolist(),
            "interval_95": interval[:, :SHOWN].T.tolist(),
            "principal_angles_degrees": compared.principal_angles.tolist(),
            "mode_correlations": compared.correlations.tolist(),
        }
        signs = np.sign(compared.correlations)[:, None, None]
        rows["empirical"] = images.modes[: len(signs)] * signs
        fractions["empirical"] = images.fractions
    if figure is not None:
        from harmface.viz import modes_figure, write_figure

        write_figure(figure, modes_figure(rows, fractions, mask), dpi=dpi)
    if as_json:
        typer.echo(json.dumps(result, indent=1))
        return
    table = Table("mode", *fractions, "cumulative")
    for mode in range(min(SHOWN, len(found.fractions))):
        shares = [f"{shares[mode]:.4f}" for shares in fractions.values()]
        table.add_row(str(mode + 1), *shares, f"{found.cumulative[mode]:.4f}")
    output.print(table)


def _half_angle(light: str) -> float:
    """Return the half angle, in degrees, of the cone that a kind of light fills."""
    named = {"uniform": 180.0, "front": 90.0}
    try:
        degrees = named[light] if light in named else float(light.removeprefix("cone:"))
    except ValueError:
        degrees = np.nan
    if not 0 < degrees <= 180 or not (light in named or light.startswith("cone:")):
        raise ArgumentError(
            f"--light must be uniform, front or cone:DEGREES (up to 180), got {light!r}"
        )
    return degrees


def _random_cone(count: int, half_angle: float) -> np.ndarray:
    """Return random directions, uniform on a cap about the viewing axis."""
    rng = np.random.default_rng(0)
    z = rng.uniform(np.cos(np.radians(half_angle)), 1, count)
    azimuth = rng.uniform(0, 2 * np.pi, count)
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def _seen(source: Path, size: int, mesh_reading: MeshReading) -> tuple[np.ndarray, np.ndarray]:
    """Return the normals and the luminance of the albedo of what is seen."""
    from harmface.conventions import luminance
    from harmface.geometry import frame_orthographic, gbuffer
    from harmface.io import read_npz

    if source.suffix.lower() == ".npz":
        if mesh_reading != MeshReading():
            raise ArgumentError(
                f"{source}: is no mesh, so that options on how to read a mesh do not apply"
            )
        arrays, _ = read_npz(source, basis.KIND, basis.VERSION)
        try:
            return arrays["normals"], arrays["albedo"]
        except KeyError as error:
            raise FileError(f"{source}: holds no {error}; make it again") from None
    mesh = mesh_reading.load(source)
    view = gbuffer(mesh, frame_orthographic(mesh, size))
    return view.normals, luminance(view.albedo)
