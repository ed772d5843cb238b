import json

import numpy as np
import pytest
from PIL import Image

from harmface.io import read_gallery


@pytest.fixture
def faces(run):
    assert run("synth", "faces", "--count", 3, "--seed", 1, "--out", "faces").code == 0


@pytest.fixture
def gallery(run, faces):
    assert run("enroll", "faces", "--size", 48, "--out", "gallery.npz").code == 0


def test_a_rendered_face_is_recognised(run, gallery):
    for number in range(3):
        out = f"probe_{number}.png"
        mesh = f"faces/face_{number:03d}.ply"
        assert run("render", mesh, "--light", "40,20", "--size", 48, "--out", out).code == 0
    probes = [f"probe_{number}.png" for number in range(3)]
    outcome = run("recognize", "gallery.npz", *probes, "--json")
    assert outcome.code == 0
    results = json.loads(outcome.out)["results"]
    assert [result["image"] for result in results] == probes
    assert [result["ranking"][0]["subject"] for result in results] == [
        "face_000",
        "face_001",
        "face_002",
    ]
    for result in results:
        distances = [entry["distance"] for entry in result["ranking"]]
        assert len(distances) == 3
        assert distances == sorted(distances)
        assert 0 < distances[0] < 0.3


def test_a_table_for_people(run, gallery):
    run("render", "faces/face_001.ply", "--light", "-30,10", "--size", 48, "--out", "p.png")
    outcome = run("recognize", "gallery.npz", "p.png", "--method", "4d", "--top", 2)
    assert outcome.code == 0
    assert "face_001" in outcome.out
    assert "rank" in outcome.out


def test_subjects_are_named_after_their_files(run, faces, tmp_path):
    assert run("enroll", "faces/face_002.ply", "faces/face_000.ply", "--out", "g.npz").code == 0
    assert read_gallery(tmp_path / "g.npz").subjects == ("face_002", "face_000")


def test_cast_shadows_bring_the_subspace_nearer(run, gallery):
    run("enroll", "faces", "--size", 48, "--cast-shadows", "--out", "shadows.npz")
    run("render", "faces/face_002.ply", "--light", "60,30", "--size", 48, "--out", "p.png")
    best = [
        json.loads(run("recognize", file, "p.png", "--json").out)["results"][0]["ranking"][0]
        for file in ("gallery.npz", "shadows.npz")
    ]
    assert [each["subject"] for each in best] == ["face_002", "face_002"]
    assert best[1]["distance"] < best[0]["distance"]


def test_encoded_and_eight_bit_photographs(run, gallery):
    run(
        *("render", "faces/face_001.ply", "--light", "20,30", "--size", 48),
        *("--bits", 8, "--srgb", "--out", "p.png"),
    )
    outcome = run("recognize", "gallery.npz", "p.png", "--srgb", "--json")
    best = json.loads(outcome.out)["results"][0]["ranking"][0]
    assert best["subject"] == "face_001"
    assert best["distance"] < 0.3


def test_bad_input_is_refused(gallery, check_refused, tmp_path, rng):
    def picture(name, codes):
        Image.fromarray(codes).save(tmp_path / name)
        return name

    noise = rng.integers(0, 256, (48, 48), dtype=np.uint8)
    good = picture("good.png", noise)
    recognize = ("recognize", "gallery.npz")
    check_refused("none.npz: does not exist", "recognize", "none.npz", good)
    check_refused("missing.png: does not exist", *recognize, "missing.png")
    check_refused(
        "small.png: has 8 x 9 pixels.*resize", *recognize, picture("small.png", noise[:8, :9])
    )
    check_refused("black.png: is all black", *recognize, picture("black.png", noise * 0))
    check_refused("one of 3d, 4d, 9d", *recognize, good, "--method", "5d")
    check_refused("1 or more", *recognize, good, "--top", 0)
    (tmp_path / "text.png").write_text("hello")
    check_refused("text.png: cannot be read as an image", *recognize, "text.png")
    broken = bytearray((tmp_path / "gallery.npz").read_bytes())
    broken[1000] ^= 1
    (tmp_path / "broken.npz").write_bytes(broken)
    check_refused("broken.npz: is damaged", "recognize", "broken.npz", good)
    check_refused("text.png: is not a harmface gallery", "recognize", "text.png", good)


def test_bad_meshes_are_refused(faces, check_refused, tmp_path):
    (tmp_path / "empty.ply").write_bytes(b"")
    (tmp_path / "cut.ply").write_bytes((tmp_path / "faces" / "face_000.ply").read_bytes()[:5000])
    (tmp_path / "bare").mkdir()
    (tmp_path / "again").mkdir()
    (tmp_path / "again" / "face_000.obj").write_text("v 0 0 0")
    enroll = ("enroll", "--out", "g.npz")
    check_refused("no.ply: does not exist", *enroll, "no.ply")
    check_refused("empty.ply: is empty", *enroll, "empty.ply")
    check_refused("cut.ply: promises .* elements", *enroll, "cut.ply")
    check_refused("bare: holds no mesh", *enroll, "bare")
    check_refused("second mesh of subject 'face_000'", *enroll, "faces", "again")
    check_refused("size must be 1 or more", *enroll, "faces", "--size", 0)
    check_refused("nowhere.*cannot be written", "enroll", "faces", "--out", "nowhere/g.npz")
