"""What holds for meshes of every format."""

from io import BytesIO

import cv2
import numpy as np
import pytest
from PIL import Image

from data_synth.shapes import sphere
from harmface.errors import FileError, FileWarning
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_mesh
from harmface.reproduce.synthetic import mesh_of

BALL = mesh_of(sphere())
PICTURED = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.25\nvt 0.75 0.25\nvt 0.25 0.75\nf 1/1 2/2 3/3\n"


@pytest.fixture
def pictured(tmp_path):
    (tmp_path / "a.obj").write_text(PICTURED)
    return tmp_path / "a.obj"


def obj(path, vertices, faces):
    text = "".join("v {} {} {}\n".format(*point) for point in vertices)
    path.write_text(text + "".join("f {} {} {}\n".format(*(face + 1)) for face in faces))
    return path


@pytest.mark.parametrize("shuffled", [False, True])
def test_faces_that_come_twice_are_kept_once(tmp_path, rng, shuffled):
    faces = np.concatenate([BALL.faces, BALL.faces[:, ::-1]])
    faces = rng.permutation(faces) if shuffled else faces
    with pytest.warns(FileWarning, match=f"{len(BALL.faces)} faces come twice"):
        mesh = read_mesh(obj(tmp_path / "a.obj", BALL.vertices, faces))
    assert len(mesh.faces) == len(BALL.faces)
    outward = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
    # The angle-weighted means of this ball are off by less than half a degree.
    assert np.einsum("vi,vi->v", mesh.normals, outward).min() > np.cos(np.radians(0.5))


def test_a_mesh_that_is_inside_out_is_turned_round(tmp_path):
    path = obj(tmp_path / "a.obj", BALL.vertices, BALL.faces[:, ::-1])
    wrong, right = read_mesh(path), read_mesh(path, flip_normals=True)
    assert (np.einsum("vi,vi->v", wrong.normals, BALL.vertices) < 0).all()
    assert np.allclose(right.normals, -wrong.normals)
    assert np.array_equal(right.faces, BALL.faces)


@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_16_bits_are_linear_and_kept(tmp_path, pictured, channels):
    codes = np.full((4, 4, *channels), 32768, np.uint16)
    if channels == (4,):
        codes[..., 3] = 65535
    (tmp_path / "t.png").write_bytes(cv2.imencode(".png", codes)[1].tobytes())
    mesh = read_mesh(pictured, texture=tmp_path / "t.png")
    assert np.allclose(mesh.albedo, 32768 / 65535, atol=1e-12)


def test_floating_point_is_linear_and_kept(tmp_path, pictured):
    Image.fromarray(np.full((4, 4), 0.123, np.float32)).save(tmp_path / "t.tif")
    mesh = read_mesh(pictured, texture=tmp_path / "t.tif")
    assert np.allclose(mesh.albedo, 0.123)
    Image.fromarray(np.full((4, 4), 1.5, np.float32)).save(tmp_path / "t.tif")
    with pytest.raises(FileError, match=r"lie in \[0, 1\]"):
        read_mesh(pictured, texture=tmp_path / "t.tif")


@pytest.mark.parametrize("kind", ["L", "P", "RGBA", "LA", "1"])
def test_8_bits_are_srgb_unless_said(tmp_path, pictured, kind):
    grey = Image.fromarray(np.full((4, 4, 3), 255 if kind == "1" else 128, np.uint8))
    (grey.quantize(2) if kind == "P" else grey.convert(kind)).save(tmp_path / "t.png")
    value = 1 if kind == "1" else 128 / 255
    with pytest.warns(FileWarning, match=r"t\.png has 8 bits and is taken as sRGB"):
        mesh = read_mesh(pictured, texture=tmp_path / "t.png")
    assert np.allclose(mesh.albedo, ((value + 0.055) / 1.055) ** 2.4)
    mesh = read_mesh(pictured, texture=tmp_path / "t.png", texture_linear=True)
    assert np.allclose(mesh.albedo, value)


