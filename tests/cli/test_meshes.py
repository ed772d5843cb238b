"""How commands that take meshes read them, and what they say of them."""

import json

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from harmface.geometry import axis_rotations, frame_orthographic, gbuffer
from harmface.io import read_image, read_npz, write_glb, write_obj, write_ply
from harmface.reproduce.synthetic import mesh_of

HEAD = mesh_of(head(3, n_vertices=5000))


@pytest.fixture
def files(tmp_path):
    """Return a head as it should be, from behind, on its back, and inside out."""
    write_ply(tmp_path / "head.ply", HEAD)
    write_ply(tmp_path / "back.ply", HEAD.rotated(axis_rotations("y:180")))
    write_glb(tmp_path / "lying.glb", HEAD.rotated(axis_rotations("x:-90")))
    write_ply(tmp_path / "inside.ply", HEAD.flipped())
    return tmp_path


@pytest.fixture
def painted(tmp_path):
    """Return a head with its picture, light and all, as texture."""
    view = gbuffer(HEAD, frame_orthographic(HEAD, 128))
    picture = view.albedo * np.maximum(view.normals[..., 2:], 0)
    low, high = HEAD.bounds[:, :2]
    uv = 0.5 + (HEAD.vertices[:, :2] - (low + high) / 2) / (1.05 * (high - low).max())
    write_obj(tmp_path / "painted.obj", HEAD, picture, uv)
    write_obj(tmp_path / "over.obj", HEAD, picture, uv * [1, -1] + [0, 1])
    return tmp_path


def picture(run, path, *options):
    """Return what `render` shows of a mesh in light from above, and what it says on stderr."""
    outcome = run("render", path, "--light", "20,30", "--size", "48", "--out", "p.png", *options)
    assert outcome.code == 0
    return read_image("p.png"), " ".join(outcome.err.split())


def test_nothing_is_said_of_a_sound_head(run, files):
    shown, said = picture(run, "head.ply")
    assert shown.any()
    assert said == ""


def test_a_head_from_behind_is_said_and_turned(run, files):
    right, _ = picture(run, "head.ply", "--exposure", "1")
    _, said = picture(run, "back.ply")
    assert "back.ply: a face is seen from another side: try --rotate y:180" in said
    turned, said = picture(run, "back.ply", "--rotate", "y:180", "--exposure", "1")
    assert said == ""
    assert np.abs(turned - right).max() < 0.02


def test_a_lying_head_is_said_and_turned_further(run, files):
    right, _ = picture(run, "head.ply", "--exposure", "1")
    _, said = picture(run, "lying.glb")
    assert "try --rotate x:90" in said
    turned, said = picture(run, "lying.glb", "--rotate", "x:90", "--exposure", "1")
    assert said == ""
    assert np.abs(turned - right).max() < 0.02
    _, said = picture(run, "lying.glb", "--rotate", "x:180")
    assert "try --rotate x:180,x:-90" in said


@pytest.mark.parametrize(
    "command",
    [
        ("render", "flat.obj", "--light", "0,0", "--size", "16", "--out", "p.png"),
        ("basis", "flat.obj", "--size", "16", "--out", "a.npz"),
        ("enroll", "flat.obj", "--size", "16", "--out", "g.npz"),
    ],
    ids=lambda command: command[0],
)
def test_a_flat_mesh_is_seen_from_the_front_only(run, check_refused, tmp_path, command):
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (tmp_path / "flat.obj").write_text(corners)
    outcome = run(*command)
    assert (outcome.code, outcome.err) == (0, "")
    check_refused("no ray meets it", *command, "--rotate", "y:90")


def test_a_head_that_is_inside_out_is_said_and_turned(run, files):
    right, _ = picture(run, "head.ply")
    black, said = picture(run, "inside.ply")
    assert not black.any()
    assert "inside out (--flip-normals)" in said
    turned, said = picture(run, "inside.ply", "--flip-normals")
    assert said == ""
    assert np.abs(turned - right).max() < 1e-3
    _, said = picture(run, "head.ply", "--flip-normals")
    assert "try without --flip-normals" in said


def test_a_texture_upside_down_is_said_and_turned(run, painted):
    right, said = picture(run, "painted.obj")
    assert "painted.png has 8 bits and is taken as sRGB" in said
    assert "flip-texture" not in said
    _, said = picture(run, "over.obj")
    assert "its texture shows a face when it is turned over: try --flip-texture" in said
    turned, said = picture(run, "over.obj", "--flip-texture")
    assert "shows a face" not in said
    assert np.abs(turned - right).max() < 0.02
    _, said = picture(run, "painted.obj", "--flip-texture")
    assert "try without --flip-texture" in said


def test_a_linear_texture(run, painted):
    assert run("basis", "painted.obj", "--size", "32", "--out", "a.npz").code == 0
    outcome = run("basis", "painted.obj", "--size", "32", "--texture-linear", "--out", "b.npz")
    assert "sRGB" not in outcome.err
    encoded, linear = (read_npz(painted / f"{name}.npz", "basis", 1)[0] for name in "ab")
    mask = linear["mask"]
    assert encoded["albedo"][mask].mean() < 0.7 * linear["albedo"][mask].mean()


@pytest.mark.parametrize(
    "command",
    [
        ("basis", "back.ply", "--size", "32", "--out", "a.npz"),
        ("pca", "back.ply", "--size", "32", "--json"),
        ("enroll", "back.ply", "--size", "32", "--out", "g.npz"),
    ],
    ids=lambda command: command[0],
)
def test_every_command_takes_the_same_options(run, files, command):
    outcome = run(*command)
    assert outcome.code == 0
    assert "try --rotate y:180" in " ".join(outcome.err.split())
    outcome = run(*command, "--rotate", "y:180")
    assert outcome.code == 0
    assert outcome.err == ""
    for option in ("--texture", "--texture-linear", "--flip-texture", "--flip-normals"):
        assert option in run(command[0], "--help").out


def test_json_is_not_disturbed_by_notes(run, files):
    outcome = run("pca", "back.ply", "--size", "32", "--json")
    assert len(json.loads(outcome.out)["eigenvalue_fractions"]) == 9


def test_a_texture_for_all_that_are_enrolled(run, painted):
    Image.fromarray(np.full((4, 4, 3), 100, np.uint8)).save(painted / "grey.png")
    made = ("enroll", "painted.obj", "--size", "32", "--out", "g.npz")
    assert run(*made, "--texture", "grey.png", "--texture-linear").code == 0


def test_options_that_do_not_apply_are_refused(run, check_refused, files):
    assert run("basis", "head.ply", "--size", "32", "--out", "a.npz").code == 0
    check_refused("do not apply", "pca", "a.npz", "--flip-normals")
    check_refused("AXIS:DEGREES", "basis", "head.ply", "--rotate", "left", "--out", "b.npz")
    (files / "people" / "ann").mkdir(parents=True)
    Image.fromarray(np.zeros((8, 8), np.uint8)).save(files / "people" / "ann" / "a.png")
    check_refused("are for meshes", "enroll", "people", "--rotate", "y:90", "--out", "b.npz")
