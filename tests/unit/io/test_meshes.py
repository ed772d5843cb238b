import json
import struct

import numpy as np
import pytest
import trimesh
from PIL import Image

from data_synth.shapes import sphere
from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.geometry import Mesh, depth_to_mesh, pixel_coordinates, vertex_normals
from harmface.io import read_mesh, write_glb, write_obj, write_ply
from harmface.reproduce.synthetic import mesh_of

BALL = mesh_of(sphere())
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
UV = SQUARE[:, :2]


def test_ply_keeps_geometry_normals_and_albedo(tmp_path):
    write_ply(tmp_path / "a.ply", BALL)
    found = read_mesh(tmp_path / "a.ply")
    assert np.array_equal(found.faces, BALL.faces)
    assert np.allclose(found.vertices, BALL.vertices, atol=1e-6)
    assert np.allclose(found.normals, BALL.normals, atol=1e-6)
    assert np.abs(found.albedo - BALL.albedo).max() <= 0.5 / 255 + 1e-12


def test_glb_keeps_geometry_normals_and_albedo(tmp_path):
    colours = np.linspace(0, 1, BALL.albedo.size).reshape(BALL.albedo.shape)
    write_glb(tmp_path / "a.glb", Mesh(BALL.vertices, BALL.faces, BALL.normals, colours))
    found = read_mesh(tmp_path / "a.glb")
    assert np.array_equal(found.faces, BALL.faces)
    assert np.allclose(found.vertices, BALL.vertices, atol=1e-6)
    assert np.allclose(found.normals, BALL.normals, atol=1e-6)
    assert np.abs(found.albedo - colours).max() <= 0.5 / 255 + 1e-12


@pytest.mark.parametrize("channels", [(), (3,)])
def test_obj_keeps_geometry_normals_and_the_texture(tmp_path, channels):
    mask = np.ones((20, 30), bool)
    y, x = np.mgrid[:20, :30]
    albedo = np.broadcast_to(
        ((x + 2 * y) / 70).reshape(20, 30, *[1] * len(channels)), (20, 30, *channels)
    )
    mesh = depth_to_mesh(0.3 * x + np.sin(y), mask, albedo.copy())
    write_obj(tmp_path / "a.obj", mesh, albedo, pixel_coordinates(mask))
    assert {path.name for path in tmp_path.iterdir()} == {"a.obj", "a.mtl", "a.png"}
    with pytest.warns(FileWarning, match=r"a\.png has 8 bits and is taken as sRGB"):
        found = read_mesh(tmp_path / "a.obj")
    assert np.array_equal(found.faces, mesh.faces)
    assert np.allclose(found.vertices, mesh.vertices, atol=1e-6)
    assert np.allclose(found.normals, mesh.normals, atol=1e-6)
    # Half a code is at most this much of linear light, near white.
    assert np.abs(found.albedo - mesh.albedo).max() <= 0.5 / 255 * 2.3 + 1e-4


def test_obj_needs_coordinates_for_every_vertex(tmp_path):
    with pytest.raises(ArgumentError, match="uv must be given"):
        write_obj(tmp_path / "a.obj", BALL, np.ones((2, 2)), np.zeros((3, 2)))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["ply", "obj", "glb", "stl"])
def test_all_formats_give_the_same_surface(tmp_path, suffix):
    made = trimesh.Trimesh(BALL.vertices, BALL.faces, process=False)
    made.export(tmp_path / f"a.{suffix}")
    found = read_mesh(tmp_path / f"a.{suffix}")
    assert np.allclose(found.bounds, BALL.bounds, atol=1e-6)
    outward = found.vertices / np.linalg.norm(found.vertices, axis=1, keepdims=True)
    assert np.sum(found.normals * outward, axis=1).min() > 0.99
    assert (found.albedo == 1).all()


def test_normals_are_computed_where_the_file_has_none(tmp_path):
    made = trimesh.Trimesh(BALL.vertices, BALL.faces, process=False)
    (tmp_path / "a.obj").write_text(trimesh.exchange.obj.export_obj(made, include_normals=False))
    found = read_mesh(tmp_path / "a.obj")
    assert np.allclose(found.normals, vertex_normals(found.vertices, found.faces))


