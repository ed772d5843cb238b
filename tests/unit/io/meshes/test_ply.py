import struct

import numpy as np
import pytest
from PIL import Image

from harmface.errors import FileError, FileWarning
from harmface.io import read_mesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
FORMATS = {"<": "binary_little_endian", ">": "binary_big_endian", "": "ascii"}


def ply(path, order, properties, rows, faces, *, face_properties=(), face_rows=None, comment=""):
    """Write a file value by value: a list is written after its length."""
    kinds = [kind for kind, _ in properties]
    head = f"ply\nformat {FORMATS[order]} 1.0\n{comment}element vertex {len(rows)}\n"
    head += "".join(f"property {kind} {name}\n" for kind, name in properties)
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\n"
    head += "".join(f"property {kind} {name}\n" for kind, name in face_properties) + "end_header\n"
    body = [[*zip(kinds, row, strict=True)] for row in rows]
    for number, face in enumerate(faces):
        values = [("uchar", len(face)), *(("int", index) for index in face)]
        for (kind, _), value in zip(
            face_properties, [] if face_rows is None else face_rows[number], strict=True
        ):
            if kind.startswith("list"):
                _, count, item = kind.split()
                values += [(count, len(value)), *((item, each) for each in value)]
            else:
                values.append((kind, value))
        body.append(values)
    codes = {"uchar": "B", "ushort": "H", "int": "i", "float": "f", "double": "d"}
    if order:
        data = b"".join(struct.pack(order + codes[kind], v) for row in body for kind, v in row)
    else:
        data = "".join(" ".join(str(v) for _, v in row) + "\n" for row in body).encode()
    path.write_bytes(head.encode() + data)
    return path


XYZ = [("float", "x"), ("double", "y"), ("float", "z")]


@pytest.mark.parametrize("order", FORMATS)
def test_triangles_and_polygons_may_be_mixed(tmp_path, order):
    path = ply(tmp_path / "a.ply", order, XYZ, POINTS, [[0, 1, 2, 3], [3, 0, 1], [0, 1]])
    mesh = read_mesh(path)
    assert np.array_equal(mesh.vertices, POINTS)
    assert np.array_equal(mesh.faces, [[0, 1, 2], [0, 2, 3], [3, 0, 1]])
    assert (mesh.albedo == 1).all()


@pytest.mark.parametrize("order", FORMATS)
@pytest.mark.parametrize(
    "names", ["red green blue", "diffuse_red diffuse_green diffuse_blue", "r g b"]
)
@pytest.mark.parametrize(("kind", "top"), [("uchar", 255), ("ushort", 65535), ("float", 1)])
def test_colours_by_any_name_and_in_any_type(tmp_path, order, names, kind, top):
    codes = np.array([[0, 1, 2], [3, 4, 5], [2, 1, 0], [5, 0, 5]]) * (top / 5)
    codes = codes if top == 1 else codes.astype(int)
    rows = [[*point, *code] for point, code in zip(POINTS, codes.tolist(), strict=True)]
    properties = [*XYZ, *((kind, name) for name in names.split())]
    mesh = read_mesh(ply(tmp_path / "a.ply", order, properties, rows, [[0, 1, 2, 3]]))
    assert np.allclose(mesh.albedo, codes / top)


def test_real_colours_up_to_255_are_taken_for_that_and_said(tmp_path):
    rows = [[*point, 51.0, 102.0, 255.0] for point in POINTS]
    properties = [*XYZ, ("float", "red"), ("float", "green"), ("float", "blue")]
    path = ply(tmp_path / "a.ply", "<", properties, rows, [[0, 1, 2, 3]])
    with pytest.warns(FileWarning, match="0 to 255"):
        mesh = read_mesh(path)
    assert np.allclose(mesh.albedo, [0.2, 0.4, 1])


def test_colours_of_faces_stay_on_their_faces(tmp_path):
    properties = [("uchar", name) for name in ("red", "green", "blue")]
    path = ply(
        tmp_path / "a.ply",
        "<",
        XYZ,
        POINTS,
        [[0, 1, 2], [0, 2, 3]],
        face_properties=properties,
        face_rows=[[255, 0, 51], [0, 102, 255]],
    )
    mesh = read_mesh(path)
    assert np.allclose(mesh.albedo[mesh.faces[0]], [1, 0, 0.2])
    assert np.allclose(mesh.albedo[mesh.faces[1]], [0, 0.4, 1])
    assert np.allclose(mesh.vertices[mesh.faces], POINTS[[[0, 1, 2], [0, 2, 3]]])


@pytest.mark.parametrize("order", FORMATS)
@pytest.mark.parametrize("names", [("u", "v"), ("s", "t"), ("texture_u", "texture_v"), None])
def test_a_texture_at_vertices_or_corners(tmp_path, order, names):
    Image.fromarray(np.array([[10, 20], [30, 40]], np.uint8)).save(tmp_path / "a skin.png")
    uv = np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]])
    comment = "comment TextureFile a skin.png\n"
    if names is None:
        path = ply(
            tmp_path / "a.ply",
            order,
            XYZ,
            POINTS,
            [[0, 1, 2], [0, 2, 3]],
            face_properties=[("list uchar float", "texcoord")],
            face_rows=[[uv[[0, 1, 2]].ravel().tolist()], [uv[[1, 2, 3]].ravel().tolist()]],
            comment=comment,
        )
        expected = [[30, 40, 20], [40, 20, 10]]
    else:
        rows = np.hstack([POINTS, uv]).tolist()
        properties = [*XYZ, *(("float", name) for name in names)]
        path = ply(
            tmp_path / "a.ply", order, properties, rows, [[0, 1, 2], [0, 2, 3]], comment=comment
        )
        expected = [[30, 40, 20], [30, 20, 10]]
    mesh = read_mesh(path, texture_linear=True)
    assert np.allclose(mesh.albedo[mesh.faces][..., 0] * 255, expected)
    (tmp_path / "a skin.png").unlink()
    with pytest.raises(FileError, match=r"texture a skin\.png is not there"):
        read_mesh(path)


