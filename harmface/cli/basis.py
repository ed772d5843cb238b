"""`harmface basis`: the harmonic images of a mesh."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from harmface import checks
from harmface.cli.common import (
    FIGURE_HELP,
    DpiOption,
    MaxDegreeOption,
    SizeOption,
    claim_outputs,
    output,
)
from harmface.cli.mesh_options import MeshArgument, MeshReading
from harmface.cli.option_groups import with_options

KIND, VERSION = "basis", 1


@with_options("mesh_reading", MeshReading)
def basis(
    mesh: MeshArgument,
    out: Annotated[Path, typer.Option(help="NPZ file: basis (K,H,W), normals, albedo, mask.")],
    size: SizeOption = 256,
    max_degree: MaxDegreeOption = 2,
    figure: Annotated[
        Path | None,
        typer.Option(help=f"Figure: green above zero, blue below, a row a degree. {FIGURE_HELP}"),
    ] = None,
    dpi: DpiOption = None,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Render the harmonic images albedo A_l Y_lm(n) of a mesh, seen from the front.

    Example: harmface basis head.glb --size 256 --out basis.npz --figure basis.png
    """
    from harmface.conventions import luminance
    from harmface.geometry import frame_orthographic, gbuffer
    from harmface.io import write_npz
    from harmface.rendering import harmonic_images

    checks.degree("--max-degree", max_degree)
    claim_outputs(out, figure, inputs=mesh_reading.files(mesh))
    surface = mesh_reading.load(mesh)
    view = gbuffer(surface, frame_orthographic(surface, size), supersampling=2)
    albedo = luminance(view.albedo)
    images = harmonic_images(view.normals, albedo, max_degree)
    if figure is not None:
        from harmface.viz import basis_figure, write_figure

        write_figure(figure, basis_figure(images, view.mask), dpi=dpi)
    arrays = {"basis": images, "normals": view.normals, "albedo": albedo, "mask": view.mask}
    write_npz(
        out, KIND, VERSION, {k: _single(v) for k, v in arrays.items()}, {"degree": max_degree}
    )
    output.print(f"{len(images)} images of {size} x {size} pixels in {out}")


def _single(array: np.ndarray) -> np.ndarray:
    """Return float64 as float32: a file for other programs needs no more."""
    return array.astype(np.float32) if array.dtype == np.float64 else array
