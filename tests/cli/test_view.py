import json
import re

import numpy as np
import pytest

from harmface.io import write_npz, write_ply
from harmface.light import published_probe
from harmface.reproduce.synthetic import mesh_of


def scene(path):
    text = re.search(
        r'<script type="application/json" id="scene">(.*?)</script>', path.read_text(), re.DOTALL
    )
    return json.loads(text[1])


@pytest.fixture
def ball(tmp_path):
    from data_synth.shapes import sphere

    write_ply(tmp_path / "ball.ply", mesh_of(sphere(32)))
    return tmp_path / "ball.ply"


@pytest.fixture
def map_file(run):
    assert run("envmap", "irradiance", "grace", "--size", 16, "--out", "map.hdr").code == 0
    return "map.hdr"


def test_a_mesh_under_a_map(run, tmp_path, ball, map_file):
    outcome = run("view", ball, "--environment", map_file, "--reference", "--out", "view.html")
    assert outcome.code == 0
    assert re.fullmatch(r"2143 vertices, 0\.\d MB in view.html\n", outcome.out)
    found = scene(tmp_path / "view.html")
    names = [light["name"] for light in found["lights"]]
    assert names[:4] == ["map.hdr", "grace", "eucalyptus", "st-peters"]
    assert {"lamp", "nave", "clear sky sun"} <= set(names)
    assert found["map"]["height"] == 16
    assert found["lights"][0]["reference"]


@pytest.mark.parametrize("option", ["--environment", "--coefficients"])
def test_a_mesh_under_coefficients(run, tmp_path, ball, map_file, option):
    light = published_probe("st-peters")
    (tmp_path / "light.json").write_text(json.dumps({"coefficients": light.tolist()}))
    assert run("view", ball, option, "light.json", "--out", "view.html").code == 0
    first = scene(tmp_path / "view.html")["lights"][0]
    np.testing.assert_allclose(np.array(first["coefficients"])[:, :9], light)


def test_a_mesh_with_fewer_vertices(run, tmp_path, ball):
    outcome = run("view", ball, "--decimate", 300, "--out", "view.html")
    assert outcome.code == 0
    assert 250 < int(outcome.out.split()[0]) < 330


def test_a_mesh_with_transfer_vectors(run, tmp_path, ball):
    sampled = ("--degree", 2, "--samples", 128, "--out", "transfer.npz")
    assert run("transfer", ball, *sampled).code == 0
    assert run("view", ball, "--transfer", "transfer.npz", "--out", "view.html").code == 0
    assert scene(tmp_path / "view.html")["transfer"]["channels"] == 3


def test_what_stereo_wrote(run, tmp_path, rng):
    from data_synth.lightings import nine_points
    from data_synth.shapes import bumpy_sphere
    from harmface.io import write_image
    from harmface.reproduce.synthetic import probe_images

    lights = nine_points()
    for number, image in enumerate(probe_images(mesh_of(bumpy_sphere()), lights, 48, rng)):
        write_image(tmp_path / f"photo_{number}.png", image)
    assert run("stereo", *sorted(tmp_path.glob("photo_*.png")), "--out", "surface").code == 0
    assert run("view", "surface", "--environment", "grace", "--out", "view.html").code == 0
    found = scene(tmp_path / "view.html")
    assert list(found["colours"]) == ["confidence"]
    # Its normals are those that were found, not those of the faces.
    from base64 import b64decode

    normals = np.frombuffer(b64decode(found["normals"]), "<i2").reshape(-1, 3) / 32767
    depth = np.load(tmp_path / "surface" / "depth.npy")
    np.testing.assert_allclose(
        normals, np.load(tmp_path / "surface" / "normals.npy")[depth != 0], atol=1e-4
    )


def test_a_subject_of_a_gallery(run, tmp_path):
    assert run("synth", "faces", "--count", 2, "--out", "faces").code == 0
    (tmp_path / "faces" / "face_000.ply").rename(tmp_path / "faces" / "<script>alert(1)<.ply")
    assert run("enroll", "faces", "--size", 32, "--out", "gallery.npz").code == 0
    assert run("view", "gallery.npz", "--subject", "face_001", "--out", "view.html").code == 0
    found = scene(tmp_path / "view.html")
    assert found["flat"]
    assert len(found["transfer"]["scales"]) == 25
    assert run("view", "gallery.npz", "--out", "first.html").code == 0
    text = (tmp_path / "first.html").read_text()
    assert "&lt;script&gt;alert(1)&lt;" in text
    assert "<script>alert" not in text


def test_bad_input_is_refused_in_one_line(check_refused, run, tmp_path, ball, map_file):
    (tmp_path / "empty").mkdir()
    view = ("view", ball, "--out", "view.html")
    check_refused("does not exist|No such file", "view", "no.ply", "--out", "view.html")
    check_refused(r"ends in \.html", "view", ball, "--out", "view.png")
    check_refused("not a folder that `harmface stereo`", "view", "empty", "--out", "view.html")
    check_refused("--subject is for galleries", *view, "--subject", "ann")
    check_refused("--reference needs a map", *view, "--environment", "grace", "--reference")
    check_refused("--reference needs a map", *view, "--reference")
    check_refused("--decimate must be 4 or more", *view, "--decimate", 3)
    check_refused("give one of them", *view, "--decimate", 30, "--transfer", "t.npz")
    check_refused("are for meshes", "view", "empty", "--reference", "--out", "view.html")
    write_npz("transfer.npz", "transfer", 1, {"transfer": np.ones((9, 7))})
    check_refused("the transfer of another mesh", *view, "--transfer", "transfer.npz")
    check_refused("is read as well", "view", ball, "--out", ball)


def test_a_folder_whose_files_do_not_belong_together(check_refused, run, tmp_path, ball):
    folder = tmp_path / "surface"
    folder.mkdir()
    ball.rename(folder / "mesh.ply")
    shapes = {"normals": (4, 4, 3), "albedo": (4, 4), "depth": (4, 4), "confidence": (4, 4)}
    for name, shape in shapes.items():
        np.save(folder / f"{name}.npy", np.ones(shape))
    view = ("view", "surface", "--out", "view.html")
    check_refused("do not belong together", *view)
    (folder / "depth.npy").write_bytes(b"\x93NUMPY")
    check_refused("holds no array of real numbers", *view)
    (folder / "depth.npy").unlink()
    check_refused("depth.npy is missing", *view)


def test_a_map_that_is_not_hdr_is_read_with_a_note(run, tmp_path, ball):
    from PIL import Image

    # It does not say how it is encoded.
    Image.fromarray(np.full((8, 16, 3), 128, np.uint8)).save(tmp_path / "map.png")
    outcome = run("view", ball, "--environment", "map.png", "--out", "view.html")
    assert outcome.code == 0
    assert "8 bits" in outcome.err
