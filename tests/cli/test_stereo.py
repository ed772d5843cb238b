import json

import numpy as np
import pytest
from scipy.io import savemat

from data_synth.lightings import uniform_directional
from data_synth.shapes import bumpy_sphere
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_mesh, write_image
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of

COUNT = 24


@pytest.fixture
def capture(tmp_path):
    """A DiLiGenT folder of a bumpy sphere under single lights, as 16-bit photographs."""
    mesh = mesh_of(bumpy_sphere())
    view = gbuffer(mesh, frame_orthographic(mesh, 48))
    lights = light_of(uniform_directional(COUNT, 0, max_polar=60))
    images = render(view, lights)
    folder = tmp_path / "ball"
    folder.mkdir()
    names = [f"{number:03d}.png" for number in range(COUNT)]
    for name, image in zip(names, images, strict=True):
        write_image(folder / name, image)
    (folder / "filenames.txt").write_text("\n".join(names))
    np.savetxt(folder / "light_directions.txt", lights.directions)
    np.savetxt(folder / "light_intensities.txt", np.ones((COUNT, 3)))
    write_image(folder / "mask.png", view.mask.astype(float), bits=8)
    savemat(folder / "Normal_gt.mat", {"Normal_gt": view.normals})
    return folder


def test_known_lights_recover_the_surface(run, capture, tmp_path):
    outcome = run("stereo", "ball", "--method", "known-lights", "--out", "surface")
    assert outcome.code == 0
    summary = json.loads((tmp_path / "surface" / "summary.json").read_text())
    assert summary["images"] == COUNT
    assert summary["mean_angular_error_degrees"] < 2
    arrays = {path.stem: np.load(path) for path in (tmp_path / "surface").glob("*.npy")}
    assert set(arrays) == {"normals", "albedo", "depth", "confidence"}
    assert arrays["normals"].shape == (48, 48, 3)
    assert len(read_mesh(tmp_path / "surface" / "mesh.ply").faces) > 500
    assert (tmp_path / "surface" / "figure.png").stat().st_size > 10_000


def test_unknown_light_recovers_a_surface(run, capture, tmp_path):
    files = sorted(capture.glob("0*.png"))
    outcome = run(
        *("stereo", *files, "--mask", capture / "mask.png", "--method", "4d", "--out", "surface")
    )
    assert outcome.code == 0
    summary = json.loads((tmp_path / "surface" / "summary.json").read_text())
    assert summary["method"] == "first order"
    assert "mean_angular_error_degrees" not in summary


@pytest.mark.usefixtures("unchecked")
def test_bad_input_is_refused(capture, check_refused, tmp_path):
    stereo = ("stereo", "ball", "--out", "surface")
    files = sorted(capture.glob("0*.png"))
    (tmp_path / "short.txt").write_text("0 0 1\n")
    (tmp_path / "text.txt").write_text("to the left\n")
    write_image(tmp_path / "small.png", np.ones((4, 4)))
    directions = capture / "light_directions.txt"
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    known = ("--method", "known-lights")
    check_refused("method must be one of", *stereo, "--method", "magic")
    check_refused("linear or srgb", *stereo, "--gamma", "2.2")
    check_refused("needs --lights", "stereo", *files, "--out", "s", *known)
    check_refused("1 lines of 3 numbers, but 24", *stereo, *known, "--lights", "short.txt")
    check_refused("not a table of numbers", *stereo, *known, "--lights", "text.txt")
    check_refused("images", "stereo", *files[:3], "--method", "4d", "--out", "s")
    check_refused("holds no photographs", "stereo", "mine", "--out", "s")
    check_refused("nothing.png: does not exist", "stereo", "nothing.png", "--out", "s")
    check_refused("mask", "stereo", *files, "--mask", "small.png", "--out", "s")
    check_refused(
        "holds other files", "stereo", *files, *known, "--lights", directions, "--out", "mine"
    )
    (capture / "Normal_gt.mat").write_bytes(b"MATLAB")
    check_refused("Normal_gt", *stereo)
    (capture / "filenames.txt").write_text("../secret.png")
    check_refused("plain file names", *stereo)
