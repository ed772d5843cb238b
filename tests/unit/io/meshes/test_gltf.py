"""glTF files made byte by byte: the values expected are products and samples of what is put in."""

import base64
import json
import struct
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from harmface.errors import FileError, FileWarning
from harmface.io import read_mesh

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "f4")
RGB = np.eye(3, dtype="f4")
TYPES = {"f4": 5126, "u1": 5121, "u2": 5123, "u4": 5125, "i1": 5120}


class Glb:
    """A file in the making: arrays become accessors of buffer views of their own."""

    def __init__(self, **tree):
        self.tree = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], **tree}
        self.data = b""

    def view(self, data, **more):
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        self.tree["bufferViews"].append(view)
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def add(self, array, **more):
        array = np.asarray(array)
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        accessor = {"bufferView": self.view(array.tobytes()), "count": len(array), "type": kind}
        accessor["componentType"] = TYPES[array.dtype.str[1:]]
        self.tree["accessors"].append({**accessor, **more})
        return len(self.tree["accessors"]) - 1

    def write(self, path, *primitives, node=None):
        self.tree.setdefault("meshes", [{"primitives": list(primitives)}])
        self.tree.setdefault("nodes", [{"mesh": 0, **(node or {})}])
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.tree).encode()
        text += b" " * (-len(text) % 4)
        data = self.data + b"\0" * (-len(self.data) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path


def png(codes):
    file = BytesIO()
    Image.fromarray(codes).save(file, "PNG")
    return file.getvalue()


def pictured(codes, texture=None, sampler=None, **model):
    """Return a file with one material that has a texture."""
    glb = Glb(
        materials=[
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, **(texture or {})}, **model}}
        ],
        textures=[{"source": 0}],
    )
    if sampler is not None:
        glb.tree["textures"][0]["sampler"] = 0
        glb.tree["samplers"] = [sampler]
    glb.tree["images"] = [{"bufferView": glb.view(png(codes)), "mimeType": "image/png"}]
    return glb


def _linear(path):
    return read_mesh(path, texture_linear=True)


def linear(code):
    """Return what IEC 61966-2-1 says of an 8-bit code above its linear part."""
    return ((np.asarray(code) / 255 + 0.055) / 1.055) ** 2.4


