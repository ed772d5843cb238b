import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from harmface import __version__
from harmface.io import read_image
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics

COMMANDS = [
    (),
    ("synth",),
    ("synth", "faces"),
    ("synth", "shapes"),
    ("basis",),
    ("render",),
    ("view",),
    ("transfer",),
    ("nearlight",),
    ("synth", "scene"),
    ("align",),
    ("enroll",),
    ("recognize",),
    ("reproduce",),
    ("pca",),
    ("cluster",),
    ("evaluate",),
    ("synth", "environments"),
    ("synth", "dataset"),
    ("envmap", "project"),
    ("envmap", "irradiance"),
    ("envmap", "convert"),
    ("envmap", "rotate"),
    ("envmap", "show"),
]


@pytest.fixture
def ball(run):
    assert run("synth", "shapes", "--out", "shapes").code == 0
    return "shapes/sphere.ply"


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_reads_like_a_manual_page(run, command):
    outcome = run(*command, "--help")
    assert outcome.code == 0
    assert "Usage: harmface" in outcome.out
    if command not in ((), ("synth",)):
        assert "Example: harmface" in outcome.out


def test_version(run):
    assert run("--version").out == f"{__version__}\n"


def test_the_program_is_installed():
    found = subprocess.run(
        [sys.executable, "-c", "import harmface.cli; harmface.cli.main(['--version'])"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.strip() == __version__


def test_basis_holds_albedo_times_lambert_times_harmonic(run, ball, tmp_path):
    outcome = run(
        *("basis", ball, "--size", 64, "--degree", 3, "--out", "b.npz", "--figure", "b.png")
    )
    assert outcome.code == 0
    with np.load(tmp_path / "b.npz") as file:
        basis, normals, albedo, mask = (file[k] for k in ("basis", "normals", "albedo", "mask"))
    assert basis.shape == (16, 64, 64)
    expected = albedo[mask] * lambert_per_coefficient(3)[:, None] * real_harmonics(normals[mask], 3)
    assert np.allclose(basis[:, mask], expected, atol=1e-5)
    assert not basis[:, ~mask].any()
    figure = np.asarray(Image.open(tmp_path / "b.png").convert("RGB")).astype(int)
    green = (figure[..., 1] > figure[..., 2] + 40).mean()
    blue = (figure[..., 2] > figure[..., 1] + 40).mean()
    assert green > 0.02
    assert blue > 0.02


def test_a_light_from_the_right_lights_the_right(run, ball, tmp_path):
    assert run("render", ball, "--light", "60,0", "--size", 64, "--out", "r.png").code == 0
    image = read_image(tmp_path / "r.png")
    assert image.shape == (64, 64, 3)
    assert image[:, 32:].mean() > 3 * image[:, :32].mean()
    assert run("render", ball, "--light", "0,60", "--size", 64, "--out", "u.png").code == 0
    image = read_image(tmp_path / "u.png")
    assert image[:32].mean() > 3 * image[32:].mean()


def test_cast_shadows_only_darken(run, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    arguments = ("render", "shapes/torus.ply", "--light", "70,20", "--size", 64, "--exposure", 0.9)
    run(*arguments, "--cast-shadows", "--out", "with.png")
    run(*arguments, "--no-cast-shadows", "--out", "without.png")
    difference = read_image(tmp_path / "without.png") - read_image(tmp_path / "with.png")
    assert difference.min() > -1e-4
    assert difference.max() > 0.1


def test_an_environment_map_lights_from_where_it_is_bright(run, ball, tmp_path):
    import cv2

    radiance = np.full((16, 32, 3), 0.1, np.float32)
    radiance[6:10, 6:10] = 50.0  # +x is at the left quarter
    cv2.imwrite(str(tmp_path / "e.hdr"), radiance)
    outcome = run("render", ball, "--environment", "e.hdr", "--size", 32, "--out", "e.png")
    assert outcome.code == 0
    image = read_image(tmp_path / "e.png")
    assert image[:, 16:].mean() > 2 * image[:, :16].mean()


def test_two_lights_add(run, ball, tmp_path):
    arguments = ("render", ball, "--size", 32, "--exposure", 0.5, "--bits", 16)
    run(*arguments, "--light", "30,0", "--out", "a.png")
    run(*arguments, "--light", "-30,0", "--out", "b.png")
    run(*arguments, "--light", "30,0", "--light", "-30,0", "--out", "c.png")
    a, b, c = (read_image(tmp_path / f"{name}.png") for name in "abc")
    # Three roundings of colours, and as many of the opacity at the edge.
    assert np.abs(a + b - c).max() < 3 / 2**16


def test_render_refuses_nonsense(ball, check_refused):
    render = ("render", ball, "--out", "x.png")
    check_refused("give either --light", *render)
    check_refused("give either --light", *render, "--light", "1,2", "--environment", "e.hdr")
    check_refused("AZIMUTH,ELEVATION", *render, "--light", "left")
    check_refused("elevation from -90 to 90", *render, "--light", "0,91")
    check_refused("elevation from -90 to 90", *render, "--light", "nan,0")
    check_refused("e.hdr: does not exist", *render, "--environment", "e.hdr")
    check_refused("bits must be 8 or 16", *render, "--light", "0,0", "--bits", 9)
    check_refused("rows of shape must be 1 or more", *render, "--light", "0,0", "--size", 0)
    check_refused("ends in .png or .jpg", "render", ball, "--out", "x.gif", "--light", "0,0")
    check_refused("JPEG", "render", ball, "--out", "x.jpg", "--light", "0,0", "--bits", 16)
    check_refused("No such option", *render, "--lamp", "0,0")


def test_basis_refuses_nonsense(ball, check_refused):
    check_refused("degree must be 0 or more", "basis", ball, "--degree", -1, "--out", "b.npz")
    check_refused("no.ply: does not exist", "basis", "no.ply", "--out", "b.npz")
    check_refused("ends in .png, .svg", "basis", ball, "--out", "b.npz", "--figure", "b.gif")
    check_refused("dpi", "basis", ball, "--out", "b.npz", "--figure", "b.pdf", "--dpi", 0)
    check_refused("smaller picture", "basis", ball, "--size", 10**6, "--out", "b.npz")


def test_a_population_is_made_again_byte_for_byte(run, tmp_path):
    run("synth", "faces", "--count", 2, "--seed", 5, "--out", "one")
    run("synth", "faces", "--count", 2, "--seed", 5, "--out", "two")
    files = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert files == ["face_000.ply", "face_001.ply", "manifest.json"]
    for name in files:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    manifest = json.loads((tmp_path / "one" / "manifest.json").read_text())
    assert [subject["file"] for subject in manifest["subjects"]] == files[:2]
    assert len(manifest["subjects"][0]["parameters"]) >= 40


def test_folders_of_others_are_left_alone(check_refused, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    (tmp_path / "file").write_text("")
    check_refused("holds other files", "synth", "faces", "--count", 1, "--out", "mine")
    check_refused("holds other files", "synth", "shapes", "--out", "mine")
    check_refused("cannot be used as a folder", "synth", "shapes", "--out", "file")
    check_refused("count must be 1 or more", "synth", "faces", "--count", 0, "--out", "new")
    check_refused("seed", "synth", "faces", "--count", 1, "--seed", -1, "--out", "new")


def test_heads_on_one_sheet(run, tmp_path):
    arguments = ("synth", "faces", "--count", 2, "--seed", 7, "--sheet", "s.png", "--out", "heads")
    assert run(*arguments).code == 0
    sheet = np.asarray(Image.open(tmp_path / "s.png")).astype(float)
    assert sheet.shape == (192, 384, 3)
    skin = sheet[96, [96, 288]]
    assert (skin[:, 0] > skin[:, 2]).all()


def test_environments_agree_with_their_coefficients(run, tmp_path):
    from harmface.io import read_environment_map
    from harmface.light import project

    assert run("synth", "environments", "--size", 64, "--out", "env").code == 0
    manifest = json.loads((tmp_path / "env" / "manifest.json").read_text())
    assert len(manifest["environments"]) >= 7
    for entry in manifest["environments"]:
        found = project(read_environment_map(tmp_path / "env" / entry["file"]), 2, "areas")
        exact = np.array(entry["coefficients"])[:, :9]
        # A map moves a small lamp by up to half a pixel, here 0.035 across the diagonal, and a
        # harmonic of degree 2 changes by up to sqrt(6) of an angle. The fine tests are elsewhere.
        assert np.linalg.norm(found - exact) < 0.085 * np.linalg.norm(exact)


def test_a_data_set_from_the_command_line(run, tmp_path):
    arguments = ("--identities", 1, "--lightings", "ninepoints", "--size", 16, "--out", "set")
    assert run("synth", "dataset", *arguments).code == 0
    assert (tmp_path / "set" / "manifest.json").exists()
    assert run("synth", "dataset", *arguments, "--seed", 1).code == 2
