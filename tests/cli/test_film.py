"""`harmface synth film` and `harmface film`."""

import json

import numpy as np
import pytest

from harmface.io import (
    read_cameras,
    read_coefficients,
    read_image,
    read_mesh,
    read_poses,
    read_surface,
    write_environment_map,
    write_image,
)
from harmface.light import layout_named


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    path = tmp_path_factory.mktemp("map") / "sky.hdr"
    up = layout_named("latlong").directions(16)[..., 1]
    write_environment_map(path, np.repeat(np.maximum(0.2 + up, 0.0)[..., None], 3, -1).astype("f4"))
    return path


@pytest.fixture
def film(tmp_path, run, environment):
    folder = tmp_path / "film"
    made = run(
        *("synth", "film", "--seed", "4", "--frames", "10", "--size", "24"),
        *("--environment", environment, "--out", folder),
    )
    assert made.code == 0
    return folder


def test_a_film_becomes_a_surface_that_others_read(film, tmp_path, run):
    out = tmp_path / "head"
    outcome = run("film", film, "--poses", film / "poses.csv", "--out", out)
    assert outcome.code == 0, outcome.err
    assert read_surface(out).mesh.vertices.shape[1] == 3
    assert len(read_mesh(out / "model.ply").faces) > 100
    assert read_coefficients(out / "light.json").shape == (1, 9)
    assert (out / "figure.png").stat().st_size > 1000
    summary = json.loads((out / "summary.json").read_text())
    assert summary["frames"] == 10
    assert 0 < summary["residual"] < 1
    views = read_poses(film / "poses.csv", 10)
    again, _ = read_cameras(out / "cameras.npy", 10)
    assert np.allclose(again.matrices, views.matrices)


def test_black_and_blurred_frames_are_left_out_and_said(film, tmp_path, run):
    write_image(film / "frame_003.png", np.zeros((24, 24)))
    write_image(
        film / "frame_005.png", np.full((24, 24), read_image(film / "frame_005.png").mean())
    )
    outcome = run("film", film, "--poses", film / "poses.csv", "--out", tmp_path / "head")
    assert outcome.code == 0, outcome.err
    assert "left out as black: frame_003.png" in outcome.out
    assert "left out as blurred: frame_005.png" in outcome.out
    assert "frames: 8" in outcome.out


def test_one_axis_is_allowed_and_said(tmp_path, run, environment):
    folder = tmp_path / "film"
    run(
        *("synth", "film", "--frames", "10", "--size", "24", "--turn", "yaw:-30:30"),
        *("--environment", environment, "--out", folder),
    )
    outcome = run("film", folder, "--poses", folder / "poses.csv", "--out", tmp_path / "head")
    assert outcome.code == 0, outcome.err
    assert "turns about one axis only" in outcome.out


def refused(outcome, out, *words):
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    for word in words:
        assert word in outcome.err
    assert not out.exists()


def test_bad_films_are_refused_in_one_line(film, tmp_path, run):
    out, poses = tmp_path / "head", film / "poses.csv"
    refused(run("film", film, "--out", out), out, "--cameras or --poses")
    np.save(tmp_path / "cameras.npy", np.tile(np.eye(3, 4), (9, 1, 1)))
    refused(run("film", film, "--cameras", tmp_path / "cameras.npy", "--out", out), out, "cameras")
    np.save(tmp_path / "text.npy", np.array(["a"]))
    refused(run("film", film, "--cameras", tmp_path / "text.npy", "--out", out), out, "no cameras")
    short = tmp_path / "short.csv"
    short.write_text("".join(poses.read_text().splitlines(keepends=True)[:-1]))
    refused(run("film", film, "--poses", short, "--out", out), out, "9 frames", "10")
    video = tmp_path / "film.mp4"
    video.write_bytes(b"no video")
    refused(run("film", video, "--poses", poses, "--out", out), out, "OpenCV cannot open")
    still = tmp_path / "still.csv"
    lines = poses.read_text().splitlines()
    still.write_text("\n".join([lines[0], *[f"f{n},0,0,0,{n},{n},1" for n in range(10)]]))
    refused(run("film", film, "--poses", still, "--out", out), out, "must turn")
    write_image(film / "masks" / "frame_004.png", np.ones((20, 24)), bits=8)
    refused(run("film", film, "--poses", poses, "--out", out), out, "20 x 24")
    write_image(film / "frame_004.png", np.ones((20, 24)))
    refused(run("film", film, "--poses", poses, "--out", out), out, "must be alike")


def test_bad_requests_of_a_film_are_refused(tmp_path, run, environment):
    out = tmp_path / "film"
    common = ("synth", "film", "--environment", environment, "--out", out)
    refused(run(*common, "--turn", "roll:3"), out, "yaw:-30:30")
    refused(run(*common, "--noise", "2"), out, "noise")
    refused(run(*common, "--frames", "1"), out, "frames")