@pytest.mark.parametrize("material", [{}, {"pbrMetallicRoughness": {}}])
def test_vertex_colours_count_beside_a_material(tmp_path, material):
    glb = Glb(materials=[material])
    attributes = {"POSITION": glb.add(TRIANGLE), "COLOR_0": glb.add(RGB)}
    mesh = read_mesh(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    assert np.array_equal(mesh.albedo, RGB)


def test_without_a_colour_albedo_is_one(tmp_path):
    glb = Glb(materials=[{}])
    attributes = {"POSITION": glb.add(TRIANGLE)}
    mesh = read_mesh(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    assert (mesh.albedo == 1).all()


def test_texture_factor_and_colour_are_multiplied(tmp_path):
    codes = np.full((2, 2, 3), (200, 150, 100), np.uint8)
    glb = pictured(codes, baseColorFactor=[0.5, 0.25, 1, 1])
    colours = np.array([[255, 51, 0, 255], [102, 255, 255, 255], [0, 0, 255, 255]], np.uint8)
    attributes = {
        "POSITION": glb.add(TRIANGLE),
        "COLOR_0": glb.add(colours, normalized=True),
        "TEXCOORD_0": glb.add(np.full((3, 2), 0.5, "f4")),
    }
    with pytest.warns(FileWarning, match="taken as sRGB"):
        mesh = read_mesh(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    expected = linear([200, 150, 100]) * [0.5, 0.25, 1] * colours[:, :3] / 255
    assert np.allclose(mesh.albedo, expected, atol=1e-9)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("said", [True, False])
def test_whole_numbers_stand_for_fractions(tmp_path, kind, said):
    top = np.iinfo(kind).max
    glb = pictured(np.array([[[10] * 3, [90] * 3], [[170] * 3, [250] * 3]], np.uint8))
    uv = np.array([[0.25, 0.25], [0.75, 0.25], [0.25, 0.75]])
    more = {"normalized": True} if said else {}
    attributes = {
        "POSITION": glb.add(TRIANGLE),
        "COLOR_0": glb.add(np.full((3, 3), top // 5, kind), **more),
        "TEXCOORD_0": glb.add(np.round(uv * top).astype(kind), **more),
    }
    mesh = _linear(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    # v runs downwards: the second row of the picture belongs to the third vertex. Rounding moves
    # the coordinates by at most half a step, in a picture that rises by 240 codes.
    assert np.allclose(
        mesh.albedo[:, 0], 0.2 * np.array([10, 90, 170]) / 255, atol=0.2 * 240 / 255 / top
    )


def test_the_set_of_coordinates_is_the_texture_s(tmp_path):
    glb = pictured(np.array([[[0] * 3, [200] * 3]], np.uint8), texture={"texCoord": 1})
    attributes = {
        "POSITION": glb.add(TRIANGLE),
        "TEXCOORD_0": glb.add(np.full((3, 2), (0.25, 0.5), "f4")),
        "TEXCOORD_1": glb.add(np.full((3, 2), (0.75, 0.5), "f4")),
    }
    mesh = _linear(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    assert np.allclose(mesh.albedo, 200 / 255)


@pytest.mark.parametrize(
    ("wrap", "codes"),
    [
        # u = 1.125, -0.125, 2.375 in a picture of four columns, at the centres of its pixels.
        (None, [10, 40, 20]),
        (10497, [10, 40, 20]),
        (33071, [40, 10, 40]),
        (33648, [40, 10, 20]),
    ],
)
def test_samplers_wrap(tmp_path, wrap, codes):
    sampler = None if wrap is None else {"wrapS": wrap}
    glb = pictured(
        np.repeat([[10, 20, 30, 40]], 3, 0).T.reshape(1, 4, 3).astype("u1"), None, sampler
    )
    uv = np.array([[1.125, 0.5], [-0.125, 0.5], [2.375, 0.5]], "f4")
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_0": glb.add(uv)}
    mesh = _linear(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    assert np.allclose(mesh.albedo[:, 0] * 255, codes)


def test_texture_transforms_scale_then_turn_then_move(tmp_path):
    codes = np.arange(16, dtype=np.uint8).reshape(4, 4)[..., None].repeat(3, 2) * 10
    transform = {"offset": [0.25, 0.5], "rotation": np.pi / 2, "scale": [0.5, 0.25], "texCoord": 1}
    glb = pictured(codes, {"extensions": {"KHR_texture_transform": transform}})
    glb.tree["extensionsRequired"] = ["KHR_texture_transform"]
    # A quarter turn counter-clockwise, as the picture is seen: (u, v) becomes (v, -u), v down.
    wanted = np.array([[0.375, 0.375], [0.375, 0.125], [0.625, 0.375]])
    turned = wanted - [0.25, 0.5]
    uv = np.stack([-turned[:, 1] / 0.5, turned[:, 0] / 0.25], axis=1).astype("f4")
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_1": glb.add(uv)}
    mesh = _linear(glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0}))
    assert np.allclose(mesh.albedo[:, 0] * 255, [50, 10, 60], atol=1e-3)


@pytest.mark.parametrize(
    ("mode", "indices", "faces"),
    [
        (4, [0, 1, 2, 2, 1, 3], [[0, 1, 2], [2, 1, 3]]),
        (5, [0, 1, 2, 3, 4], [[0, 1, 2], [2, 1, 3], [2, 3, 4]]),
        (6, [0, 1, 2, 3, 4], [[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
    ],
)
def test_triangles_strips_and_fans(tmp_path, mode, indices, faces):
    glb = Glb()
    rng = np.random.default_rng(0)
    attributes = {"POSITION": glb.add(rng.random((5, 3)).astype("f4"))}
    primitive = {"attributes": attributes, "mode": mode, "indices": glb.add(np.uint8(indices))}
    assert np.array_equal(read_mesh(glb.write(tmp_path / "a.glb", primitive)).faces, faces)


@pytest.mark.parametrize(
    "name", ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"]
)
def test_extensions_that_are_needed_and_unknown_are_named(tmp_path, name):
    glb = Glb(extensionsRequired=[name])
    primitive = {"attributes": {"POSITION": glb.add(TRIANGLE)}}
    with pytest.raises(FileError, match=name):
        read_mesh(glb.write(tmp_path / "a.glb", primitive))


def test_positions_that_only_an_extension_has_are_refused_by_its_name(tmp_path):
    glb = Glb()
    glb.tree["accessors"] = [{"count": 3, "type": "VEC3", "componentType": 5126}]
    extensions = {"KHR_draco_mesh_compression": {}}
    with pytest.raises(FileError, match="KHR_draco_mesh_compression"):
        read_mesh(
            glb.write(tmp_path / "a.glb", {"attributes": {"POSITION": 0}, "extensions": extensions})
        )


def test_a_node_moves_turns_and_mirrors(tmp_path):
    glb = Glb()
    slope = np.array([[0, 0, 0], [1, 0, 1], [0, 1, 0]], "f4")
    normal = np.tile(np.array([-1, 0, 1], "f4") / np.sqrt(2).astype("f4"), (3, 1))
    attributes = {"POSITION": glb.add(slope), "NORMAL": glb.add(normal)}
    node = {"translation": [1, 2, 3], "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]}
    node["scale"] = [-2, 1, 1]
    mesh = read_mesh(glb.write(tmp_path / "a.glb", {"attributes": attributes}, node=node))
    # x is doubled and mirrored, then a quarter turn about z takes x to y and y to -x.
    assert np.allclose(mesh.vertices, [[1, 2, 3], [1, 0, 4], [0, 2, 3]], atol=1e-6)
    assert np.allclose(mesh.normals, np.array([0, 1, 2]) / np.sqrt(5), atol=1e-6)
    corners = mesh.vertices[mesh.faces[0]]
    assert np.cross(corners[1] - corners[0], corners[2] - corners[0]) @ mesh.normals[0] > 0


def test_strides_sparse_values_and_missing_indices(tmp_path):
    glb = Glb()
    rows = np.zeros((3, 5), "f4")
    rows[:, :3] = TRIANGLE
    view = glb.view(rows.tobytes(), byteStride=20)
    where, what = glb.view(np.uint8([2]).tobytes()), glb.view(np.float32([[0, 7, 0]]).tobytes())
    glb.tree["accessors"] = [
        {
            "bufferView": view,
            "count": 3,
            "type": "VEC3",
            "componentType": 5126,
            "sparse": {
                "count": 1,
                "indices": {"bufferView": where, "componentType": 5121},
                "values": {"bufferView": what},
            },
        }
    ]
    mesh = read_mesh(glb.write(tmp_path / "a.glb", {"attributes": {"POSITION": 0}}))
    assert np.array_equal(mesh.vertices, [[0, 0, 0], [1, 0, 0], [0, 7, 0]])


def test_gltf_as_text_with_files_and_data_of_its_own(tmp_path):
    (tmp_path / "my skin.png").write_bytes(png(np.full((2, 2, 3), 51, np.uint8)))
    data = TRIANGLE.tobytes() + np.full((3, 2), 0.5, "f4").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data), "uri": "a.bin"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
        ],
        "accessors": [
            {"bufferView": 0, "count": 3, "type": "VEC3", "componentType": 5126},
            {"bufferView": 1, "count": 3, "type": "VEC2", "componentType": 5126},
        ],
        "images": [{"uri": "my%20skin.png"}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}
        ],
        "nodes": [{"mesh": 0}],
    }
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(tree))
    with pytest.raises(FileError, match=r"a\.bin: does not exist"):
        read_mesh(path)
    (tmp_path / "a.bin").write_bytes(data)
    assert np.allclose(_linear(path).albedo, 0.2)
    encoded = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    tree["buffers"][0]["uri"] = encoded
    path.write_text(json.dumps(tree))
    assert np.allclose(_linear(path).albedo, 0.2)
    tree["images"][0]["uri"] = "other.png"
    path.write_text(json.dumps(tree))
    with pytest.raises(FileError, match=r"texture other\.png is not there"):
        read_mesh(path)


def test_what_is_left_out_is_said(tmp_path):
    glb = Glb(materials=[{"alphaMode": "BLEND"}])
    primitive = {"attributes": {"POSITION": glb.add(TRIANGLE)}, "material": 0, "targets": [{}]}
    path = glb.write(tmp_path / "a.glb", primitive, node={"skin": 0})
    with pytest.warns(FileWarning, match="skins.*morph targets, transparency left out"):
        read_mesh(path)


def test_a_texture_without_coordinates_is_said(tmp_path):
    glb = pictured(np.full((2, 2, 3), 9, np.uint8), texture={"texCoord": 1})
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_0": glb.add(TRIANGLE[:, :2])}
    path = glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0})
    with pytest.warns(FileWarning) as notes:
        mesh = read_mesh(path)
    assert (mesh.albedo == 1).all()
    assert any("left out where faces have no" in str(note.message) for note in notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"[" * 100_000, "broken"),
        (b'{"accessors":[{"count":1e999}]}', "version 2"),
        (b'{"asset":{"version":"1.0"}}', "version 2"),
        (b"[]", "no object"),
        (
            b'{"asset":{"version":"2.0"},"nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}]}',
            "several",
        ),
        (
            b'{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{'
            b'"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":1e999}]}',
            "misses 'count'",
        ),
        (
            b'{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{'
            b'"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":1e999,"count":3,'
            b'"type":"VEC3","componentType":5126}]}',
            "has no inf",
        ),
        (b'{"asset":{"version":"2.0"},"nodes":[{"mesh":[]}]}', "has no"),
        (b'{"asset":{"version":"2.0"},"nodes":{}}', "no list"),
        (b" " * (2**24 + 1), "bytes of JSON"),
    ],
)
def test_broken_json_is_refused(tmp_path, text, message):
    path = tmp_path / "a.glb"
    chunk = struct.pack("<I4s", len(text), b"JSON") + text
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunk)) + chunk)
    with pytest.raises(FileError, match=message) as error:
        read_mesh(path)
    assert len(str(error.value)) < 400


