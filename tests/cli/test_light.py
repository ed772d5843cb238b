"""Light from photographs, relighting and conversion, as a user would."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import binary_erosion

from data_synth.environments import ENVIRONMENTS, rasterise
from data_synth.faces import head
from harmface.conventions import linear_to_srgb, luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import (
    read_coefficients,
    read_environment_map,
    read_image,
    write_environment_map,
    write_image,
    write_ply,
)
from harmface.light.interchange import TOOLS
from harmface.rendering import box_average, render
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import real_harmonics

LIGHT = np.array([[4.0, 0.6, 0.9, -0.5, 0.3, -0.4, 0.2, 0.5, -0.3]] * 3)


@pytest.fixture(scope="module")
def mesh():
    return mesh_of(head(2, n_vertices=5000))


@pytest.fixture(scope="module")
def made(mesh, tmp_path_factory):
    """A head, two procedural maps, and a photograph under one of them by brute force."""
    folder = tmp_path_factory.mktemp("made")
    write_ply(folder / "head.ply", mesh)
    (folder / "env").mkdir()
    for name in ("nave", "clear_sky"):
        image = rasterise(ENVIRONMENTS[name](), 16).astype(np.float32)
        write_environment_map(folder / "env" / f"{name}.hdr", image)
    light = read_environment_map(folder / "env" / "nave.hdr").as_distant_light(300)
    view = gbuffer(mesh, frame_orthographic(mesh, 96))
    image = render(view, light, albedo=np.moveaxis(view.albedo, -1, 0), caster=mesh)
    image *= 0.95 / np.percentile(image[:, view.mask], 99.5)
    write_image(folder / "photo.png", np.moveaxis(box_average(image, 2), 0, -1))
    return folder


@pytest.fixture
def photo(run, made, tmp_path):
    """Those files, in the folder where commands run."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    return "photo.png"


@pytest.fixture
def ball(tmp_path):
    """A white ball under a known light, its normals beside it."""
    at = (np.arange(40) + 0.5) / 20 - 1
    x, y = np.meshgrid(at, -at)
    inside = x**2 + y**2 < 0.98
    normals = np.stack([x, y, np.sqrt(np.where(inside, 1 - x**2 - y**2, 0))], axis=-1)
    normals[~inside] = 0
    np.save(tmp_path / "normals.npy", normals)
    image = np.zeros((40, 40))
    image[inside] = np.maximum(normals[inside] @ [0.48, 0.36, 0.8], 0) * 0.6 + 0.3
    write_image(tmp_path / "ball.png", image)
    write_image(tmp_path / "normals.png", np.where(inside[..., None], (normals + 1) / 2, 0))
    return image


def test_light_is_told_and_written(run, photo):
    outcome = run("light", photo, "--mesh", "head.ply", "--figure", "l.png", "--out", "l.json")
    assert outcome.code == 0, outcome.err
    assert "dominant direction" in outcome.out
    told = json.loads(Path("l.json").read_text())
    assert np.shape(told["coefficients"]) == (3, 9)
    assert np.shape(told["covariance"]) == (3, 9, 9)
    assert told["residual"][0] < 0.05
    assert read_image("l.png").ndim == 3
    again = run("light", photo, "--mesh", "head.ply", "--json")
    assert json.loads(again.out)["coefficients"] == told["coefficients"]


def test_relit_photographs_resemble_rendered_ones(run, photo):
    city = "env/clear_sky.hdr"
    run("render", "head.ply", "--environment", city, "--size", 48, "--out", "wanted.png")
    assert (
        run("relight", photo, "--mesh", "head.ply", "--environment", city, "--out", "r.png").code
        == 0
    )
    wanted, relit = luminance(read_image("wanted.png")), luminance(read_image("r.png"))
    lit = binary_erosion(wanted > 0.05)
    before = luminance(read_image(photo))

    def alike(image):
        return np.corrcoef(image[lit], wanted[lit])[0, 1]

    assert alike(relit) > 0.97
    assert alike(relit) > alike(before)


@pytest.mark.parametrize("option", [("--light", "40,20"), ("--coefficients", "l.json")])
def test_other_new_lights(run, photo, option):
    run("light", photo, "--mesh", "head.ply", "--out", "l.json")
    outcome = run(
        "relight", photo, "--mesh", "head.ply", *option, "--from-light", "l.json", "--out", "r.png"
    )
    assert outcome.code == 0, outcome.err
    if option[0] == "--coefficients":
        same, photograph = read_image("r.png"), read_image(photo)
        assert np.median(np.abs(same - photograph)) < 1e-4


