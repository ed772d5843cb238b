"""A mesh from a file of any format that is read here."""

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.geometry import Mesh, Texture, TextureImage, one_side, same_places, vertex_normals
from harmface.geometry.mesh import checked_faces
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes
from harmface.io.meshes.gltf import read_gltf
from harmface.io.meshes.obj import read_obj
from harmface.io.meshes.part import Part
from harmface.io.meshes.ply import read_ply
from harmface.io.meshes.stl import read_stl
from harmface.io.meshes.textures import MAX_TEXELS, Textures

_READERS: dict[str, Callable[[bytes, Textures], list[Part]]] = {
    ".ply": lambda data, textures: [read_ply(data, textures)],
    ".obj": read_obj,
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".stl": lambda data, _: [read_stl(data)],
}

MESH_SUFFIXES = tuple(_READERS)


def read_mesh(
    path: Path | str,
    *,
    texture: Path | str | None = None,
    texture_linear: bool = False,
    flip_texture: bool = False,
    flip_normals: bool = False,
    srgb: bool = False,
    max_texels: int = MAX_TEXELS,
) -> Mesh:
    """Read a mesh with its normals and albedo.

    Normals are the file's where it has them, else angle-weighted means of the faces'. Albedo is
    the product of the base-colour texture, the material's base colour and the vertex colours;
    each that the file has not counts 1. All parts of a scene are put in their places. Of faces
    that come twice, once each way round, one is kept.

    Parameters
    ----------
    path
        A `.ply`, `.obj`, `.glb`, `.gltf` or `.stl` file.
    texture
        An image to use as albedo instead of the file's own colours; the mesh needs UVs.
    texture_linear
        Whether textures are linear. Otherwise those of 8 bits, and in glTF of 16 bits, are taken
        as sRGB, as glTF demands, and made linear; others are linear.
    flip_texture
        Whether textures lie upside down: v is taken to run the other way.
    flip_normals
        Whether the mesh is inside out: normals and faces are turned round.
    srgb
        Whether vertex and material colours are encoded in sRGB and should be made linear; they
        are taken as linear otherwise.
    max_texels
        Most pixels of all textures together.

    Returns
    -------
    Mesh
        With unit normals and linear albedo.

    Raises
    ------
    FileError
        If the file, or one that it names, is missing, of another format, broken or too large, or
        holds no surface.

    Warns
    -----
    FileWarning
        Of whatever was assumed or left out.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise FileError(f"{path}: is not a mesh file; give one of {', '.join(MESH_SUFFIXES)}")
    data = read_bytes(path)
    textures = Textures(path, linear=texture_linear, wanted=texture is None, max_pixels=max_texels)
    picture = None if texture is None else textures.from_file(Path(texture))
    try:
        with np.errstate(all="ignore"):  # of overflow and NaN in what is refused below
            parts = [part for part in _READERS[suffix](data, textures) if len(part.faces)]
            if not parts:
                raise FileError("holds no faces; export the mesh with its triangles")
            if picture is not None:
                _cover(parts, picture, textures)
            mesh = _joined(parts, textures, flip_texture, srgb)
    except FileError as error:
        named = str(error).startswith((f"{path}: ", f"{texture}: "))
        raise error if named else FileError(f"{path}: {error}") from None
    except ArgumentError as error:
        raise FileError(f"{path}: {error}; repair the mesh and export it again") from None
    except PARSE_ERRORS as error:
        said = f"it misses {error}" if isinstance(error, KeyError) else error
        raise FileError(
            f"{path}: cannot be read as {suffix[1:].upper()}: {excerpt(said)}; export it again"
        ) from None
    for note in textures.said():
        warnings.warn(note, FileWarning, stacklevel=2)
    return mesh.flipped() if flip_normals else mesh


def _cover(parts: list[Part], picture: TextureImage, textures: Textures) -> None:
    """Give a picture instead of their own colours to all parts that have texture coordinates."""
    covered = [part for part in parts if part.uv is not None]
    if not covered:
        raise FileError("texture needs a mesh with UV coordinates, this one has none")
    for part in covered:
        part.image, part.colors, part.factor = picture, None, np.ones(3)
    if len(covered) < len(parts):
        textures.note(
            f"{len(parts) - len(covered)} of its {len(parts)} parts have no texture coordinates "
            "and keep their own colours"
        )


def _joined(parts: list[Part], textures: Textures, flip_texture: bool, srgb: bool) -> Mesh:
    counts = [len(part.vertices) for part in parts]
    offsets = np.cumsum(counts) - counts
    for part, count in zip(parts, counts, strict=True):
        checked_faces(part.faces, count)
    vertices = checks.finite("vertices", np.concatenate([part.vertices for part in parts]))
    faces = np.concatenate([part.faces + o for part, o in zip(parts, offsets, strict=True)])
    owner = np.repeat(np.arange(len(parts)), [len(part.faces) for part in parts])
    position = same_places(vertices)
    one, kept = one_side(vertices, faces, position)
    if not kept.all():
        textures.note(f"{np.sum(~kept)} faces come twice, once each way round; one of each is kept")
    faces, owner = one, owner[kept]
    normals = _normals(parts, vertices, faces, position, textures)
    tint = np.concatenate([_tint(part, srgb) for part in parts])
    uv = np.concatenate(
        [np.zeros((n, 2)) if p.uv is None else p.uv for p, n in zip(parts, counts, strict=True)]
    )
    if flip_texture:
        uv = uv * [1, -1] + [0, 1]
    images = list({id(part.image): part.image for part in parts if part.image}.values())
    if not images:
        return Mesh(vertices, faces, normals, tint)
    index = {id(image): number for number, image in enumerate(images)}
    image = np.array([index.get(id(part.image), -1) for part in parts])
    texture = Texture(tuple(images), image[owner], uv, tint)
    albedo = tint.copy()
    at_vertices = np.repeat(image, counts)
    for number, picture in enumerate(images):
        there = at_vertices == number
        albedo[there] *= picture.sample(uv[there])
    return Mesh(vertices, faces, normals, albedo, texture)


def _normals(
    parts: list[Part],
    vertices: Float[np.ndarray, "V 3"],
    faces: Integer[np.ndarray, "F 3"],
    position: Integer[np.ndarray, "V"],
    textures: Textures,
) -> Float[np.ndarray, "V 3"]:
    """Return the unit normals that the parts have, computed where they have none."""
    given = np.concatenate(
        [np.full_like(p.vertices, np.nan) if p.normals is None else p.normals for p in parts]
    )
    # First by the largest component, as squares of large ones overflow.
    given = given / np.abs(given).max(axis=1, keepdims=True)
    given = given / np.linalg.norm(given, axis=1, keepdims=True)
    lost = ~np.isfinite(given).all(axis=1)
    if not lost.any():
        return given
    promised = np.concatenate([np.full(len(p.vertices), p.normals is not None) for p in parts])
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    broken = int(np.sum(lost & promised & used))
    if broken:
        textures.note(
            f"{broken} of {len(vertices)} normals are missing, zero or NaN; they are computed "
            "from the faces"
        )
    return np.where(lost[:, None], vertex_normals(vertices, faces, position), given)


def _tint(part: Part, srgb: bool) -> Float[np.ndarray, "V 3"]:
    """Return the linear colour of every vertex that multiplies the texture."""
    linear = srgb_to_linear if srgb else np.asarray
    colors = np.ones((len(part.vertices), 3)) if part.colors is None else part.colors
    return linear(checks.non_negative("colours", colors)) * linear(part.factor)