def test_broken_normals_are_computed(tmp_path):
    rows = np.hstack([POINTS, [[0, 0, 0], [0, 0, 2], [0, 0, 3e38], [np.nan, 0, 1]]])
    properties = [*XYZ, ("float", "nx"), ("float", "ny"), ("float", "nz")]
    path = ply(tmp_path / "a.ply", "<", properties, rows.tolist(), [[0, 1, 2, 3]])
    with pytest.warns(FileWarning, match="2 of 4 normals"):
        assert np.array_equal(read_mesh(path).normals, [[0, 0, 1]] * 4)


HEAD = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
FLOATS = b"property float x\nproperty float y\nproperty float z\n"
FACES = b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
THREE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"ply\n" * 3, "header does not end"),
        (b"ply\nformat klingon 1.0\nend_header\n", "its header says format klingon"),
        (b"ply\nelement vertex 1\nend_header\n", "no format"),
        (b"ply\nproperty float x\nend_header\n", "its header says property float x"),
        (HEAD + b"property string x\nend_header\n", "a type string"),
        (HEAD + b"property float x\n" * 2000 + b"end_header\n", "more properties"),
        (HEAD + b"property float x\nproperty float x\nend_header\n" + b"0" * 99, "twice"),
        (HEAD + b"end_header\n", "promises 3 elements"),
        (HEAD + FLOATS + FACES + THREE, "promises 1 elements"),
        (HEAD + FLOATS + FACES + THREE + b"\x03" + b"\0" * 11, "ends within"),
        (HEAD + FLOATS + FACES + THREE + b"\x03" + struct.pack("<3i", 0, 1, 3), "vertex 4 of 3"),
        (HEAD + FLOATS + FACES + THREE + b"\x03" + struct.pack("<3i", 0, 1, -1), "vertex -1 of 3"),
        (HEAD + FLOATS + b"end_header\n" + THREE, "no faces"),
        (HEAD + FLOATS + FACES.replace(b"uchar", b"char") + THREE + b"\xff" * 5, "list of -1 val"),
        (
            HEAD + FLOATS + FACES.replace(b"uchar", b"float") + THREE + struct.pack("<fi", 1.5, 0),
            "list of 1.5 val",
        ),
        (HEAD + FLOATS.replace(b" x", b" w") + FACES + THREE + b"\0" * 99, "has no positions"),
        (HEAD + FLOATS + FACES.replace(b"vertex_", b"my_") + THREE + b"\0" * 99, "no vertex_ind"),
        (HEAD + FLOATS + FACES + b"\xff" * 36 + b"\3" + struct.pack("<3i", 0, 1, 2), "finite"),
        (HEAD + FLOATS + FACES + THREE + b"\x64" + b"\0" * 40, "ends within its elements"),
        (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\nx\n", "PLY: x"),
    ],
)
def test_broken_files_are_refused(tmp_path, data, message):
    (tmp_path / "a.ply").write_bytes(data)
    with pytest.raises(FileError, match=message):
        read_mesh(tmp_path / "a.ply")


def test_colours_and_textures_that_cannot_be_meant_are_refused(tmp_path):
    path = tmp_path / "a.ply"
    reds = [*XYZ, *(("float", name) for name in ("red", "green", "blue"))]
    ply(path, "", reds, np.hstack([POINTS, np.full((4, 3), 300)]).tolist(), [[0, 1, 2]])
    with pytest.raises(FileError, match=r"colours must lie in \[0, 1\] or \[0, 255\], got 300"):
        read_mesh(path)
    ply(path, "", reds, np.hstack([POINTS, np.full((4, 3), 51)]).tolist(), [[0, 1, 2]])
    with pytest.warns(FileWarning, match="colours exceed 1 and are taken to run from 0 to 255"):
        assert np.allclose(read_mesh(path).albedo, 0.2)
    uv = [("list uchar float", "texcoord")]
    ply(path, "", XYZ, POINTS, [[0, 1, 2]], face_properties=uv, face_rows=[[[0.0, 1.0]]])
    with pytest.raises(FileError, match="coordinates are not two for each corner"):
        read_mesh(path)
    rows = [[[0.0] * 6]]
    two = "comment TextureFile a.png\ncomment TextureFile b.png\n"
    ply(path, "", XYZ, POINTS, [[0, 1, 2]], face_properties=uv, face_rows=rows, comment=two)
    with pytest.raises(FileError, match="has 2 textures"):
        read_mesh(path)


def test_a_texture_without_coordinates_is_said(tmp_path):
    path = ply(
        tmp_path / "a.ply", "", XYZ, POINTS, [[0, 1, 2]], comment="comment TextureFile s.png\n"
    )
    with pytest.warns(FileWarning, match=r"a\.ply: textures are left out .*: s\.png$"):
        assert (read_mesh(path).albedo == 1).all()
