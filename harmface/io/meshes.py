"""Meshes from PLY, OBJ, GLB and STL files, and to PLY, GLB and OBJ, by way of trimesh."""

import json
import re
import struct
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float
from PIL import Image

from harmface import checks
from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh, vertex_normals
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes

MESH_SUFFIXES = (".ply", ".obj", ".glb", ".stl")

# What trimesh's parsers raise when bytes are not what the format says.
_PARSE_ERRORS = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    NotImplementedError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
    np.linalg.LinAlgError,
    struct.error,
    Image.DecompressionBombError,
)


def read_mesh(path: Path | str, *, texture: Path | str | None = None, srgb: bool = False) -> Mesh:
    """Read a mesh with its normals and albedo.

    Normals are the file's where it has them, else angle-weighted means of the faces'. Albedo is
    taken from vertex colours, or from a texture (bilinearly, at each vertex's UV), or from the
    material's base colour, else it is 1.

    Parameters
    ----------
    path
        A `.ply`, `.obj`, `.glb` or `.stl` file.
    texture
        An image to use as albedo instead of the file's own colours; the mesh needs UVs.
    srgb
        Whether colours are encoded in sRGB and should be made linear; they are taken as linear
        otherwise.

    Raises
    ------
    FileError
        If the file is missing, of another format, broken, or holds no surface.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise FileError(f"{path}: is not a mesh file; give one of {', '.join(MESH_SUFFIXES)}")
    data = read_bytes(path)
    _check_counts(path, suffix, data)
    picture = None if texture is None else _read_texture(Path(texture))
    try:
        with warnings.catch_warnings():
            # numpy warns of overflow and NaN in what is refused below.
            warnings.simplefilter("ignore", RuntimeWarning)
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            scene = trimesh.load_scene(
                BytesIO(data),
                file_type=suffix[1:],
                resolver=trimesh.resolvers.FilePathResolver(path.resolve()),
                process=False,
            )
            arrays = [
                _arrays(scene.geometry[name], place, picture, srgb)
                for place, name in map(scene.graph.get, scene.graph.nodes_geometry)
                if len(getattr(scene.geometry[name], "faces", ()))
            ]
    except (*_PARSE_ERRORS, Image.DecompressionBombWarning) as error:
        raise FileError(f"{path}: cannot be read as {suffix[1:].upper()}: {_line(error)}") from None
    if not arrays:
        raise FileError(f"{path}: holds no faces; export the mesh with its triangles")
    vertices, faces, normals, albedo = zip(*arrays, strict=True)
    offsets = np.cumsum([0, *map(len, vertices)])[:-1]
    try:
        return Mesh(
            np.concatenate(vertices),
            np.concatenate([f + offset for f, offset in zip(faces, offsets, strict=True)]),
            np.concatenate(normals),
            np.concatenate(albedo),
        )
    except ArgumentError as error:
        raise FileError(f"{path}: {error}; repair the mesh and export it again") from None


def write_ply(path: Path | str, mesh: Mesh) -> None:
    """Write a mesh as binary PLY, linear albedo as 8-bit vertex colours.

    Parameters
    ----------
    path
        The file to make or replace.
    mesh
        What to write; positions and normals are stored in single precision.
    """
    with atomic_write(path) as file:
        file.write(trimesh.exchange.ply.export_ply(_painted(mesh), vertex_normal=True))


def write_glb(path: Path | str, mesh: Mesh) -> None:
    """Write a mesh as GLB, linear albedo as 8-bit vertex colours, which glTF says are linear.

    Parameters
    ----------
    path
        The file to make or replace.
    mesh
        What to write; positions and normals are stored in single precision.
    """
    scene = trimesh.Scene(_painted(mesh))
    data = trimesh.exchange.gltf.export_glb(scene, include_normals=True)
    with atomic_write(path) as file:
        file.write(data)


def write_obj(
    path: Path | str,
    mesh: Mesh,
    texture: Float[np.ndarray, "H W"] | Float[np.ndarray, "H W 3"],
    uv: Float[np.ndarray, "V 2"],
) -> None:
    """Write a mesh as OBJ, with an MTL file and a PNG texture of the same name beside it.

    Parameters
    ----------
    path
        The file to make or replace, `.obj`.
    mesh
        What to write; its own albedo is not, as OBJ has no vertex colours.
    texture
        Linear albedo in [0, 1], stored in 8 bits as it is.
    uv
        Texture coordinates of each vertex, v upwards.
    """
    path = Path(path)
    if len(uv) != len(mesh.vertices):
        raise ArgumentError(f"uv must be given for {len(mesh.vertices)} vertices, got {len(uv)}")
    picture = Image.fromarray(np.round(np.clip(texture, 0, 1) * 255).astype(np.uint8))
    material = trimesh.visual.material.SimpleMaterial(image=picture, name=path.stem)
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, visual=visual, process=False)
    surface.vertex_normals = mesh.normals
    text, others = trimesh.exchange.obj.export_obj(
        surface,
        include_normals=True,
        return_texture=True,
        mtl_name=f"{path.stem}.mtl",
        header=None,
    )
    # The mesh comes last: where it is, its texture is too.
    for name, data in [*others.items(), (path.name, text.encode())]:
        with atomic_write(path.with_name(name)) as file:
            file.write(data)


def _painted(mesh: Mesh) -> trimesh.Trimesh:
    """Return a mesh as trimesh has it, with vertex colours."""
    return trimesh.Trimesh(
        vertices=mesh.vertices,
        faces=mesh.faces,
        vertex_normals=mesh.normals,
        vertex_colors=np.round(mesh.albedo * 255).astype(np.uint8),
        process=False,
    )


def _arrays(
    part: trimesh.Trimesh,
    place: Float[np.ndarray, "4 4"],
    texture: Image.Image | None,
    srgb: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices, faces, normals and albedo of one part of a scene, put in its place."""
    place = checks.finite("transform", np.asarray(place, dtype=np.float64))
    linear = place[:3, :3]
    vertices = checks.finite("vertices", np.asarray(part.vertices, dtype=np.float64))
    vertices = vertices @ linear.T + place[:3, 3]
    faces = np.asarray(part.faces, dtype=np.int64)
    if np.linalg.det(linear) < 0:
        faces = faces[:, ::-1]
    # trimesh would compute missing normals by itself; its cache tells what the file gave.
    if "vertex_normals" in part._cache.cache:
        normals = checks.finite("normals", np.asarray(part.vertex_normals, dtype=np.float64))
        normals = normals @ np.linalg.inv(linear)
        lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
        if not lengths.all():
            raise ArgumentError(
                "normals must not be zero vectors; export without normals to have them computed"
            )
        normals = normals / lengths
    else:
        normals = vertex_normals(vertices, faces)
    colors = _colors(part, texture)
    return vertices, faces, normals, srgb_to_linear(colors) if srgb else colors


