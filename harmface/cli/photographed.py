"""How the commands on light in photographs are told the surface: a mesh, or normals."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from harmface.cli.common import MaxPixelsOption, SrgbOption, pixel_limit, told
from harmface.cli.mesh_options import MeshReading
from harmface.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from harmface.inverse import PhotographedSurface

PhotoArgument = Annotated[Path, typer.Argument(metavar="PHOTO", help="The photograph.")]

ALBEDOS = ("mesh", "constant", "unknown")


@dataclass(frozen=True)
class SurfaceReading:
    """The options that say what surface a photograph shows; each field is one of them."""

    mesh: Annotated[
        Path | None,
        typer.Option(help="PLY, OBJ, GLB, glTF or STL of the surface, framed as `render` does."),
    ] = None
    normals: Annotated[
        Path | None,
        typer.Option(
            help="Normal of every pixel instead: .npy (rows, columns, 3) as `stereo` writes, or a "
            "picture of (n + 1) / 2; zeros, or black, in the background."
        ),
    ] = None
    albedo: Annotated[
        str | None,
        typer.Option(
            metavar="mesh|constant|unknown|FILE",
            help="Albedo: the mesh's colours (default if it has any), unknown (default otherwise), "
            "the same everywhere, or an image or .npy of it.",
        ),
    ] = None
    mask: Annotated[
        Path | None, typer.Option(help="Image that is white where the surface is matte skin.")
    ] = None
    landmarks: Annotated[
        Path | None,
        typer.Option(
            help="Text with a line for each landmark: column row x y z, pixels and place on the "
            "mesh. Two or more place the mesh, four or more turn it."
        ),
    ] = None
    align: Annotated[
        bool, typer.Option("--align", help="Place the mesh so that its outline fills the --mask.")
    ] = False
    cast_shadows: Annotated[bool, typer.Option(help="Whether a mesh shadows itself.")] = True
    srgb: SrgbOption = False
    max_pixels: MaxPixelsOption = None

    def albedo_unknown(self, surface: "PhotographedSurface") -> bool:
        """Return whether the albedo is to be found with the light."""
        return self.albedo == "unknown" or (self.albedo is None and surface.albedo is None)

    def files(self, photo: Path) -> list[Path]:
        """Return all files that are read."""
        given = [photo, self.mesh, self.normals, self.mask, self.landmarks]
        if self.albedo is not None and self.albedo not in ALBEDOS:
            given.append(Path(self.albedo))
        return [path for path in given if path is not None]

    def load_photo(self, photo: Path) -> np.ndarray:
        """Return the linear photograph."""
        from harmface.io import read_image

        with told():
            return read_image(photo, srgb=self.srgb, max_pixels=pixel_limit(self.max_pixels))

    def load_surface(
        self, shape: tuple[int, int], mesh_reading: MeshReading
    ) -> "PhotographedSurface":
        """Return the surface that a photograph of so many rows and columns shows."""
        from harmface.inverse import (
            PhotographedSurface,
            camera_from_mask,
            pose_from_landmarks,
        )
        from harmface.io import read_albedo_map, read_mask, read_normal_map
        from harmface.io.tables import read_table

        if (self.mesh is None) == (self.normals is None):
            raise ArgumentError("give either --mesh MESH or --normals FILE")
        if self.mesh is None and (self.landmarks is not None or self.align):
            raise ArgumentError("--landmarks and --align place a mesh; give --mesh")
        if self.align and (self.mask is None or self.landmarks is not None):
            raise ArgumentError("--align needs a --mask, and no --landmarks beside it")
        mask = None if self.mask is None else read_mask(self.mask)
        if mask is not None and mask.shape != shape:
            raise FileError(
                f"{self.mask}: has {_size(mask.shape)} pixels, the photograph {_size(shape)}"
            )
        if self.mesh is not None:
            mesh = mesh_reading.load(self.mesh)
            frame: object = shape
            if self.landmarks is not None:
                numbers = read_table(self.landmarks).numbers
                if numbers.shape[1] != 5:
                    raise FileError(
                        f"{self.landmarks}: must have five numbers a line, column row x y z, "
                        f"got {numbers.shape[1]}"
                    )
                mesh, frame = pose_from_landmarks(mesh, numbers[:, :2], numbers[:, 2:], shape)
            elif self.align:
                assert mask is not None
                frame = camera_from_mask(mesh, mask)
            surface = PhotographedSurface.of_mesh(mesh, frame, cast_shadows=self.cast_shadows)  # type: ignore[arg-type]
        else:
            assert self.normals is not None
            normals = read_normal_map(self.normals)
            if normals.shape[:2] != shape:
                raise FileError(
                    f"{self.normals}: has {_size(normals.shape)} normals, the photograph "
                    f"{_size(shape)} pixels; give normals of the same photograph"
                )
            surface = PhotographedSurface.of_normals(normals)
        if mask is not None:
            surface = surface.within(mask)
        if self.albedo == "mesh" and (self.mesh is None or surface.albedo is None):
            raise ArgumentError("--albedo mesh needs a --mesh with colours")
        if self.albedo in ("constant", "unknown"):
            surface = replace(surface, albedo=None)
        elif self.albedo not in (None, "mesh"):
            albedo = read_albedo_map(self.albedo)
            if albedo.shape[:2] != shape:
                raise FileError(
                    f"{self.albedo}: has {_size(albedo.shape)} pixels, the photograph "
                    f"{_size(shape)}"
                )
            surface = replace(surface, albedo=albedo)
        return surface


def _size(shape: tuple[int, ...]) -> str:
    return f"{shape[0]} x {shape[1]}"
