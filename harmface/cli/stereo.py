"""`harmface stereo`: a surface from photographs under changing light."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from jaxtyping import Float

from harmface.cli.common import MaxPixelsOption, output, pixel_limit, progress, told
from harmface.cli.lamps import LampOptions, check_lamp_options, with_lamps
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError

if TYPE_CHECKING:
    from harmface.geometry import PerspectiveCamera
    from harmface.io import Capture
    from harmface.stereo import StereoResult

METHODS = ("4d", "9d", "refined", "known-lights")


@with_options("lamps", LampOptions)
def stereo(
    images: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGES...",
            help="Photographs of a still object, or a folder: DiLiGenT, one Yale subject, or any.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder to make; it must not hold other files.")],
    mask: Annotated[
        Path | None,
        typer.Option(
            help="Image that is white on the object; else *mask.* beside the photographs, else "
            "what stands out of a dark background."
        ),
    ] = None,
    method: Annotated[
        str,
        typer.Option(
            help="refined (unknown light), 4d or 9d (the same for matte objects, closed forms), or "
            "known-lights."
        ),
    ] = "refined",
    gamma: Annotated[
        str | None,
        typer.Option(
            help="How the photographs are encoded, linear or srgb, whatever their files say; by "
            "default what each file says, and linear if it says nothing."
        ),
    ] = None,
    symmetric: Annotated[
        bool, typer.Option("--symmetric", help="The object is symmetric about its vertical axis.")
    ] = False,
    normals_known: Annotated[
        Path | None,
        typer.Option(
            help="Table for refined, a line a pixel whose normal was measured: column row x y z "
            "(from 0 at the top left; x right, y up, z towards the camera)."
        ),
    ] = None,
    directions_known: Annotated[
        Path | None,
        typer.Option(
            help="Table for refined, a line a lamp whose direction was measured: number of the "
            "photograph (from 1), x y z."
        ),
    ] = None,
    smoothness: Annotated[
        float | None,
        typer.Option(
            help="Fit refined or known-lights normals once more as those of one surface whose "
            "slopes change by about 1/SMOOTHNESS a pixel: 1 evens out noise, 3 is for few or "
            "noisy photographs."
        ),
    ] = None,
    focal: Annotated[
        float | None,
        typer.Option(
            help="Focal length in pixels, for the depth of a perspective view whose axis meets "
            "the middle of the picture."
        ),
    ] = None,
    mesh_format: Annotated[
        str,
        typer.Option(help="ply or glb (albedo as vertex colours), or obj (albedo as texture)."),
    ] = "ply",
    max_pixels: MaxPixelsOption = None,
    *,
    lamps: LampOptions,
) -> None:
    """Recover normals, albedo and depth from photographs under unknown or known light.

    Photographs are PNG, TIFF, PGM, TGA, JPEG, BMP or WebP, in the order of the numbers in their
    names; colour is turned to luminance (but see --coloured-lamps). What is clipped, at the largest
    code or at a common one below it, counts as not seen. Of the light's directions only
    known-lights makes use; where intensities are known the photographs are divided by them. A
    mirror sphere (--chrome-ball, --chrome-ball-mask) tells the directions too; near lamps are given
    as positions (--near-lamps).

    Example: harmface stereo photos/*.png --mask mask.png --method refined --out surface
    """
    from harmface.geometry import depth_least_squares, depth_to_mesh, facing_camera
    from harmface.io import (
        MESH_FILES,
        atomic_write,
        output_folder,
        prepare_folder,
        read_capture,
        read_measured_directions,
        read_measured_normals,
        surface_files,
        write_surface,
    )
    from harmface.stereo import object_mask, photometric_stereo
    from harmface.stereo.homogeneous import directions_of
    from harmface.viz import stereo_figure, write_figure

    _require("--method", method, METHODS)
    if gamma is not None:
        _require("--gamma", gamma, ("linear", "srgb"))
    srgb = None if gamma is None else gamma == "srgb"
    _require("--mesh-format", mesh_format, tuple(MESH_FILES))
    check_lamp_options(lamps, method)
    if focal is not None and not 0 < focal < np.inf:
        raise ArgumentError(f"--focal must be a positive number of pixels, got {focal}")
    names = [*surface_files(mesh_format), "figure.png", "summary.json"]
    if out.exists():
        prepare_folder(out, names)
    with told(), progress("reading") as report:
        capture = read_capture(
            images,
            srgb=srgb,
            mask=mask,
            lights=lamps.lights,
            positions=lamps.near_lamps,
            coloured=lamps.coloured_lamps,
            aside=lamps.chrome_ball_mask,
            max_pixels=pixel_limit(max_pixels),
            report=report,
        )
        capture = with_lamps(capture, lamps, srgb=srgb, max_pixels=pixel_limit(max_pixels))
    known = method == "known-lights"
    if known and capture.lights is None:
        raise ArgumentError(
            "--method known-lights needs --lights, a mirror sphere (--chrome-ball), or photographs "
            "whose names or folder tell the lights"
        )
    notes = list(capture.notes)
    seen = capture.mask
    if seen is None:
        seen = object_mask(capture.images)
        if seen is not None:
            notes.append(
                f"no mask was given: the object is what stands out of a dark background, "
                f"{seen.mean():.0%} of the picture; --mask says better"
            )
    normals = directions = None
    if normals_known is not None:
        normals = read_measured_normals(normals_known, capture.images.shape[1:])
    if directions_known is not None:
        directions = read_measured_directions(directions_known, len(capture.images))
    camera = None if focal is None else _camera(focal, capture.images.shape[1:])
    with progress("solving") as report:
        found = photometric_stereo(
            capture.images,
            seen,
            method=method,
            light=capture.lights if known and capture.distances is None else None,
            positions=_positions(capture),
            strengths=capture.strengths if known else None,
            normals_known=normals,
            directions_known=directions,
            symmetric=symmetric,
            saturated=capture.saturated,
            smoothness=smoothness,
            progress=report,
        )
        # At the rim noise may turn a normal away from the camera: no depth has such a slope.
        facing = facing_camera(found.normals, found.mask, camera)
        depth = depth_least_squares(found.normals, facing, camera=camera)
        mesh = depth_to_mesh(depth, facing, found.albedo, camera)
    notes += _notes(capture, found, known)
    summary = {
        "images": len(capture.names),
        "pixels": int(found.mask.sum()),
        "saturated_share": float(capture.saturated[:, found.mask].mean()),
        "pixels_with_depth": int(facing.sum()),
        "depth": "height in pixels" if camera is None else "distance in units of its mean",
        "median_expected_error_degrees": float(np.median(found.expected_error[found.mask])),
        **asdict(found.report),
        **_errors(capture, found),
        "lamp_directions": None if found.lamps is None else directions_of(found.lamps).tolist(),
        "photographs": capture.names,
        "notes": notes,
    }
    figure = stereo_figure(capture.images, found.normals, found.albedo, depth, found.mask, mesh)
    with output_folder(out, names):
        write_surface(out, found, depth, mesh, facing, mesh_format)
        write_figure(out / "figure.png", figure)
        with atomic_write(out / "summary.json") as file:
            file.write(json.dumps(summary, indent=1).encode() + b"\n")
    for note in notes:
        output.print(f"note: {note}", soft_wrap=True)
    for name, value in summary.items():
        if isinstance(value, int | float | str) and not isinstance(value, bool):
            shown = f"{value:.4g}" if isinstance(value, float) else str(value)
            output.print(f"{name.replace('_', ' ')}: {shown}")
    for cue in found.report.cues:
        output.print(f"cue {cue.name}: {'believed' if cue.accepted else 'not believed'}")
    output.print(f"surface in {out}")


def _require(option: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise ArgumentError(f"{option} must be one of {', '.join(choices)}, got {value!r}")


def _positions(capture: "Capture") -> Float[np.ndarray, "F 3"] | None:
    """Return the lamps' positions, if their directions came with distances."""
    if capture.lights is None or capture.distances is None:
        return None
    return capture.lights * capture.distances[:, None]


def _camera(focal: float, shape: tuple[int, ...]) -> "PerspectiveCamera":
    from harmface.geometry import PerspectiveCamera

    rows, columns = shape
    field_of_view = float(2 * np.degrees(np.arctan(rows / 2 / focal)))
    return PerspectiveCamera((0.0, 0.0, 0.0), field_of_view, (rows, columns))


def _errors(capture: "Capture", found: "StereoResult") -> dict[str, float]:
    """Return the errors of the normals, if the true ones are known."""
    from harmface.stereo import angular_errors

    if capture.truth is None:
        return {}
    error = angular_errors(found.normals[found.mask], capture.truth[found.mask])
    return {
        "mean_angular_error_degrees": float(error.mean()),
        "median_angular_error_degrees": float(np.median(error)),
    }


def _notes(capture: "Capture", found: "StereoResult", known: bool) -> list[str]:
    """Return what the user should know of the result."""
    from harmface.stereo import seems_upside_down

    notes = list(found.report.warnings)
    if capture.lights is not None and not known:
        notes.append("the directions of the lights are not used: --method known-lights does that")
    if known and seems_upside_down(found.normals, found.mask):
        notes.append(
            "the normals fit a surface better upside down: the lights' y axis must point up; "
            "negate y if it points down"
        )
    return notes
