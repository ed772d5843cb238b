"""`harmface stereo`: a surface from photographs under changing light."""

import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from harmface.cli.common import errors, output
from harmface.errors import ArgumentError

METHODS = ("4d", "9d", "refined", "known-lights")
NAMES = ("normals.npy", "albedo.npy", "depth.npy", "confidence.npy")
OTHERS = ("mask.png", "mesh.ply", "summary.json", "figure.png")


def stereo(
    images: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGES...",
            help="Photographs of a still object, or a folder: DiLiGenT, one Yale subject, or any.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder to make; it must not hold other files.")],
    mask: Annotated[Path | None, typer.Option(help="Image that is white on the object.")] = None,
    method: Annotated[
        str,
        typer.Option(
            help="4d or 9d (Basri-Jacobs, unknown light), refined (unknown light, further), or "
            "known-lights."
        ),
    ] = "refined",
    lights: Annotated[
        Path | None, typer.Option(help="Text file: x y z to the light, a line an image.")
    ] = None,
    gamma: Annotated[
        str, typer.Option(help="How the photographs are encoded: linear or srgb.")
    ] = "linear",
    symmetric: Annotated[
        bool, typer.Option("--symmetric", help="The object is symmetric about its vertical axis.")
    ] = False,
) -> None:
    """Recover normals, albedo and depth from photographs under unknown or known light.

    Example: harmface stereo photos/*.png --mask mask.png --method refined --out surface
    """
    from harmface.geometry import depth_least_squares, depth_to_mesh
    from harmface.io import (
        atomic_write,
        prepare_folder,
        read_capture,
        read_lights,
        read_mask,
        write_image,
        write_ply,
    )
    from harmface.stereo import angular_errors, photometric_stereo
    from harmface.viz import stereo_figure, write_figure

    if method not in METHODS:
        raise ArgumentError(f"--method must be one of {', '.join(METHODS)}, got {method!r}")
    if gamma not in ("linear", "srgb"):
        raise ArgumentError(f"--gamma must be linear or srgb, got {gamma!r}")
    capture = read_capture(images, srgb=gamma == "srgb")
    object_mask = capture.mask if mask is None else read_mask(mask)
    light = capture.lights if lights is None else read_lights(lights, len(capture.names))
    known = method == "known-lights"
    if known and light is None:
        raise ArgumentError(
            "--method known-lights needs --lights, or photographs whose names or folder tell them"
        )
    with errors.status("solving"):
        found = photometric_stereo(
            capture.images,
            object_mask,
            light=light if known else None,
            order=1 if method == "4d" else 2,
            refine=method == "refined",
            symmetric=symmetric,
            robust=known,
        )
        # At the rim noise may turn a normal away from the camera: no depth has such a slope.
        facing = found.mask & (found.normals[..., 2] > 0)
        depth = depth_least_squares(found.normals, facing)
    summary: dict[str, object] = {
        "images": len(capture.names),
        "pixels": int(found.mask.sum()),
        "pixels_with_depth": int(facing.sum()),
        "median_expected_error_degrees": float(np.median(found.expected_error[found.mask])),
        **asdict(found.report),
    }
    if capture.truth is not None:
        error = angular_errors(found.normals[found.mask], capture.truth[found.mask])
        summary["mean_angular_error_degrees"] = float(error.mean())
        summary["median_angular_error_degrees"] = float(np.median(error))
    prepare_folder(out, [*NAMES, *OTHERS])
    arrays = (found.normals, found.albedo, depth, found.confidence)
    for name, array in zip(NAMES, arrays, strict=True):
        buffer = io.BytesIO()
        np.save(buffer, array, allow_pickle=False)
        with atomic_write(out / name) as file:
            file.write(buffer.getvalue())
    write_image(out / "mask.png", found.mask.astype(float), bits=8)
    write_ply(out / "mesh.ply", depth_to_mesh(depth, facing, found.albedo))
    figure = stereo_figure(capture.images, found.normals, found.albedo, depth, found.mask)
    write_figure(out / "figure.png", figure)
    with atomic_write(out / "summary.json") as file:
        file.write(json.dumps(summary, indent=1).encode() + b"\n")
    for warning in found.report.warnings:
        output.print(f"note: {warning}", soft_wrap=True)
    for name, value in summary.items():
        if isinstance(value, int | float | str) and not isinstance(value, bool):
            shown = f"{value:.4g}" if isinstance(value, float) else str(value)
            output.print(f"{name.replace('_', ' ')}: {shown}")
    output.print(f"surface in {out}")