def sound():
    """Return a file with indices, normals and a texture that wraps."""
    glb = pictured(np.full((2, 2, 3), 51, np.uint8), sampler={"wrapS": 33071})
    attributes = {
        "POSITION": glb.add(TRIANGLE),
        "NORMAL": glb.add(np.tile(RGB[2], (3, 1))),
        "TEXCOORD_0": glb.add(TRIANGLE[:, :2].copy()),
    }
    indices = glb.add(np.uint8([0, 1, 2]))
    glb.tree["nodes"] = [{"mesh": 0}]
    glb.tree["meshes"] = [
        {"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}
    ]
    return glb


PRIMITIVE = ("meshes", 0, "primitives", 0)
MODEL = ("materials", 0, "pbrMetallicRoughness")


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("accessors", 0, "byteOffset"), -4, "byteOffset is -4"),
        (("accessors", 0, "count"), 1.5, r"count is 1\.5"),
        (("accessors", 0, "count"), "x" * 999, "count is x{200}"),
        (("accessors", 0, "count"), 4, "promises 4 elements in 36 bytes"),
        (("accessors", 0, "type"), "MAT2", "an accessor is 'MAT2'"),
        (("accessors", 0, "type"), "VEC2", "accessor 0 is no VEC3"),
        (("accessors", 0, "bufferView"), 99, "bufferViews has no 99"),
        (("accessors", 1, "count"), 2, "2 values for 3 vertices"),
        (("accessors", 3, "componentType"), 5126, "promises 3 elements in 3 bytes"),
        ((*PRIMITIVE, "indices"), 0, "accessor 0 holds no indices"),
        ((*PRIMITIVE, "attributes"), [], "attributes is no object"),
        ((*PRIMITIVE, "material"), 9, "materials has no 9"),
        (("bufferViews", 1, "byteLength"), 10**6, "ends within buffer view 1"),
        (("bufferViews", 1, "byteStride"), 4, "promises 3 elements in 36 bytes"),
        (("bufferViews", 1, "byteOffset"), -1, "byteOffset is -1"),
        (("bufferViews", 1, "extensions"), {"EXT_meshopt_compression": {}}, "by EXT_meshopt"),
        (("buffers",), [{"uri": "http://x/a.bin"}], "names http://x/a.bin; save it beside"),
        (("buffers",), [{"uri": "data:x;base64,@@"}], "no base64"),
        (("images", 0), {"uri": "https://x/a.png"}, "names https://x/a.png; save it beside"),
        (("textures", 0), {"extensions": {"KHR_texture_basisu": {}}}, "that only KHR_texture_bas"),
        (("textures", 0), {}, "a texture that only nothing tells"),
        (("samplers", 0, "wrapS"), 5, "wraps in no known way"),
        ((*MODEL, "baseColorFactor"), [2, 0, 0, 1], r"not RGBA in \[0, 1\]"),
        ((*MODEL, "baseColorFactor"), [0.5, 0.5], r"not RGBA in \[0, 1\]"),
        ((*MODEL, "baseColorTexture", "texCoord"), -1, "texCoord is -1"),
        (("nodes", 0), 5, "nodes 0 is no object"),
        (("nodes", 0, "mesh"), -1, "meshes has no -1"),
        (("nodes", 0, "translation"), [0, float("nan"), 0], "vertices must be finite"),
        (("nodes", 0, "matrix"), [1, 2, 3], "reshape"),
    ],
)
def test_what_a_file_cannot_mean_is_refused(tmp_path, place, value, message):
    glb = sound()
    glb.write(tmp_path / "a.glb")
    assert np.allclose(_linear(tmp_path / "a.glb").albedo, 0.2)
    node = glb.tree
    for key in place[:-1]:
        node = node[key]
    node[place[-1]] = value
    buffers = glb.tree["buffers"]
    path = glb.write(tmp_path / "a.glb")
    if place == ("buffers",):
        # The data stay where they are; only what is said of them changes.
        text = path.read_bytes().replace(
            json.dumps(glb.tree["buffers"]).encode(), json.dumps(buffers).encode()
        )
        (tmp_path / "a.gltf").write_bytes(text[20 : text.index(b"BIN\0") - 4])
        path = tmp_path / "a.gltf"
    with pytest.raises(FileError, match=message) as error:
        read_mesh(path, texture_linear=True)
    assert len(str(error.value)) < 400


