import os
import time

import numpy as np
import pytest
from PIL import Image

from harmface.errors import FileError, FileWarning
from harmface.io import read_mesh

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
PICTURED = TRIANGLE + "vt 0.25 0.25\nvt 0.75 0.25\nvt 0.25 0.75\nf 1/1 2/2 3/3\n"
# Rows from the top; so v upwards finds 30 and 40 in the lower half.
CODES = np.array([[10, 20], [30, 40]], np.uint8)


def written(path, text):
    path.write_text(text)
    return path


def areas(mesh):
    corners = mesh.vertices[mesh.faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


def test_negative_indices_count_back_from_where_they_stand(tmp_path):
    block = (
        "v 0 0 {0}\nv 1 0 {0}\nv 0 1 {0}\nvt 0 0.{0}\nvn 0 {1} 1\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\n"
    )
    mesh = read_mesh(written(tmp_path / "a.obj", block.format(0, 0) + block.format(1, 1)))
    assert np.array_equal(mesh.vertices[mesh.faces][:, :, 2], [[0] * 3, [1] * 3])
    assert np.allclose(mesh.normals[mesh.faces[0]], [0, 0, 1])
    assert np.allclose(mesh.normals[mesh.faces[1]], np.array([0, 1, 1]) / np.sqrt(2))


@pytest.mark.parametrize("turn", range(6))
@pytest.mark.parametrize("back", [False, True])
def test_concave_polygons_are_cut_within_their_outline(tmp_path, turn, back):
    outline = ["0 0", "4 0", "4 3", "3 3", "3 1", "0 1"]
    order = [str(1 + (turn + k) % 6) for k in range(6)]
    order = order[::-1] if back else order
    # In the plane of y and z, so that x is what the cut must not look at.
    text = "".join(f"v 7 {point}\n" for point in outline) + f"f {' '.join(order)}\n"
    found = areas(read_mesh(written(tmp_path / "a.obj", text)))
    assert np.linalg.norm(found, axis=1).sum() == pytest.approx(6)
    assert np.allclose(found.sum(axis=0), [-6 if back else 6, 0, 0])


def test_a_star_and_a_bent_square_keep_their_area(tmp_path):
    angle = np.pi * np.arange(10) / 5
    points = np.where(np.arange(10) % 2, 1.0, 0.3) * np.array([np.cos(angle), np.sin(angle)])
    text = "".join(f"v {x} {y} 0\n" for x, y in points.T) + f"f {' '.join(map(str, range(1, 11)))}"
    star = read_mesh(written(tmp_path / "a.obj", text))
    # Ten triangles about the centre, with sides 1 and .3 and 36 degrees between.
    assert areas(star)[:, 2].sum() == pytest.approx(10 * 0.5 * 0.3 * np.sin(np.pi / 5))
    assert (areas(star)[:, 2] > 0).all()
    bent = "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n"
    assert len(read_mesh(written(tmp_path / "a.obj", bent)).faces) == 2


def test_mixed_faces_keep_their_order(tmp_path):
    text = TRIANGLE + "v 1 1 0\nf 1 2 3\nf 1 2 4 3\nl 1 2\nf 2 4 3\n"
    mesh = read_mesh(written(tmp_path / "a.obj", text))
    assert np.array_equal(mesh.faces, [[0, 1, 2], [0, 1, 3], [0, 3, 2], [1, 3, 2]])


def test_albedo_is_one_where_nothing_else_is_said(tmp_path):
    assert (read_mesh(written(tmp_path / "a.obj", PICTURED)).albedo == 1).all()
    named = "usemtl skin\n" + PICTURED
    with pytest.warns(FileWarning, match=r"1 materials \(skin\) are not defined"):
        assert (read_mesh(written(tmp_path / "a.obj", named)).albedo == 1).all()
    with pytest.warns(FileWarning, match=r"material file a\.mtl is not there"):
        assert (
            read_mesh(written(tmp_path / "a.obj", "mtllib a.mtl\n" + PICTURED)).albedo == 1
        ).all()


def test_materials_colour_their_faces(tmp_path):
    text = "mtllib a.mtl\n" + TRIANGLE + "v 1 1 0\nusemtl red one\nf 1 2 3\nusemtl plain\nf 2 4 3\n"
    written(tmp_path / "a.mtl", "newmtl red one\nKd .5 .25 0\nnewmtl plain\nKs 1 1 1\n")
    mesh = read_mesh(written(tmp_path / "a.obj", text))
    # The first face has corners that add up to (1, 1), the other to (2, 2).
    first = (mesh.vertices[mesh.faces].sum(axis=1) < 1.5).all(axis=1)
    assert first.sum() == 1
    assert np.allclose(mesh.albedo[mesh.faces[first]], [0.5, 0.25, 0])
    assert np.allclose(mesh.albedo[mesh.faces[~first]], 1)
    encoded = read_mesh(tmp_path / "a.obj", srgb=True)
    assert np.allclose(encoded.albedo[encoded.faces[first], 0], ((0.5 + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize(
    ("options", "codes"),
    [
        ("", [30, 40, 10]),
        ("-o 0.5 0 0 ", [40, 30, 20]),
        # u = .25 and .75 become .25 and 1.25, a period further, and v changes rows.
        ("-s 2 1 1 -o -0.25 0.5 ", [10, 10, 30]),
        ("-clamp on -o 0.5 0 ", [40, 40, 20]),
        ("-mm 0 1 -bm 1 ", [30, 40, 10]),
    ],
)
def test_textures_lie_as_the_material_says(tmp_path, options, codes):
    folder = tmp_path / "my maps"
    folder.mkdir()
    Image.fromarray(CODES).save(folder / "a b.png")
    written(tmp_path / "a.mtl", f"newmtl a\nmap_Kd {options}my maps/a b.png\n")
    path = written(tmp_path / "a.obj", "mtllib a.mtl\nusemtl a\n" + PICTURED)
    mesh = read_mesh(path, texture_linear=True)
    assert np.allclose(mesh.albedo[:, 0] * 255, codes)


def test_materials_may_stand_in_several_files(tmp_path):
    written(tmp_path / "a.mtl", "Kd 1 1 1\nmap_Kd x.png\nnewmtl a\nKd .5\n")
    written(tmp_path / "b.mtl", "newmtl b\nKd .1 .2 .3 .4\n")
    text = "mtllib a.mtl b.mtl\nusemtl a\n" + TRIANGLE + "f 1 2 3\nv 0 0 5\nusemtl b\nf 1 2 4\n"
    mesh = read_mesh(written(tmp_path / "a.obj", text))
    colours = {tuple(np.round(face[0], 9)) for face in mesh.albedo[mesh.faces]}
    assert colours == {(0.5, 0.5, 0.5), (0.1, 0.2, 0.3)}
    with pytest.warns(FileWarning, match=r"1 materials \(c d\) are not defined and count as white"):
        read_mesh(written(tmp_path / "a.obj", text + "usemtl c d\nf 1 2 3\n"))


def test_a_texture_is_found_beside_the_mesh(tmp_path):
    Image.fromarray(CODES).save(tmp_path / "skin.png")
    written(tmp_path / "a.mtl", "newmtl a\nmap_Kd C:\\models\\ann\\skin.png\n")
    path = written(tmp_path / "a.obj", "mtllib a.mtl\nusemtl a\n" + PICTURED)
    mesh = read_mesh(path, texture_linear=True)
    assert np.allclose(mesh.albedo[:, 0] * 255, [30, 40, 10])


def test_a_missing_texture_is_refused_and_another_helps(tmp_path):
    Image.fromarray(CODES).save(tmp_path / "other.png")
    written(tmp_path / "a.mtl", "newmtl a\nKd .2 .2 .2\nmap_Kd skin.png\n")
    path = written(tmp_path / "a.obj", "mtllib a.mtl\nusemtl a\n" + PICTURED)
    with pytest.raises(FileError, match=r"a\.obj: its texture skin\.png is not there"):
        read_mesh(path)
    mesh = read_mesh(path, texture=tmp_path / "other.png", texture_linear=True)
    assert np.allclose(mesh.albedo[:, 0] * 255, [30, 40, 10])


def test_a_colour_beside_a_texture_is_left_out_and_said(tmp_path):
    Image.fromarray(CODES).save(tmp_path / "skin.png")
    written(tmp_path / "a.mtl", "newmtl a\nKd .2 .2 .2\nmap_Kd skin.png\n")
    path = written(tmp_path / "a.obj", "mtllib a.mtl\nusemtl a\n" + PICTURED)
    with pytest.warns(FileWarning, match=r"Kd 0\.2 0\.2 0\.2"):
        mesh = read_mesh(path, texture_linear=True)
    assert np.allclose(mesh.albedo[:, 0] * 255, [30, 40, 10])


def test_a_texture_without_coordinates_is_said(tmp_path):
    written(tmp_path / "a.mtl", "newmtl a\nKd .2 .2 .2\nmap_Kd skin.png\n")
    path = written(tmp_path / "a.obj", "mtllib a.mtl\nusemtl a\n" + TRIANGLE + "f 1 2 3\n")
    with pytest.warns(FileWarning, match="a.obj: textures are left out.*: skin.png"):
        mesh = read_mesh(path)
    assert np.allclose(mesh.albedo, 0.2)


@pytest.mark.parametrize("scale", [1, 255])
def test_vertex_colours_in_either_range(tmp_path, scale):
    colours = np.array([[1, 0.2, 0], [0, 0.4, 1], [0.6, 0, 0]])
    lines = "".join(
        f"v {x} {y} 0 {' '.join(map(str, c * scale))}\n"
        for (x, y), c in zip([(0, 0), (1, 0), (0, 1)], colours, strict=True)
    )
    path = written(tmp_path / "a.obj", lines + "f 1 2 3\n")
    if scale == 255:
        with pytest.warns(FileWarning, match="0 to 255"):
            mesh = read_mesh(path)
    else:
        mesh = read_mesh(path)
    assert np.allclose(mesh.albedo, colours)


def test_zero_and_missing_normals_are_computed_and_said(tmp_path):
    text = TRIANGLE + "vn 0 0 0\nvn 0 3 4\nvn nan 0 1\nf 1//1 2//2 3//3\n"
    with pytest.warns(FileWarning, match=r"2 of 3 normals are missing, zero or NaN"):
        mesh = read_mesh(written(tmp_path / "a.obj", text))
    assert np.allclose(mesh.normals, [[0, 0, 1], [0, 0.6, 0.8], [0, 0, 1]])


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_may_be_continued_and_end_in_any_way(tmp_path, end):
    text = TRIANGLE.replace("v 1 0 0", "v 1 \\\n0 0") + "f 1 2 \\\n 3\n"
    (tmp_path / "a.obj").write_bytes(text.replace("\n", end).encode())
    assert np.array_equal(read_mesh(tmp_path / "a.obj").faces, [[0, 1, 2]])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("f 1 2 4", "names vertex 4 of 3"),
        ("f 1 2 0", "line 4 cannot be read"),
        ("f 1 2 -4", "line 4 cannot be read"),
        ("f 1/1 2/1 3/1", "texture coordinate 1 of 0"),
        ("f 1//1 2//1 3//1", "normal 1 of 0"),
        ("f 1 2 x", "line 4 cannot be read: f 1 2 x"),
        ("f /1 2 3", "line 4 cannot be read: f /1 2 3"),
        ("f 1/1/1/1 2 3", "line 4 cannot be read: f 1/1/1/1 2 3"),
        ("v nan 0 0\nf 1 2 3 4", "finite"),
        ("f 1 2 99999999999999999999999999", "line 4 cannot be read"),
        ("v 1e400 0 0\nf 1 2 4", "finite"),
        ("v 0 0 0 300 0 0\nf 1 2 3", "vertex colours must lie in"),
        ("v 1 " + "9" * 5000 + "x 0", "line 4 cannot be read"),
    ],
)
def test_broken_lines_are_refused(tmp_path, line, message):
    with pytest.raises(FileError, match=message) as error:
        read_mesh(written(tmp_path / "a.obj", TRIANGLE + line + "\n"))
    assert len(str(error.value)) < 500


def test_combs_of_too_many_teeth_are_refused(tmp_path):
    for teeth, corners in ((999, 2000), (5000, 10_002)):
        points = [f"v {x} {1 + x % 2} 0\n" for x in range(2 * teeth)]
        points += [f"v {2 * teeth} 0 0\n", "v 0 0 0\n"]
        face = "f " + " ".join(str(n) for n in range(len(points), 0, -1))
        path = written(tmp_path / "a.obj", "".join(points) + face)
        if corners <= 10_000:
            assert len(read_mesh(path).faces) == corners - 2
        else:
            with pytest.raises(FileError, match=r"not convex has 10002 corners, more than 10000"):
                read_mesh(path)


@pytest.mark.parametrize("name", ["mtllib pipe", "mtllib a.mtl\nusemtl a"])
def test_pipes_are_not_opened(tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    written(tmp_path / "a.mtl", "newmtl a\nmap_Kd pipe\n")
    path = written(tmp_path / "a.obj", f"{name}\n{PICTURED}")
    with pytest.raises(FileError, match="is a pipe or a device"):
        read_mesh(path)
    os.mkfifo(tmp_path / "b.obj")
    with pytest.raises(FileError, match="is a pipe or a device"):
        read_mesh(tmp_path / "b.obj")


def test_a_texture_of_zeros_without_end_is_not_read(tmp_path):
    written(tmp_path / "a.mtl", "newmtl a\nmap_Kd /dev/zero\n")
    path = written(tmp_path / "a.obj", f"mtllib a.mtl\nusemtl a\n{PICTURED}")
    with pytest.raises(FileError, match="is a pipe or a device"):
        read_mesh(path)


@pytest.mark.parametrize("line", ["Kd 1 2", "Kd .5 .5 2", "Kd x", "map_Kd", "map_Kd -s"])
def test_broken_materials_are_named(tmp_path, line):
    written(tmp_path / "a.mtl", f"newmtl a\n{line}\n")
    path = written(tmp_path / "a.obj", f"mtllib a.mtl\n{PICTURED}")
    with pytest.raises(FileError, match=r"a\.mtl: cannot be read as MTL: (Kd|map_Kd)"):
        read_mesh(path)


def test_ten_thousand_materials_take_no_time(tmp_path):
    names = range(10_000)
    faces = "".join(f"usemtl m{n}\nf 1/1 2/2 3/3\n" for n in names)
    written(tmp_path / "a.mtl", "".join(f"newmtl m{n}\nKd .5 .5 .5\n" for n in names))
    path = written(tmp_path / "a.obj", f"mtllib a.mtl\n{PICTURED}{faces}")
    started = time.process_time()
    mesh = read_mesh(path)
    # A fifth of a second; each as a mesh of its own took 17.
    assert time.process_time() - started < 3
    assert len(mesh.faces) == 10_001
    assert len(mesh.vertices) == 6


def test_a_concave_face_of_very_many_corners_is_refused(tmp_path):
    angle = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
    radius = np.where(np.arange(20_000) % 2, 1, 0.9)
    lines = "".join(
        f"v {x:.6f} {y:.6f} 0\n"
        for x, y in zip(radius * np.cos(angle), radius * np.sin(angle), strict=True)
    )
    path = written(tmp_path / "a.obj", lines + f"f {' '.join(map(str, range(1, 20_001)))}\n")
    with pytest.raises(FileError, match="20000 corners"):
        read_mesh(path)


def test_faces_without_coordinates_leave_the_texture_to_the_others(tmp_path):
    Image.fromarray(np.full((4, 4), 51, np.uint8)).save(tmp_path / "skin.png")
    written(tmp_path / "a.mtl", "newmtl a\nKd .5 .5 .5\nmap_Kd skin.png\n")
    text = "mtllib a.mtl\nusemtl a\n" + TRIANGLE + "vt 0 0\nf 1/1 2/1 3/1\nv 0 0 5\nf 1 2 4\n"
    with pytest.warns(FileWarning) as notes:
        mesh = read_mesh(written(tmp_path / "a.obj", text), texture_linear=True)
    assert any("textures are left out" in str(note.message) for note in notes)
    of_face = mesh.albedo[mesh.faces][:, 0, 0]
    assert sorted(of_face) == pytest.approx([0.2, 0.5])
    assert (mesh.texture.image >= 0).sum() == 1
