"""`harmface view`: a page that shows an object under light that turns."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harmface import checks
from harmface.cli.common import claim_outputs, output, progress, told
from harmface.cli.light_source import EnvironmentReading
from harmface.cli.mesh_options import MeshReading
from harmface.cli.option_groups import with_options
from harmface.errors import ArgumentError
from harmface.light import EnvironmentMap

if TYPE_CHECKING:
    from harmface.geometry import Mesh
    from harmface.viz import Viewer

GALLERY_SUFFIX = ".npz"
REFERENCE_DIRECTIONS = 600
"""Lights that a map is gathered to for brute force, as `harmface render` does."""


@dataclass(frozen=True)
class MeshExtras:
    """The options of a page of a mesh alone."""

    reference: Annotated[
        bool,
        typer.Option(
            "--reference",
            help="Bake in each vertex's irradiance under the map by brute force, cast shadows "
            "included, to see what nine coefficients leave out.",
        ),
    ] = False
    transfer: Annotated[
        Path | None,
        typer.Option(
            metavar="NPZ",
            help="Transfer vectors of the vertices: shadows and bounces under light that turns.",
        ),
    ] = None
    decimate: Annotated[
        int | None,
        typer.Option(metavar="N", help="Show a mesh of about N vertices in place of a finer one."),
    ] = None

    def __post_init__(self) -> None:
        if self.decimate is not None:
            checks.integer("--decimate", self.decimate, 4)
            if self.transfer is not None:
                raise ArgumentError(
                    "--transfer belongs to the vertices that --decimate leaves out; "
                    "give one of them"
                )


@with_options("extras", MeshExtras)
@with_options("mesh_reading", MeshReading)
@with_options("reading", EnvironmentReading)
def view(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="MESH|SURFACE|GALLERY",
            help="A PLY, OBJ, GLB, glTF or STL file, y up, facing +z; a folder of `harmface "
            "stereo`; or a gallery of meshes, .npz, of `harmface enroll`.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="HTML file to write.")],
    environment: Annotated[
        Path | None,
        typer.Option(
            "--environment",
            "--coefficients",
            metavar="MAP|COEFFICIENTS|PROBE",
            help="Environment map, also shown behind the object; coefficients (.json of `envmap "
            "project`, or copied from a page); or grace, eucalyptus, st-peters.",
        ),
    ] = None,
    subject: Annotated[
        str | None, typer.Option(help="Whom to show of a gallery; the first by default.")
    ] = None,
    *,
    extras: MeshExtras,
    reading: EnvironmentReading,
    mesh_reading: MeshReading,
) -> None:
    """Make a page that shows an object under light that turns, with sliders for its nine numbers.

    The page is one file, needs no network, and opens by a double click. Irradiance is
    E = n^T M n of the light's nine coefficients (RH01 eq. 11) at every pixel; drag turns the
    object, shift-drag the light.

    Example: harmface view head.glb --environment forest.hdr --out view.html
    """
    from harmface.reproduce.synthetic import procedural_lights

    claim_outputs(
        out,
        inputs=[*mesh_reading.files(source), *filter(None, [environment, extras.transfer])],
    )
    light = None if environment is None else reading.load_light(environment)
    shared: dict[str, Any] = {
        "light": light,
        "light_name": "" if environment is None else environment.name,
        "presets": procedural_lights(),
    }
    if (source.is_dir() or source.suffix.lower() == GALLERY_SUFFIX) and extras != MeshExtras():
        raise ArgumentError(
            "--reference, --transfer and --decimate are for meshes; give the mesh itself"
        )
    if source.suffix.lower() == GALLERY_SUFFIX:
        page = _subject_page(source, subject, shared)
    elif subject is not None:
        raise ArgumentError(f"--subject is for galleries (.npz); {source} is none")
    elif source.is_dir():
        page = _surface_page(source, shared)
    else:
        page = _mesh_page(mesh_reading.load(source), source.name, extras, shared)
    page.write(out)
    output.print(f"{page.vertices} vertices, {len(page.html) / 1e6:.1f} MB in {out}")


def _mesh_page(mesh: "Mesh", title: str, extras: MeshExtras, shared: dict[str, Any]) -> "Viewer":
    from harmface.io import read_transfer
    from harmface.rendering import vertex_irradiance
    from harmface.viz import decimated, viewer

    if extras.decimate is not None:
        with progress("decimating"):
            mesh = decimated(mesh, extras.decimate)
    transfer = reference = None
    if extras.transfer is not None:
        transfer = read_transfer(extras.transfer, mesh).coefficients
    if extras.reference:
        light = shared["light"]
        if not isinstance(light, EnvironmentMap):
            raise ArgumentError("--reference needs a map (--environment); coefficients cannot tell")
        with progress("brute force") as report:
            reference = vertex_irradiance(
                mesh, light.as_distant_light(REFERENCE_DIRECTIONS), progress=report
            )
    return viewer(mesh, title=title, transfer=transfer, reference=reference, **shared)


def _surface_page(folder: Path, shared: dict[str, Any]) -> "Viewer":
    from harmface.io import read_surface
    from harmface.viz import confidence_colours, viewer

    with told():
        surface = read_surface(folder)
    colours = {"confidence": confidence_colours(surface.confidence)}
    return viewer(surface.mesh, title=folder.resolve().name, colours=colours, **shared)


def _subject_page(path: Path, subject: str | None, shared: dict[str, Any]) -> "Viewer":
    from harmface.io import read_gallery
    from harmface.viz import subject_viewer

    gallery = read_gallery(path).gallery_
    return subject_viewer(gallery, str(gallery.names[0]) if subject is None else subject, **shared)