def test_zeros_that_no_bytes_stand_for_are_bounded(tmp_path):
    glb = sound()
    where, what = glb.view(np.uint8([2]).tobytes()), glb.view(np.float32([[0, 7, 0]]).tobytes())
    sparse = {"count": 1, "indices": {"bufferView": where, "componentType": 5121}}
    sparse["values"] = {"bufferView": what}
    accessor = {"count": 3, "type": "VEC3", "componentType": 5126, "sparse": sparse}
    glb.tree["accessors"][0] = accessor
    found = _linear(glb.write(tmp_path / "a.glb"))
    assert np.array_equal(found.vertices, [[0, 0, 0], [0, 0, 0], [0, 7, 0]])
    accessor["count"] = 10**12
    with pytest.raises(FileError, match=r"promises 1000000000000 elements that it does not have"):
        read_mesh(glb.write(tmp_path / "a.glb"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: b"glTX" + data[4:], "is not a GLB file, or is cut off"),
        (lambda data: data[:19], "is not a GLB file, or is cut off"),
        (lambda data: data[:4] + struct.pack("<I", 1) + data[8:], "GLB file of version 2"),
        (lambda data: data[:16] + b"JSOM" + data[20:], "GLB file of version 2"),
        (lambda data: data[:200], "GLB file of version 2, or is cut off"),
        (lambda data: data[:-40], "is a GLB file that is cut off"),
    ],
)
def test_a_glb_file_is_whole(tmp_path, change, message):
    path = sound().write(tmp_path / "a.glb")
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(FileError, match=message):
        read_mesh(path)


