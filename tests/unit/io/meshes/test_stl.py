import struct

import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_mesh

CORNERS = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [2, 0, 1], [0, 2, 1]]], "<f4")


def binary(head=b""):
    records = b"".join(bytes(12) + corners.tobytes() + bytes(2) for corners in CORNERS)
    return head.ljust(80, b" ") + struct.pack("<I", len(CORNERS)) + records


TEXT = "solid a\n" + "".join(
    "facet normal 0 0 1\n outer loop\n"
    + "".join(f"  vertex {x:e} {y} {z}\n" for x, y, z in corners)
    + " endloop\nendfacet\n"
    for corners in CORNERS
)


@pytest.mark.parametrize(
    "data", [binary(), binary(b"solid of a program"), binary() + b"more", TEXT.encode()]
)
def test_binary_and_text(tmp_path, data):
    (tmp_path / "a.stl").write_bytes(data)
    mesh = read_mesh(tmp_path / "a.stl")
    assert np.array_equal(mesh.vertices[mesh.faces], CORNERS)
    assert np.allclose(mesh.normals, [0, 0, 1])


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (binary()[:-1], "promises 2 triangles"),
        (b"\0" * 30, "promises 0 triangles"),
        (b"\0" * 84, "no faces"),
        (b"solid", "no faces"),
        (TEXT.replace("vertex", "apex", 1).encode(), "no whole triangles"),
        (TEXT.replace("vertex 0.000000e+00", "vertex nan", 1).encode(), "vertices must be finite"),
        (TEXT.replace("vertex 0", "vertex --", 1).encode(), "cannot be read as STL"),
    ],
)
def test_broken_files_are_refused(tmp_path, data, message):
    (tmp_path / "a.stl").write_bytes(data)
    with pytest.raises(FileError, match=message):
        read_mesh(tmp_path / "a.stl")