def test_normals_and_an_unknown_albedo(run, ball):
    outcome = run("light", "ball.png", "--normals", "normals.npy", "--json")
    assert outcome.code == 0, outcome.err
    told = json.loads(outcome.out)
    assert np.degrees(np.arccos(np.clip(np.dot(told["direction"], [0.48, 0.36, 0.8]), -1, 1))) < 5
    assert any("median albedo" in note for note in told["notes"])
    picture = run("light", "ball.png", "--normals", "normals.png", "--json")
    assert np.allclose(json.loads(picture.out)["direction"], told["direction"], atol=0.01)


def test_what_is_not_told_is_null(run, ball):
    told = json.loads(
        run(
            "light", "ball.png", "--normals", "normals.npy", "--degree", 3, "--albedo", "constant",
            "--json",
        ).out
    )  # fmt: skip
    assert told["coefficients"][0][9:] == [None] * 7
    assert any("tells nothing of coefficients (3, -3)" in note for note in told["notes"])


def test_a_prior_is_learned_from_a_folder(run, photo, ball):
    arguments = ("light", "ball.png", "--normals", "normals.npy", "--albedo", "constant")
    told = json.loads(run(*arguments, "--degree", 3, "--prior", "env", "--rotations", "--json").out)
    assert None not in told["coefficients"][0]


def test_encoded_photographs_are_noticed(run, photo):
    codes = np.rint(255 * linear_to_srgb(read_image(photo))).astype(np.uint8)
    # It does not say how it is encoded.
    Image.fromarray(codes).save("encoded.png")
    told = run("light", "encoded.png", "--mesh", "head.ply").err
    assert "try --srgb" in told
    assert "try --srgb" not in run("light", photo, "--mesh", "head.ply").err
    assert "try --srgb" not in run("light", "encoded.png", "--srgb", "--mesh", "head.ply").err


def test_landmarks_place_the_mesh(run, photo, mesh):
    camera = frame_orthographic(mesh, 48)
    some = mesh.vertices[[5, 800, 2000, 3000, 4500]]
    scale = camera.height / 48
    lines = [
        f"{(x - camera.center[0]) / scale + 24} {24 - (y - camera.center[1]) / scale} {x} {y} {z}"
        for x, y, z in some
    ]
    Path("marks.txt").write_text("\n".join(lines))
    plain = json.loads(run("light", photo, "--mesh", "head.ply", "--json").out)
    placed = json.loads(
        run("light", photo, "--mesh", "head.ply", "--landmarks", "marks.txt", "--json").out
    )
    assert np.allclose(plain["coefficients"], placed["coefficients"], atol=0.02)


@pytest.mark.parametrize("name", ["harmface", *TOOLS])
def test_coefficients_go_to_a_tool_and_back(run, name):
    light = LIGHT[:1] if name == "dpr" else LIGHT
    Path("l.json").write_text(json.dumps({"coefficients": light.tolist()}))
    for file in ("x.txt", "x.npy") if name != "harmface" else ("x.json",):
        assert (
            run(
                "light", "convert", "l.json", "--from", "harmface", "--to", name, "--out", file
            ).code
            == 0
        )
        back = run("light", "convert", file, "--from", name, "--to", "harmface", "--out", "b.json")
        assert back.code == 0, back.err
        assert np.allclose(read_coefficients("b.json"), light, atol=1e-9)


def test_the_beginning_of_a_name_will_do_where_it_is_of_one_tool_alone(run):
    Path("l.json").write_text(json.dumps({"coefficients": LIGHT.tolist()}))
    whole, begun, exact = (
        run("light", "convert", "l.json", "--from", "harm", "--to", name)
        for name in ("three.js", "three", "filament")
    )
    assert begun.out == whole.out and '"LightProbe"' in begun.out
    # Two names begin with it, and one of them is it.
    assert "pre-scaled" in exact.out


def test_a_window_fades_degrees_as_filament_does(run):
    Path("l.json").write_text(json.dumps({"coefficients": LIGHT.tolist()}))
    arguments = ("--from", "harmface", "--to", "harmface", "--window", 3, "--out", "w.json")
    assert run("light", "convert", "l.json", *arguments).code == 0
    factors = np.repeat([1, (3**1.5 / (2 * np.pi)) ** 4, (3**1.5 / (4 * np.pi)) ** 4], [1, 3, 5])
    assert np.allclose(read_coefficients("w.json"), LIGHT * factors, rtol=1e-12)