def test_a_glb_file_may_have_the_name_of_a_text(tmp_path):
    path = sound().write(tmp_path / "a.glb").rename(tmp_path / "a.gltf")
    assert np.allclose(_linear(path).albedo, 0.2)


def test_points_and_lines_are_passed_over(tmp_path):
    glb = sound()
    glb.tree["meshes"][0]["primitives"][:0] = [
        {"attributes": {"POSITION": 0}, "mode": mode} for mode in range(4)
    ]
    assert len(_linear(glb.write(tmp_path / "a.glb")).faces) == 1


def test_only_the_scene_that_is_named_is_read(tmp_path):
    glb = sound()
    glb.tree["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}, {"children": [1]}]
    glb.tree |= {"scenes": [{"nodes": [0]}, {"nodes": [2]}], "scene": 1}
    mesh = _linear(glb.write(tmp_path / "a.glb"))
    assert np.array_equal(mesh.vertices, TRIANGLE + np.float32([5, 0, 0]))
    for name in ("scenes", "scene"):
        del glb.tree[name]
    # Without scenes all roots are.
    assert len(_linear(glb.write(tmp_path / "a.glb")).faces) == 2


def test_a_matrix_of_a_node_is_stored_by_columns(tmp_path):
    glb = sound()
    glb.tree["nodes"][0]["matrix"] = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]
    mesh = _linear(glb.write(tmp_path / "a.glb"))
    assert np.array_equal(mesh.vertices, [[1, 2, 3], [1, 4, 3], [-1, 2, 3]])