def test_a_scene_of_parts_is_read_as_one_mesh_in_place(tmp_path):
    scene = trimesh.Scene()
    part = trimesh.Trimesh(SQUARE, FACES, process=False)
    scene.add_geometry(part)
    scene.add_geometry(part, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    scene.export(tmp_path / "a.glb")
    found = read_mesh(tmp_path / "a.glb")
    assert len(found.faces) == 4
    assert np.allclose(found.bounds, [[0, 0, 0], [6, 1, 0]])


def checkered() -> Image.Image:
    # Red at the left, green at the right; brighter at the top.
    codes = np.zeros((32, 32, 3), np.uint8)
    codes[:, :16, 0] = codes[:, 16:, 1] = 100
    codes[:16] *= 2
    return Image.fromarray(codes)


def textured(tmp_path, suffix):
    visual = trimesh.visual.TextureVisuals(uv=UV, image=checkered())
    trimesh.Trimesh(SQUARE, FACES, visual=visual, process=False).export(tmp_path / f"a.{suffix}")
    return tmp_path / f"a.{suffix}"


CORNERS = np.array([[100, 0, 0], [0, 100, 0], [0, 200, 0], [200, 0, 0]]) / 255


@pytest.mark.filterwarnings("ignore::harmface.errors.FileWarning")
@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("suffix", ["obj", "glb"])
def test_a_texture_becomes_albedo_at_its_uv(tmp_path, suffix, linear):
    # Close to the corners, where a repeated picture does not mix in its other side.
    inner = 0.25 + 0.5 * UV
    # A colour that an OBJ file has beside its texture plays no part.
    diffuse = (255, 255, 255) if suffix == "glb" else (100, 100, 100)
    material = trimesh.visual.material.SimpleMaterial(image=checkered(), diffuse=diffuse)
    visual = trimesh.visual.TextureVisuals(uv=inner, material=material)
    path = tmp_path / f"a.{suffix}"
    trimesh.Trimesh(SQUARE, FACES, visual=visual, process=False).export(path)
    found = read_mesh(path, texture_linear=linear)
    expected = CORNERS if linear else ((CORNERS + 0.055) / 1.055) ** 2.4 * (CORNERS > 0)
    order = [np.argmin(np.linalg.norm(found.vertices - corner, axis=1)) for corner in SQUARE]
    assert np.allclose(found.albedo[order], expected, atol=1e-6)


def test_a_texture_may_come_from_a_file_of_its_own(tmp_path):
    path = textured(tmp_path, "glb")
    Image.new("RGB", (4, 4), (10, 20, 30)).save(tmp_path / "other.png")
    found = read_mesh(path, texture=tmp_path / "other.png", texture_linear=True)
    assert np.allclose(found.albedo, np.array([10, 20, 30]) / 255)
    write_ply(tmp_path / "b.ply", BALL)
    with pytest.raises(FileError, match="UV coordinates"):
        read_mesh(tmp_path / "b.ply", texture=tmp_path / "other.png", texture_linear=True)
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nrest")
    with pytest.raises(FileError, match=r"broken.png: cannot be read as an image"):
        read_mesh(path, texture=tmp_path / "broken.png")


def test_colours_are_linearised_on_request(tmp_path):
    write_ply(tmp_path / "a.ply", BALL)
    plain = read_mesh(tmp_path / "a.ply").albedo
    assert np.allclose(read_mesh(tmp_path / "a.ply", srgb=True).albedo, srgb_to_linear(plain))


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.xyz", b"1", "not a mesh file"),
        ("a.ply", b"", "is empty"),
        ("a.ply", b"ply\nformat ascii 1.0\n", "cannot be read as PLY"),
        ("a.ply", b"nonsense", "cannot be read as PLY"),
        ("a.obj", b"v 0 0 0\n", "holds no faces"),
        ("a.stl", b"solid a\nendsolid", "."),
        ("a.glb", b"glTF", "not a GLB file"),
        ("a.glb", b"x" * 40, "not a GLB file"),
        (
            "a.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\n"
            b"property float x\nend_header\n",
            "promises 99999999999 elements",
        ),
    ],
)
def test_broken_files_are_named(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(FileError, match=message) as error:
        read_mesh(tmp_path / name)
    assert name in str(error.value)
    assert "\n" not in str(error.value)


def test_a_glb_that_promises_more_than_it_has_is_refused(tmp_path):
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"count": 10**12, "type": "VEC3", "componentType": 5126, "bufferView": 0}],
        "bufferViews": [{"buffer": 0, "byteLength": 0}],
        "buffers": [{"byteLength": 0}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = b"glTF" + struct.pack("<II", 2, 20 + len(text)) + struct.pack("<I", len(text)) + b"JSON"
    (tmp_path / "a.glb").write_bytes(head + text)
    with pytest.raises(FileError, match="promises 1000000000000 elements"):
        read_mesh(tmp_path / "a.glb")


@pytest.mark.parametrize(("line", "message"), [("v nan 0 0", "finite"), ("v 0 0 inf", "finite")])
def test_vertices_that_are_not_numbers_are_refused(tmp_path, line, message):
    (tmp_path / "a.obj").write_text(f"{line}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(FileError, match=message):
        read_mesh(tmp_path / "a.obj")


@pytest.mark.parametrize("suffix", ["ply", "obj", "glb", "stl"])
def test_broken_bytes_raise_file_errors_only(tmp_path, rng, suffix):
    path = tmp_path / f"a.{suffix}"
    colors = np.full((4, 4), 200, np.uint8)
    trimesh.Trimesh(SQUARE, FACES, vertex_colors=colors, process=False).export(path)
    whole = path.read_bytes()
    refused = 0
    for trial in range(150):
        broken = bytearray(whole)
        for position in rng.integers(len(whole), size=1 + trial % 4):
            broken[position] = rng.integers(256)
        path.write_bytes(broken[: len(whole) if trial % 3 else rng.integers(1, len(whole) + 1)])
        try:
            mesh = read_mesh(path)
        except FileError as error:
            refused += 1
            assert path.name in str(error)
        else:
            assert np.isfinite(mesh.vertices).all()
    assert refused > 20
