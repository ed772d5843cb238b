"""`harmface film`: a surface from a film of a moving object under light that stands still."""

import json
from pathlib import Path
from typing import Annotated

import typer

from harmface.cli.common import MaxPixelsOption, SrgbOption, output, pixel_limit, progress, told
from harmface.errors import ArgumentError


def film(
    frames: Annotated[
        list[Path],
        typer.Argument(
            metavar="FRAMES...", help="A folder of frames, the frames in order, or one video."
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder to make; it must not hold other files.")],
    cameras: Annotated[
        Path | None,
        typer.Option(
            help="NPY file (frames, 3, 4): cameras that project the object's points to column "
            "and row."
        ),
    ] = None,
    poses: Annotated[
        Path | None,
        typer.Option(
            help="CSV file, a line a frame: turn_x turn_y turn_z (rotation vector in degrees; x "
            "right, y up, z towards the camera), column row (where the object's origin is seen), "
            "scale (pixels to a unit)."
        ),
    ] = None,
    mask: Annotated[
        Path | None,
        typer.Option(
            help="Folder of masks with the frames' names; else the folder masks beside the "
            "frames, else what stands out of the background."
        ),
    ] = None,
    srgb: SrgbOption = False,
    max_pixels: MaxPixelsOption = None,
) -> None:
    """Recover surface, albedo and light from a film of an object that turns in fixed light.

    Camera and lamps stand still; how the object moves must be known, as cameras or as poses. It
    must turn: about two axes, or what it is lit by along the one axis is mixed with light from
    everywhere. Black and blurred frames are left out.

    Example: harmface film film --poses film/poses.csv --out head
    """
    from harmface.geometry import depth_to_mesh
    from harmface.io import (
        atomic_write,
        output_folder,
        prepare_folder,
        read_cameras,
        read_film,
        read_poses,
        surface_files,
        write_coefficients,
        write_ply,
        write_surface,
    )
    from harmface.moving import surface_from_film
    from harmface.viz import film_figure, write_figure

    if (cameras is None) == (poses is None):
        raise ArgumentError("give how the object moves: either --cameras or --poses")
    own = ["model.ply", "light.json", "cameras.npy", "figure.png", "summary.json"]
    names = [*surface_files("ply"), *own]
    if out.exists():
        prepare_folder(out, names)
    with told(), progress("reading") as report:
        film = read_film(
            frames, masks=mask, srgb=srgb, max_pixels=pixel_limit(max_pixels), report=report
        )
    notes = list(film.notes)
    if cameras is not None:
        views, mirrored = read_cameras(cameras, len(film.names))
        if mirrored:
            notes.append("the cameras' coordinates are left-handed: the z axis is turned over")
    else:
        assert poses is not None
        views = read_poses(poses, len(film.names))
    views = views[film.kept]
    if views.axes() == 1:
        notes.append(
            "the object turns about one axis only: brightness does not tell light along it from "
            "light from everywhere, nor a common turn of light and normals about it; the surface "
            "decides"
        )
    with progress("solving") as report:
        found = surface_from_film(film.grey, film.masks, views, progress=report)
    summary = {
        "frames": len(film.grey),
        "axes": found.axes,
        "turns_degrees": [float(each) for each in views.spread() * 180 / 3.141592653589793],
        "frame_of_the_maps": [n for n, k in zip(film.names, film.kept, strict=True) if k][
            found.frame
        ],
        "pixels": int(found.mask.sum()),
        "residual": found.residual,
        "residual_of_the_surface": found.shading_error,
        "depth": "height in pixels",
        "notes": notes,
    }
    mesh = depth_to_mesh(found.height, found.mask, found.albedo)
    figure = film_figure(film.grey, views, found)
    with output_folder(out, names):
        write_surface(out, found, found.height, mesh, found.mask)
        write_ply(out / "model.ply", found.mesh)
        write_coefficients(out / "light.json", found.lighting[None])
        with atomic_write(out / "cameras.npy") as file:
            file.write(views.as_npy())
        write_figure(out / "figure.png", figure)
        with atomic_write(out / "summary.json") as file:
            file.write(json.dumps(summary, indent=1).encode() + b"\n")
    for note in notes:
        output.print(f"note: {note}", soft_wrap=True)
    for name, value in summary.items():
        if isinstance(value, int | float | str):
            shown = f"{value:.4g}" if isinstance(value, float) else str(value)
            output.print(f"{name.replace('_', ' ')}: {shown}")
    output.print(f"surface in {out}")
