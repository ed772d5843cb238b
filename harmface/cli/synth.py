"""`harmface synth`: procedural faces, shapes, environments, and data sets made of them."""

import os
from pathlib import Path
from typing import Annotated

import typer

from harmface.cli.common import (
    SchedulerOption,
    WorkersOption,
    claim_outputs,
    output,
    progress,
    read_apart,
    working,
)
from harmface.errors import FileError

app = typer.Typer(
    help="Make procedural faces, shapes, environments and data sets.", no_args_is_help=True
)
OutOption = Annotated[Path, typer.Option(help="Folder to make; it must not hold other files.")]


@app.command()
def faces(
    out: OutOption,
    count: Annotated[int, typer.Option(help="Number of subjects.")] = 12,
    seed: Annotated[int, typer.Option(help="Seed of the population.")] = 0,
    sheet: Annotated[
        Path | None, typer.Option(help="PNG: all heads side by side in one soft light.")
    ] = None,
) -> None:
    """Make heads as PLY files, with linear albedo as vertex colours, and a manifest.

    Example: harmface synth faces --count 24 --seed 7 --sheet sheet.png --out heads
    """
    from harmface.reproduce.contact_sheet import contact_sheet
    from harmface.reproduce.synthetic import synthesize_faces

    if sheet is not None and not read_apart(Path(os.path.realpath(sheet)), [out.resolve()]):
        raise FileError(f"{sheet}: lies in {out}, which holds heads only; give another folder")
    claim_outputs(sheet)
    with progress("heads") as report:
        synthesize_faces(out, count, seed, report)
    if sheet is not None:
        from harmface.io import read_mesh, write_image

        with progress("sheet") as report:
            meshes = [read_mesh(path) for path in sorted(out.glob("face_*.ply"))[:count]]
            write_image(sheet, contact_sheet(meshes, report), bits=8, srgb=True)
    output.print(f"{count} heads in {out}")


@app.command()
def shapes(out: OutOption) -> None:
    """Make the canonical shapes (sphere, cylinder, vase, ...) as PLY files, and a manifest.

    Example: harmface synth shapes --out shapes
    """
    from harmface.reproduce.synthetic import synthesize_shapes

    with progress("shapes") as report:
        synthesize_shapes(out, report)
    output.print(f"shapes in {out}")


@app.command()
def environments(
    out: OutOption,
    size: Annotated[int, typer.Option(help="Columns of the maps; half as many rows.")] = 512,
) -> None:
    """Make the procedural environments as lat-long maps (.hdr), and a manifest.

    The manifest holds the exact lighting coefficients to degree 4 of each.

    Example: harmface synth environments --size 512 --out env
    """
    from harmface.reproduce.synthetic import synthesize_environments

    with progress("environments") as report:
        synthesize_environments(out, size, report)
    output.print(f"environments in {out}")


@app.command()
def scene(
    out: Annotated[Path, typer.Option(help="TOML file to write.")],
) -> None:
    """Write a scene of three coloured lamps near an object of any size, to be edited.

    Example: harmface synth scene --out scene.toml
    """
    from data_synth.scenes import THREE_LAMPS
    from harmface.io import atomic_write

    claim_outputs(out)
    with atomic_write(out) as file:
        file.write(THREE_LAMPS.encode())
    output.print(f"three lamps in {out}")


@app.command()
def dataset(
    out: Annotated[Path, typer.Option(help="Folder to make, or to finish.")],
    identities: Annotated[int, typer.Option(help="Number of subjects.")] = 100,
    lightings: Annotated[
        str, typer.Option(help="yale64, ninepoints, mixed or environments.")
    ] = "yale64",
    size: Annotated[int, typer.Option(help="Rows and columns of the images.")] = 96,
    seed: Annotated[int, typer.Option(help="Seed of everything random.")] = 0,
    identity_scale: Annotated[
        float, typer.Option(help="0: all look like the mean face; 1: natural.")
    ] = 1.0,
    noise: Annotated[
        float, typer.Option(help="Noise of a white pixel as a share of white, such as 0.01.")
    ] = 0.0,
    cast_shadows: Annotated[bool, typer.Option(help="Whether heads shadow themselves.")] = True,
    meshes: Annotated[bool, typer.Option("--meshes", help="Write each subject's mesh.")] = False,
    gbuffers: Annotated[
        bool, typer.Option("--gbuffers", help="Write normals, albedo, depth of each subject.")
    ] = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
) -> None:
    """Render a labelled data set: 16-bit linear PNGs, masks, and a manifest of everything.

    A run that was stopped goes on where it was when the same command is given again, and ends
    with the same bytes, wherever it is rendered: in two processes by default, or on Dask.

    Example: harmface synth dataset --identities 20 --lightings yale64 --seed 3 --out set

    Example: harmface synth dataset --identities 1000 --scheduler tcp://head:8786 --out set
    """
    from harmface.reproduce.datasets import Request, make_dataset

    request = Request(
        identities, lightings, size, seed, identity_scale, noise, cast_shadows, meshes, gbuffers
    )
    if workers is None and scheduler is None:
        with progress("rendering") as report:
            make_dataset(out, request, report)
    else:
        with working(workers, scheduler) as engine, progress("rendering") as report:
            make_dataset(out, request, report, engine=engine)
    output.print(f"{identities} subjects in {out}")


@app.command()
def film(
    environment: Annotated[Path, typer.Option(help="Map of the light, which stands still.")],
    out: OutOption,
    seed: Annotated[int, typer.Option("--seed", "--head", help="Which head.")] = 0,
    frames: Annotated[int, typer.Option(help="Number of frames.")] = 60,
    turn: Annotated[
        str, typer.Option(help="Range of yaw and of pitch, degrees; without one it stays at 0.")
    ] = "yaw:-30:30,pitch:-10:10",
    size: Annotated[int, typer.Option(help="Rows and columns of the frames.")] = 160,
    noise: Annotated[
        float, typer.Option(help="Noise of a white pixel as a share of white.")
    ] = 0.01,
    plain: Annotated[bool, typer.Option("--plain", help="The head has one albedo.")] = False,
) -> None:
    """Render a film of a turning head: 16-bit linear PNGs, masks, poses and the true surface.

    Camera and light stand still, the head casts shadows on itself, and the exposure is one.

    Example: harmface synth film --seed 4 --frames 60 --environment studio.hdr --out film
    """
    from harmface.io import read_environment_map
    from harmface.reproduce.films import synthesize_film

    light = read_environment_map(environment)
    with progress("rendering") as report:
        synthesize_film(
            out,
            light,
            seed=seed,
            frames=frames,
            turn=turn,
            size=size,
            noise=noise,
            plain=plain,
            progress=report,
        )
    output.print(f"{frames} frames in {out}")
