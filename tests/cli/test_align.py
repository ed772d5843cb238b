import importlib
import json
import re

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from harmface.conventions import light_direction
from harmface.io import write_image
from harmface.io.pictures import read_picture
from harmface.light import DistantLight
from harmface.recognition import subject_photographs
from harmface.reproduce.synthetic import mesh_of

EYES = "52,70,108,70"


@pytest.fixture
def photographs(tmp_path):
    """Two people in two lights each, the second photographs wider than they are high."""
    lights = np.array([light_direction(0, 0), light_direction(35, 10)])
    for seed, name in enumerate(("ann", "bob")):
        mesh = mesh_of(head(seed, n_vertices=5000))
        images = subject_photographs(mesh, DistantLight(lights, np.eye(2)), 160)
        folder = tmp_path / "uncropped" / name
        folder.mkdir(parents=True)
        for number, image in enumerate(images):
            wide = np.pad(image, ((0, 0), (0, 40 * number)))
            codes = np.rint(250 * wide / images.max()).astype(np.uint8)
            Image.fromarray(np.stack([codes] * 3, axis=-1)).save(folder / f"{number}.png")
    return tmp_path


def write_points(folder, *lines):
    (folder / "eyes.csv").write_text("\n".join(lines) + "\n")


ALL = [f"{name}/{number}.png,{EYES}" for name in ("ann", "bob") for number in range(2)]


def test_eyes_by_hand_are_enough(run, photographs):
    write_points(photographs, *ALL)
    arguments = ("align", "uncropped", "--points", "eyes.csv", "--size", "96x84", "--out", "made")
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome.err
    record = json.loads(outcome.out)
    assert record["rows_and_columns"] == [96, 84]
    assert {each["told_by"] for each in record["photographs"]} == {"points"}
    made = sorted(path.relative_to(photographs) for path in photographs.glob("made/*/*.png"))
    assert [str(path) for path in made] == [f"made/{line.split(',')[0]}" for line in ALL]
    for path in made:
        with Image.open(photographs / path) as picture:
            assert (picture.size, picture.mode) == ((84, 96), "RGB")
    # 16.8 pixels from the left in the frame is 52 in the photograph: by 56 / 50.4.
    frame = np.array(record["photographs"][0]["frame"])
    assert np.allclose(frame @ [16.8, 25.92, 1], [52, 70])
    assert np.allclose(frame[:, :2], 56 / 50.4 * np.eye(2), atol=1e-12)
    # The same command again does the same.
    before = [(photographs / path).read_bytes() for path in made]
    assert run(*arguments).code == 0
    assert before == [(photographs / path).read_bytes() for path in made]


def test_the_aligned_are_enrolled_and_recognised(run, photographs):
    write_points(photographs, *ALL)
    run("align", "uncropped", "--points", "eyes.csv", "--size", "48x42", "--out", "made")
    outcome = run("enroll", "made", "--gallery", "first:1", "--out", "people.npz")
    assert outcome.code == 0, outcome.err
    outcome = run("recognize", "people.npz", "made/ann/1.png", "--json")
    assert json.loads(outcome.out)["results"][0]["ranking"][0]["subject"] == "ann"


@pytest.mark.parametrize(
    ("pattern", "lines"),
    [
        (r"ann/0\.png: has 160 x 160 pixels, but an eye outside: 52, 70, 208, 70; correct --points",
         [f"ann/0.png,{EYES.replace('108', '208')}", *ALL[1:]]),
        (r"eyes\.csv: carl/0\.png names no photograph in uncropped", [*ALL, f"carl/0.png,{EYES}"]),
        (r"eyes\.csv: 0\.png names 2 photographs", [*ALL, f"0.png,{EYES}"]),
        (r"eyes\.csv: ann/0\.png is named twice", [*ALL, ALL[0]]),
        (r"eyes\.csv: must hold file,x,y,x,y", ["ann/0.png,1,2,3"]),
        (r"uncropped/ann: eyes must hold the left one in the picture first",
         ["ann/0.png,108,70,52,70", *ALL[1:]]),
    ],
    ids=["outside", "nobody", "two", "twice", "three numbers", "swapped"],
)  # fmt: skip
def test_wrong_points_are_refused(check_refused, photographs, pattern, lines):
    write_points(photographs, *lines)
    check_refused(pattern, "align", "uncropped", "--points", "eyes.csv", "--out", "made")


def test_wrong_folders_and_detectors_are_refused(check_refused, photographs, monkeypatch):
    check_refused("nothing: is not a folder", "align", "nothing", "--out", "made")
    check_refused("lies in uncropped", "align", "uncropped", "--out", "uncropped/made")
    (photographs / "empty").mkdir()
    check_refused("empty: holds no photographs", "align", "empty", "--out", "made")
    check_refused(
        "eyes.onnx: is no file", "align", "uncropped", "--out", "made", "--detector", "eyes.onnx"
    )
    (photographs / "eyes.onnx").write_bytes(b"no network")
    check_refused(
        r"eyes\.onnx: is no face detector that OpenCV can read",
        *("align", "uncropped", "--out", "made", "--detector", "eyes.onnx"),
    )
    imported = importlib.import_module

    def without_dlib(name):
        if name == "dlib":
            raise ModuleNotFoundError(name)
        return imported(name)

    monkeypatch.setattr(importlib, "import_module", without_dlib)
    check_refused(re.escape("pip install 'harmface[align]'"), "align", "uncropped", "--out", "made")


def test_a_photograph_without_a_face_is_named(check_refused, photographs, monkeypatch):
    """A detector that finds none in any; of the wide one the size differs from the best-lit."""
    write_points(photographs, ALL[0], *ALL[2:])
    monkeypatch.setattr("harmface.enrollment.eyes.dlib_eyes", lambda: lambda image: None)
    check_refused(
        r"ann/1\.png: shows no face that can be found; give its eyes by --points",
        *("align", "uncropped", "--points", "eyes.csv", "--out", "made"),
    )


def test_pictures_are_encoded_as_they_were(run, photographs):
    """One grey throughout comes out as the same linear grey, whatever the files said."""
    (photographs / "grey").mkdir()
    Image.new("L", (60, 60), 100).save(photographs / "grey" / "silent.png")
    write_image(photographs / "grey" / "srgb.png", np.full((60, 60), 0.3), bits=8, srgb=True)
    write_image(photographs / "grey" / "deep.png", np.full((60, 60), 0.3), bits=16)
    names = ("silent", "srgb", "deep")
    write_points(photographs, *(f"{name}.png,10,20,50,20" for name in names))
    outcome = run("align", "grey", "--points", "eyes.csv", "--size", "24x21", "--out", "made")
    assert outcome.code == 0, outcome.err
    for name in names:
        before, after = (read_picture(photographs / at / f"{name}.png") for at in ("grey", "made"))
        assert after.bits == before.bits
        assert np.allclose(after.linear(False), before.linear(False)[:24, :21], atol=1e-5)


def test_a_photograph_too_large_to_warp_is_refused(check_refused, photographs):
    (photographs / "long").mkdir()
    Image.new("L", (2**15, 4), 100).save(photographs / "long" / "a.png")
    write_points(photographs, "a.png,1,2,30,2")
    check_refused(
        "a.png: has more than 32767 rows or columns",
        *("align", "long", "--points", "eyes.csv", "--out", "made"),
    )
