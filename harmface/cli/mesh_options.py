"""How the commands that take meshes read them: one set of options, and what is said of a mesh."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from harmface import checks
from harmface.cli.common import told
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, axis_rotations, face_rotation, outward_share, paints_a_face

MeshArgument = Annotated[
    Path,
    typer.Argument(metavar="MESH", help="A PLY, OBJ, GLB, glTF or STL file, y up, facing +z."),
]


@dataclass(frozen=True)
class MeshReading:
    """The options that say how a mesh is to be read; each field is one of them."""

    texture: Annotated[
        Path | None, typer.Option(help="Image to use as albedo; the mesh needs UV coordinates.")
    ] = None
    texture_linear: Annotated[
        bool,
        typer.Option(
            "--texture-linear",
            help="Textures are linear; those of 8 bits are taken as sRGB otherwise.",
        ),
    ] = False
    flip_texture: Annotated[
        bool, typer.Option("--flip-texture", help="Textures lie upside down: turn them over.")
    ] = False
    flip_normals: Annotated[
        bool, typer.Option("--flip-normals", help="The mesh is inside out: turn it round.")
    ] = False
    rotate: Annotated[
        str | None,
        typer.Option(
            metavar="AXIS:DEGREES",
            help="Turn the mesh first, counter-clockwise about x, y or z: y:180 where it faces -z.",
        ),
    ] = None
    max_texels: Annotated[
        int | None,
        typer.Option(metavar="N", help="Most pixels of a mesh's textures; 134 million by default."),
    ] = None
    srgb_colors: Annotated[
        bool,
        typer.Option(
            "--srgb-colors",
            help="Vertex and material colours are sRGB-encoded: make them linear.",
        ),
    ] = False

    def files(self, path: Path) -> list[Path]:
        """Return the files that are named on the command line and read with a mesh."""
        return [path] if self.texture is None else [path, self.texture]

    def load(self, path: Path) -> Mesh:
        """Read a mesh, and say on stderr what was assumed and what looks wrong."""
        # Slow to import; commands without a mesh do without.
        from harmface.io import read_mesh
        from harmface.io.meshes import MAX_TEXELS

        limit = self.max_texels
        if limit is not None:
            checks.positive_integer("--max-texels", limit)
        with told() as tell:
            mesh = read_mesh(
                path,
                texture=self.texture,
                texture_linear=self.texture_linear,
                flip_texture=self.flip_texture,
                flip_normals=self.flip_normals,
                srgb=self.srgb_colors,
                max_texels=MAX_TEXELS if limit is None else limit,
            )
            if self.rotate is not None:
                mesh = mesh.rotated(axis_rotations(self.rotate))
            for advice in self._advice(mesh):
                tell(f"{path.name}: {advice}")
        return mesh

    def _advice(self, mesh: Mesh) -> list[str]:
        """Return what other options would probably mend."""
        try:
            outward = outward_share(mesh)
        except ArgumentError:
            return []  # it has no extent across the view, and framing it says so
        found = []
        rotation = face_rotation(mesh)
        turned = ",".join(turn for turn in (self.rotate, rotation or "y:180") if turn)
        if outward < 0.5:
            flip = "try without --flip-normals" if self.flip_normals else "--flip-normals"
            found.append(
                f"{1 - outward:.0%} of what is seen from the front points away from the viewer "
                f"and stays black: the mesh is inside out ({flip}), or open and seen from behind "
                f"(--rotate {turned})"
            )
        elif rotation:
            found.append(f"a face is seen from another side: try --rotate {turned}")
        if mesh.texture is not None and not paints_a_face(mesh):
            uv = mesh.texture.uv * [1, -1] + [0, 1]
            if paints_a_face(replace(mesh, texture=replace(mesh.texture, uv=uv))):
                flip = "try without" if self.flip_texture else "try"
                found.append(
                    f"its texture shows a face when it is turned over: {flip} --flip-texture"
                )
        return found
