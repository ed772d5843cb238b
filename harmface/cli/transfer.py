"""`harmface transfer`: how light reaches a mesh, with its shadows and reflections on itself."""

from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer

from harmface import checks
from harmface.cli.common import (
    MaxDegreeOption,
    SchedulerOption,
    WorkersOption,
    claim_outputs,
    errors,
    output,
    progress,
    told,
    working,
)
from harmface.cli.mesh_options import MeshArgument, MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError
from harmface.geometry import Mesh

MUCH_BACK = 0.02
"""Share of rays ending on the inner side of the surface from which on that is said."""


@with_options("mesh_reading", MeshReading)
def transfer(
    mesh: MeshArgument,
    out: Annotated[Path, typer.Option(help="NPZ file: transfer (channels,K,V), standard_errors.")],
    max_degree: MaxDegreeOption = 4,
    bounces: Annotated[
        str,
        typer.Option(metavar="N|all", help="How often light goes from the surface to itself."),
    ] = "2",
    samples: Annotated[
        int | None, typer.Option(help="Directions over the whole sphere; 8192 by default.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the directions.")] = 0,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    *,
    mesh_reading: MeshReading,
) -> None:
    """Precompute how every harmonic of distant light reaches the vertices of a mesh.

    Cast shadows and light that the surface reflects to itself are in it; `render --transfer` shows
    the mesh under any environment by it. A run that was stopped goes on where it was.

    Example: harmface transfer head.glb --max-degree 4 --bounces 2 --out transfer.npz
    """
    from harmface.io import write_transfer
    from harmface.io.parts import Parts, digest
    from harmface.io.transfers import mesh_digest
    from harmface.rendering import transfer as precomputed
    from harmface.rendering.precomputed_transfer import SAMPLES
    from harmface.scale import kept

    checks.degree("--max-degree", max_degree)
    number = _bounces(bounces)
    samples = SAMPLES if samples is None else samples
    claim_outputs(out, inputs=mesh_reading.files(mesh))
    surface = mesh_reading.load(mesh)
    tell_defects(mesh.name, surface)
    request = {"mesh": mesh_digest(surface), "degree": max_degree, "samples": samples, "seed": seed}
    key = digest({**request, "bounces": number}, {"albedo": surface.albedo})
    parts = Parts(out.parent, key, out.name)

    albedo = surface.albedo.T if number else None
    with working(workers, scheduler) as engine, progress("casting rays") as report:
        found = precomputed(
            surface,
            max_degree,
            bounces=number,
            albedo=albedo,
            samples=samples,
            rng=seed,
            progress=report,
            keep=partial(kept, parts, engine),
        )
    write_transfer(out, found, surface)
    parts.clear()
    error = np.sqrt(np.mean(found.standard_errors[..., 0, :] ** 2))
    share = error / found.coefficients[..., 0, :].mean()
    output.print(
        f"{found.coefficients.shape[-2]} coefficients of {len(surface.vertices)} vertices in "
        f"{out}; standard error of degree 0: {share:.2%}"
    )
    if number and found.back_share > MUCH_BACK:
        errors.print(
            f"note: {found.back_share:.0%} of the rays that the surface stops end on its inner "
            "side, which is taken as black: it has holes, or is inside out (--flip-normals)",
            highlight=False,
            soft_wrap=True,
        )


def tell_defects(name: str, mesh: Mesh) -> None:
    """Say on stderr what keeps a mesh from being the surface of a solid, and what comes of it."""
    from harmface.geometry import mesh_defects

    defects = mesh_defects(mesh)
    notes = {
        "edges bound holes: light passes through them": defects.open_edges,
        "faces have no area, and stop no light": defects.degenerate_faces,
        "faces are turned away from their vertices' normals: on that side they are black": (
            defects.inward_faces
        ),
    }
    with told() as tell:
        for note, count in notes.items():
            if count:
                tell(f"{name}: {count} {note}")


def _bounces(text: str) -> int | Literal["all"]:
    if text == "all":
        return "all"
    if not text.isdigit():
        raise ArgumentError(f"--bounces must be a whole number or all, got {text!r}")
    return int(text)