def _colors(part: trimesh.Trimesh, texture: Image.Image | None) -> Float[np.ndarray, "V 3"]:
    """Return the RGB colour of every vertex as the file has it, in [0, 1]."""
    visual = part.visual
    uv = getattr(visual, "uv", None)
    if texture is not None and uv is None:
        raise ArgumentError("texture needs a mesh with UV coordinates, this one has none")
    if visual.kind == "texture":
        picture = texture or _picture(visual.material)
        if picture is not None and uv is not None:
            rgba = trimesh.visual.color.uv_to_interpolated_color(uv, picture)
        else:
            rgba = np.tile(visual.material.main_color, (len(part.vertices), 1))
    elif visual.kind is None:
        return np.ones((len(part.vertices), 3))
    else:
        rgba = visual.vertex_colors
    return np.asarray(rgba)[:, :3].astype(np.float64) / 255


def _picture(material: trimesh.visual.material.Material) -> Image.Image | None:
    """Return the image of a material's base colour, if it has one."""
    return getattr(material, "baseColorTexture", None) or getattr(material, "image", None)


def _read_texture(path: Path) -> Image.Image:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            picture = Image.open(BytesIO(read_bytes(path))).convert("RGB")
    except FileError:
        raise
    except (*_PARSE_ERRORS, Image.DecompressionBombWarning) as error:
        raise FileError(f"{path}: cannot be read as an image: {_line(error)}") from None
    return picture


def _check_counts(path: Path, suffix: str, data: bytes) -> None:
    """Refuse a header that promises more elements than the file has bytes, before parsing."""
    counts: list[int] = []
    if suffix == ".ply":
        header = data[: 2**16].split(b"end_header")[0]
        counts = [int(n) for n in re.findall(rb"element\s+\S+\s+(\d{1,30})", header)]
    elif suffix == ".glb":
        if len(data) < 20 or data[:4] != b"glTF":
            raise FileError(f"{path}: is not a GLB file, or is cut off; export it again")
        (length,) = struct.unpack_from("<I", data, 12)
        try:
            accessors = json.loads(data[20 : 20 + length]).get("accessors", [])
            counts = [int(accessor["count"]) for accessor in accessors]
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise FileError(f"{path}: is a broken GLB file: {_line(error)}") from None
    if counts and max(counts) > len(data):
        raise FileError(
            f"{path}: promises {max(counts)} elements in {len(data)} bytes; export it again"
        )


def _line(error: BaseException) -> str:
    """Return the first line of an error's message, or its type if it has none."""
    return (str(error).splitlines() or [""])[0][:200] or type(error).__name__
