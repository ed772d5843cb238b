"""What `render` writes is a picture that looks right, and that other commands read unasked."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from harmface.io import read_image, write_environment_map, write_ply
from harmface.reproduce.synthetic import mesh_of

LAMPS = ("-40,0", "40,0", "0,40", "0,-30", "30,30", "-30,30", "25,-25", "-10,15")


@pytest.fixture(scope="module")
def heads(tmp_path_factory):
    folder = tmp_path_factory.mktemp("heads")
    for seed in (1, 2, 3):
        write_ply(folder / f"head_{seed}.ply", mesh_of(head(seed, n_vertices=5000)))
    return folder


def test_a_picture_is_encoded_for_the_screen_and_clear_outside_the_mesh(run, heads):
    assert run("render", heads / "head_1.ply", "--light", "30,20", "--size", 40, "--out", "a.png")
    run(
        *("render", heads / "head_1.ply", "--light", "30,20", "--size", 40),
        *("--bits", 16, "--out", "b.png"),
    )
    outcome = run(
        "render", heads / "head_1.ply", "--light", "30,20", "--size", 40, "--out", "a.jpg"
    )
    with Image.open("a.png") as picture:
        assert (picture.mode, picture.info["srgb"]) == ("RGBA", 0)
        alpha = np.asarray(picture)[..., 3]
    assert alpha[0, 0] == 0
    assert alpha[20, 20] == 255
    assert ((alpha > 0) & (alpha < 255)).any()  # smooth edges
    linear = read_image("b.png")
    assert linear.shape == (40, 40, 3)
    np.testing.assert_allclose(read_image("a.png"), linear, atol=0.006)
    assert np.abs(read_image("a.jpg") - linear).mean() < 0.005
    assert "(sRGB" in outcome.out


def test_recognize_gives_the_same_numbers_whatever_the_encoding(run, heads):
    run("enroll", heads, "--size", 40, "--out", "g.npz")
    light = ("render", heads / "head_2.ply", "--light", "30,20", "--size", 40)
    run(*light, "--out", "a.png")
    run(*light, "--bits", 16, "--out", "b.png")
    found = [
        json.loads(run("recognize", "g.npz", name, "--method", "9d", "--json").out)["results"][0]
        for name in ("a.png", "b.png")
    ]
    nearest = [each["ranking"][0] for each in found]
    assert {each["subject"] for each in nearest} == {"head_2"}
    assert nearest[0]["distance"] == pytest.approx(nearest[1]["distance"], abs=2e-3)


def test_stereo_and_light_read_it_unasked(run, heads):
    errors = {}
    for bits in (8, 16):
        Path(f"p{bits}").mkdir()
        for number, lamp in enumerate(LAMPS):
            run(
                *("render", heads / "head_1.ply", "--light", lamp, "--size", 48, "--bits", bits),
                *("--exposure", 0.9, "--out", f"p{bits}/{number}.png"),
            )
        outcome = run("stereo", f"p{bits}", "--out", f"s{bits}")
        assert outcome.code == 0, outcome.err
        errors[bits] = np.load(f"s{bits}/normals.npy")
    agree = (errors[8] * errors[16]).sum(axis=-1)
    seen = errors[16].any(axis=-1) & errors[8].any(axis=-1)
    assert np.degrees(np.arccos(np.clip(agree[seen], -1, 1))).mean() < 2
    outcome = run("envmap", "project", "p8/0.png", "--layout", "angular", "--json")
    assert "taken as linear" not in outcome.err


def test_a_material_changes_what_is_seen(run, heads):
    seen = {}
    for material in ("lambert", "ggx:0.3", "mirror"):
        light = ("--environment", "sky.hdr") if material == "mirror" else ("--light", "30,20")
        sky = np.zeros((8, 16, 3), np.float32)
        sky[:4] = 1
        write_environment_map("sky.hdr", sky)
        outcome = run(
            *("render", heads / "head_1.ply", *light, "--material", material, "--size", 24),
            *("--exposure", 0.2, "--bits", 16, "--out", "m.png"),
        )
        assert outcome.code == 0
        seen[material] = read_image("m.png")
    assert seen["ggx:0.3"].max() > 1.5 * np.median(seen["ggx:0.3"][seen["ggx:0.3"] > 0])
    assert np.abs(seen["ggx:0.3"] - seen["lambert"]).max() > 0.1
    # A mirror under a white dome shows it above and black below.
    values = seen["mirror"]
    assert values.max() > 0
    assert values[:8].mean() > values[18:].mean()


@pytest.mark.parametrize(
    ("light", "message"),
    [
        (("--light", "0,0", "--material", "mirror"), "a mirror shows lamps nowhere"),
        (("--environment", "grace", "--material", "ggx:0.3"), "needs a map or lamps"),
        (("--light", "0,0", "--material", "ggx"), "needs a number"),
    ],
)
def test_materials_that_the_light_cannot_show_are_refused(light, message, heads, check_refused):
    check_refused(message, "render", heads / "head_1.ply", *light, "--out", "m.png")