def test_older_materials_and_webp_are_read(tmp_path):
    glb = sound()
    older = {"diffuseFactor": [0.5, 1, 1, 1], "diffuseTexture": {"index": 0}}
    glb.tree["materials"] = [{"extensions": {"KHR_materials_pbrSpecularGlossiness": older}}]
    file = BytesIO()
    Image.fromarray(np.full((2, 2, 3), 102, np.uint8)).save(file, "WEBP", lossless=True)
    glb.tree["images"].append({"bufferView": glb.view(file.getvalue())})
    glb.tree["textures"] = [{"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}]
    mesh = _linear(glb.write(tmp_path / "a.glb"))
    assert np.allclose(mesh.albedo, [[0.2, 0.4, 0.4]], atol=1e-6)


def test_meshes_that_are_placed_too_often_are_refused(tmp_path):
    glb = Glb()
    attributes = {"POSITION": glb.add(np.random.default_rng(0).random((30_000, 3)).astype("f4"))}
    glb.tree["nodes"] = [{"mesh": 0}] * 40
    with pytest.raises(FileError, match="so often"):
        read_mesh(glb.write(tmp_path / "a.glb", {"attributes": attributes}))


def test_faces_of_one_part_cannot_name_vertices_of_another(tmp_path):
    glb = Glb()
    first = {"attributes": {"POSITION": glb.add(TRIANGLE)}, "indices": glb.add(np.uint8([0, 1, 5]))}
    second = {"attributes": {"POSITION": glb.add(TRIANGLE)}}
    with pytest.raises(FileError, match="faces must index 3 vertices"):
        read_mesh(glb.write(tmp_path / "a.glb", first, second))


@pytest.mark.parametrize("embedded", [True, False])
def test_textures_of_16_bits_are_srgb_in_gltf(tmp_path, embedded):
    glb = pictured(np.full((2, 2), 100 * 257, np.uint16))
    if not embedded:
        (tmp_path / "a.png").write_bytes(png(np.full((2, 2), 100 * 257, np.uint16)))
        glb.tree["images"] = [{"uri": "a.png"}]
    uv = np.full((3, 2), 0.5, "f4")
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_0": glb.add(uv)}
    path = glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0})
    with pytest.warns(FileWarning, match="has 16 bits and is taken as sRGB"):
        assert np.allclose(read_mesh(path).albedo, linear(100))
    assert np.allclose(_linear(path).albedo, 100 / 255)


def test_transparency_of_a_texture_is_left_out(tmp_path):
    glb = pictured(np.full((2, 2, 4), (100, 100, 100, 7), np.uint8))
    uv = np.full((3, 2), 0.5, "f4")
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_0": glb.add(uv)}
    path = glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0})
    assert np.allclose(_linear(path).albedo, 100 / 255)


def test_a_damaged_texture_is_named_by_its_number(tmp_path):
    glb = pictured(np.zeros((2, 2), np.uint8))
    glb.tree["images"] = [{"bufferView": glb.view(b"no picture")}]
    uv = np.full((3, 2), 0.5, "f4")
    attributes = {"POSITION": glb.add(TRIANGLE), "TEXCOORD_0": glb.add(uv)}
    path = glb.write(tmp_path / "a.glb", {"attributes": attributes, "material": 0})
    with pytest.raises(FileError, match=r"a\.glb: image 0: cannot be read as an image"):
        read_mesh(path)