def test_glsl_is_the_matrix_of_rh01(run):
    Path("l.json").write_text(json.dumps({"coefficients": LIGHT.tolist()}))
    text = run("light", "convert", "l.json", "--from", "harmface", "--to", "glsl").out
    matrix = np.array(re.search(r"Mr = mat4\((.*)\)", text)[1].split(", "), float).reshape(4, 4)
    n = np.array([0.48, 0.36, 0.8])
    bands = np.pi * np.repeat([1, 2 / 3, 0.25], [1, 3, 5])
    expected = LIGHT[0] * bands @ real_harmonics(n, 2)
    assert np.append(n, 1) @ matrix @ np.append(n, 1) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("albedo", [(), ("--albedo", "constant")])
def test_a_wall_seen_from_the_front_determines_no_coefficient_alone(run, rng, albedo):
    np.save("wall.npy", np.tile([0.0, 0.0, 1.0], (40, 40, 1)))
    write_image("wall.png", 0.5 + 0.01 * rng.random((40, 40)), bits=16, srgb=False)
    found = run("light", "wall.png", "--normals", "wall.npy", *albedo, "--json")
    assert found.code == 0
    told = json.loads(found.out)
    assert not any(told["determined"])
    assert "tells nothing of coefficients (0, 0), (1, -1)" in told["notes"][0]


BAD = [
    ("either --mesh", ("light", "ball.png")),
    ("either --mesh", ("light", "ball.png", "--mesh", "a.ply", "--normals", "normals.npy")),
    ("does not exist", ("light", "ball.png", "--normals", "none.npy")),
    ("normals of the same photograph", ("light", "ball.png", "--normals", "small.npy")),
    ("unit length", ("light", "ball.png", "--normals", "long.npy")),
    ("no array of real numbers", ("light", "ball.png", "--normals", "nan.npy")),
    ("three components", ("light", "ball.png", "--normals", "flat.npy")),
    ("black everywhere", ("light", "black.png", "--normals", "normals.npy")),
    ("is clipped on", ("light", "white.png", "--normals", "normals.npy")),
    ("--landmarks and --align", ("light", "ball.png", "--normals", "normals.npy", "--align")),
    ("must be a folder", ("light", "ball.png", "--normals", "normals.npy", "--prior", "none")),
    ("--rotations says", ("light", "ball.png", "--normals", "normals.npy", "--rotations")),
    ("--albedo mesh needs", ("light", "ball.png", "--normals", "normals.npy", "--albedo", "mesh")),
    ("0 or more", ("light", "ball.png", "--normals", "normals.npy", "--degree", -1)),
    ("give one of", ("relight", "ball.png", "--normals", "normals.npy", "--out", "r.png")),
    (
        "tool must be one of harmface",
        ("light", "convert", "eight.json", "--from", "x", "--to", "deca"),
    ),
    (
        "tool must be one of harmface",
        ("light", "convert", "own9.json", "--from", "harmface", "--to", "d"),
    ),
    (
        "positive cutoff",
        ("light", "convert", "own9.json", "--from", "harm", "--to", "deca", "--window", 0),
    ),
    ("27 numbers", ("light", "convert", "eight.json", "--from", "deca", "--to", "dpr")),
    ("27 numbers", ("light", "convert", "more.json", "--from", "sfsnet", "--to", "dpr")),
    ("a square", ("light", "convert", "own8.json", "--from", "harmface", "--to", "deca")),
    ("finite", ("light", "convert", "nan.txt", "--from", "dpr", "--to", "deca")),
    ("only written", ("light", "convert", "nan.txt", "--from", "glsl", "--to", "deca")),
    ("no numbers", ("light", "convert", "words.txt", "--from", "dpr", "--to", "deca")),
    ('no "sh"', ("light", "convert", "own8.json", "--from", "three.js", "--to", "deca")),
]


@pytest.mark.parametrize(("message", "arguments"), BAD, ids=range(len(BAD)))
def test_bad_input_is_refused_in_one_line(check_refused, ball, tmp_path, message, arguments):
    np.save(tmp_path / "small.npy", np.load(tmp_path / "normals.npy")[:20])
    np.save(tmp_path / "long.npy", 2 * np.load(tmp_path / "normals.npy"))
    np.save(tmp_path / "nan.npy", np.full((40, 40, 3), np.nan))
    np.save(tmp_path / "flat.npy", np.ones((40, 40)))
    write_image(tmp_path / "black.png", np.zeros((40, 40)))
    write_image(tmp_path / "white.png", np.ones((40, 40)))
    (tmp_path / "eight.json").write_text(json.dumps([1.0] * 8))
    (tmp_path / "more.json").write_text(json.dumps([1.0] * 26))
    for count in (8, 9):
        (tmp_path / f"own{count}.json").write_text(json.dumps({"coefficients": [[1.0] * count]}))
    (tmp_path / "nan.txt").write_text(" ".join(["nan"] * 9))
    (tmp_path / "words.txt").write_text("none")
    check_refused(re.escape(message), *arguments)