def test_a_texture_is_turned_over(tmp_path, pictured):
    Image.fromarray(np.array([[10, 20], [30, 40]], np.uint8)).save(tmp_path / "t.png")
    for flip, codes in ((False, [30, 40, 10]), (True, [10, 20, 30])):
        mesh = read_mesh(
            pictured, texture=tmp_path / "t.png", texture_linear=True, flip_texture=flip
        )
        assert np.allclose(mesh.albedo[:, 0] * 255, codes)


def test_parts_that_a_texture_does_not_cover_are_said(tmp_path):
    bare = "v 0 0 5 .2 .3 .4\nv 1 0 5 .2 .3 .4\nv 0 1 5 .2 .3 .4\nusemtl b\nf -3 -2 -1\n"
    (tmp_path / "a.obj").write_text(PICTURED + "f 1/1 2/2 3/3\n" + bare)
    Image.fromarray(np.full((4, 4), 51, np.uint8)).save(tmp_path / "t.png")
    with pytest.warns(FileWarning, match=r"a\.obj: 1 of its 2 parts have no texture coordinates"):
        mesh = read_mesh(tmp_path / "a.obj", texture=tmp_path / "t.png", texture_linear=True)
    assert np.allclose(mesh.albedo[mesh.vertices[:, 2] == 0], 0.2)
    assert np.allclose(mesh.albedo[mesh.vertices[:, 2] == 5], [0.2, 0.3, 0.4])


def test_a_picture_between_the_vertices_is_seen_by_the_g_buffer(tmp_path):
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    )
    codes = np.zeros((8, 8), np.uint8)
    codes[2, 5] = 255  # nothing of it at a corner
    Image.fromarray(codes).save(tmp_path / "t.png")
    mesh = read_mesh(tmp_path / "a.obj", texture=tmp_path / "t.png", texture_linear=True)
    assert not mesh.albedo.any()
    view = gbuffer(mesh, frame_orthographic(mesh, 84))
    # The square fills 80 pixels, ten for each of the picture's.
    assert view.albedo[2 + 25, 2 + 55].max() == pytest.approx(1, abs=0.1)
    assert view.albedo[..., 0].sum() == pytest.approx(100, rel=0.01)


def test_textures_are_bounded_before_memory_is_taken(tmp_path, pictured):
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "t.png")
    texture = {"texture": tmp_path / "t.png", "texture_linear": True}
    with pytest.raises(FileError, match=r"more pixels than the limit of 15.*max_texels"):
        read_mesh(pictured, **texture, max_texels=15)
    assert not read_mesh(pictured, **texture, max_texels=16).albedo.any()


def test_all_textures_of_a_mesh_are_bounded_together(tmp_path):
    for name in "ab":
        Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / f"{name}.png")
    (tmp_path / "a.mtl").write_text("newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n")
    faces = "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n"
    (tmp_path / "a.obj").write_text("mtllib a.mtl\n" + PICTURED + faces)
    with pytest.raises(FileError, match=r"b\.png: .*more pixels than the limit of 4"):
        read_mesh(tmp_path / "a.obj", texture_linear=True, max_texels=20)
    read_mesh(tmp_path / "a.obj", texture_linear=True, max_texels=32)


def test_a_damaged_texture_is_named(tmp_path, pictured):
    file = BytesIO()
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3)).astype(np.uint8)
    Image.fromarray(noise).save(file, "PNG")
    for data in (file.getvalue()[:500], b"P6 nonsense", b"\x89PNG\r\n\x1a\n"):
        (tmp_path / "t.png").write_bytes(data)
        with pytest.raises(FileError, match=r"t\.png: cannot be read as an image"):
            read_mesh(pictured, texture=tmp_path / "t.png")


def test_coordinates_that_are_not_numbers_are_refused(tmp_path):
    (tmp_path / "a.obj").write_text(PICTURED.replace("vt 0.75", "vt nan"))
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "t.png")
    with pytest.raises(FileError, match="uv must be finite"):
        read_mesh(tmp_path / "a.obj", texture=tmp_path / "t.png", texture_linear=True)
