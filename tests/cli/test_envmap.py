import json

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from harmface.io import (
    read_environment_map,
    read_image,
    read_tool_coefficients,
    write_environment_map,
)
from harmface.light import EnvironmentMap, cone, project, published_probe
from harmface.light.layouts import layout_named
from harmface.sphere import synthesize

LAMP = np.array([0.6, 0.48, 0.64])


@pytest.fixture
def smooth(tmp_path):
    """A map whose light comes mostly from the right and above."""
    coefficients = np.stack([cone(LAMP, 1.2, np.array(1.0 + c), 6) for c in range(3)])
    coefficients[:, 0] += 3
    directions = layout_named("latlong").directions(32)
    radiance = np.maximum(synthesize(coefficients, directions), 0)
    write_environment_map(tmp_path / "m.hdr", np.moveaxis(radiance, 0, -1).astype(np.float32))
    return "m.hdr"


def coefficients_of(outcome):
    assert outcome.code == 0
    return np.array(json.loads(outcome.out)["coefficients"])


def test_project_writes_what_other_tools_read(run, check_refused, smooth, tmp_path):
    coefficients = project(read_environment_map(tmp_path / smooth), 2)
    printed = run("envmap", "project", smooth, "--format", "deca").out
    run("envmap", "project", smooth, "--format", "deca", "--out", "deca.json")
    assert (tmp_path / "deca.json").read_text() == printed
    assert np.allclose(read_tool_coefficients(tmp_path / "deca.json", "deca"), coefficients)
    for short, name in (("three", "three.js"), ("json", "harmface")):
        both = [run("envmap", "project", smooth, "--format", each).out for each in (short, name)]
        assert both[0] == both[1]
        (tmp_path / f"{short}.json").write_text(both[0])
        read = read_tool_coefficients(tmp_path / f"{short}.json", short)
        assert np.allclose(read, coefficients)
    refused = ("envmap", "project", smooth, "--out", "none.json", "--format")
    check_refused("tool must be one of harmface, three.js", *refused, "maya")
    check_refused("--json and --format are two ways to print", *refused, "unity", "--json")


def test_project_prints_channels_by_coefficients(run, smooth, tmp_path):
    found = coefficients_of(run("envmap", "project", smooth, "--degree", 3, "--json"))
    assert np.allclose(found, project(read_environment_map(tmp_path / smooth), 3))
    assert found.shape == (3, 16)
    # Degree 1 points to the lamp, in the order y, z, x.
    direction = found[0, [3, 1, 2]] / np.linalg.norm(found[0, 1:4])
    assert direction @ LAMP > 0.99
    assert "2, 2" in run("envmap", "project", smooth).out


@pytest.mark.parametrize("layout", ["cube", "angular", "mirror-ball"])
def test_conversion_keeps_the_light(run, smooth, layout):
    before = coefficients_of(run("envmap", "project", smooth, "--json"))
    assert (
        run("envmap", "convert", smooth, "--to", layout, "--size", 64, "--out", "c.hdr").code == 0
    )
    after = coefficients_of(run("envmap", "project", "c.hdr", "--layout", layout, "--json"))
    assert np.linalg.norm(after - before) < 0.01 * np.linalg.norm(before)


def test_rotation_turns_the_light_the_way_the_help_says(run, tmp_path):
    radiance = np.full((32, 64, 3), 0.01, np.float32)
    radiance[14:18, 30:34] = 20  # straight ahead, +z
    write_environment_map(tmp_path / "z.hdr", radiance)
    run("envmap", "rotate", "z.hdr", "--azimuth", 90, "--out", "x.hdr")
    found = coefficients_of(run("envmap", "project", "x.hdr", "--json"))[0]
    assert found[3] > 10 * max(abs(found[1]), abs(found[2]))
    run("envmap", "rotate", "z.hdr", "--elevation", 90, "--out", "y.hdr")
    found = coefficients_of(run("envmap", "project", "y.hdr", "--json"))[0]
    assert found[1] > 10 * max(abs(found[2]), abs(found[3]))


def test_irradiance_of_maps_coefficients_and_published_probes(run, smooth, tmp_path):
    outcome = run("envmap", "irradiance", smooth, "--compare", "--size", 16, "--out", "e.hdr")
    assert outcome.code == 0
    assert "average 0." in outcome.out
    from_map = read_environment_map(tmp_path / "e.hdr").radiance
    (tmp_path / "c.json").write_text(run("envmap", "project", smooth, "--json").out)
    run("envmap", "irradiance", "c.json", "--size", 16, "--out", "f.hdr")
    assert np.array_equal(read_environment_map(tmp_path / "f.hdr").radiance, from_map)
    assert run("envmap", "irradiance", "grace", "--size", 16, "--out", "g.hdr").code == 0
    grace = read_environment_map(tmp_path / "g.hdr")
    mean = grace.total() / (4 * np.pi)
    # The mean irradiance is pi times the mean radiance, L00 / sqrt(4 pi).
    expected = np.pi * published_probe("grace")[:, 0] / np.sqrt(4 * np.pi)
    assert np.allclose(mean, expected, rtol=0.02)


def test_a_window_is_applied_on_request_only(run, tmp_path):
    arguments = ("envmap", "irradiance", "grace", "--size", 16, "--out", "g.hdr")
    assert "clipped" in run(*arguments).out
    plain = read_environment_map(tmp_path / "g.hdr").radiance
    assert "clipped" not in run(*arguments, "--window", "non-negative").out
    softened = read_environment_map(tmp_path / "g.hdr").radiance
    assert np.ptp(softened) < np.ptp(plain)
    for name in ("hann", "lanczos"):
        assert run(*arguments, "--window", name).code == 0


def test_show_draws_a_picture(run, smooth, tmp_path):
    assert run("envmap", "show", smooth, "--out", "s.png").code == 0
    assert np.ptp(np.asarray(Image.open(tmp_path / "s.png").convert("L"))) > 100


def test_render_takes_every_kind_of_light(run, smooth, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    (tmp_path / "c.json").write_text(run("envmap", "project", smooth, "--json").out)
    common = ("--size", 32, "--exposure", 0.05)
    pictures = []
    for number, source in enumerate((smooth, "c.json")):
        out = f"{number}.png"
        arguments = ("render", "shapes/ellipsoid.ply", "--environment", source, "--out", out)
        assert run(*arguments, *common, "--no-cast-shadows").code == 0
        pictures.append(np.asarray(Image.open(tmp_path / out)).astype(float))
    assert np.abs(pictures[0] - pictures[1]).max() < 0.03 * pictures[0].max()
    out = ("--out", "g.png")
    assert run("render", "shapes/sphere.ply", "--environment", "grace", *out, *common).code == 0


def test_bad_input_is_refused(smooth, check_refused, tmp_path):
    (tmp_path / "bad.json").write_text('{"coefficients": [[1, 2]]}')
    (tmp_path / "cut.hdr").write_bytes((tmp_path / smooth).read_bytes()[:300])
    project = ("envmap", "project")
    check_refused("no.hdr: does not exist", *project, "no.hdr")
    check_refused("cut.hdr: ", *project, "cut.hdr")
    check_refused("m.hdr: an angular map", *project, smooth, "--layout", "angular")
    check_refused("layout must be one of", *project, smooth, "--layout", "sphere")
    check_refused("frame of a latlong map", *project, smooth, "--frame", "debevec")
    check_refused("degree must be 0", *project, smooth, "--degree", -1)
    irradiance = ("envmap", "irradiance")
    check_refused("bad.json: holds no lighting", *irradiance, "bad.json", "--out", "e.hdr")
    check_refused("needs a map", *irradiance, "grace", "--compare", "--out", "e.hdr")
    check_refused("hann, lanczos", *irradiance, "grace", "--window", "flat", "--out", "e.hdr")
    check_refused("must end in", *irradiance, "grace", "--out", "e.jpg")


def test_grey_maps_have_one_channel(run, tmp_path):
    write_environment_map(tmp_path / "g.pfm", np.ones((8, 16), np.float32))
    found = coefficients_of(run("envmap", "project", "g.pfm", "--degree", 0, "--json"))
    assert np.allclose(found, [[np.sqrt(4 * np.pi)]])
    assert EnvironmentMap.from_image(np.ones((8, 16))).channels == ()


def test_maps_of_8_bits_are_taken_as_linear_with_a_note_or_decoded(run, tmp_path):
    Image.fromarray(np.full((4, 8, 3), 128, np.uint8)).save(tmp_path / "m.png")
    value = 128 / 255
    # A constant radiance has the coefficient sqrt(4 pi) times it, and no other.
    for options, radiance, note in (
        ((), value, True),
        (("--linear",), value, False),
        (("--srgb",), ((value + 0.055) / 1.055) ** 2.4, False),
    ):
        outcome = run("envmap", "project", "m.png", "--degree", 0, "--json", *options)
        assert outcome.code == 0
        found = json.loads(outcome.out)["coefficients"]
        np.testing.assert_allclose(found, np.full((3, 1), radiance * np.sqrt(4 * np.pi)), rtol=1e-3)
        assert ("note: m.png: holds 8 bits" in outcome.err) is note
    outcome = run("envmap", "project", "m.png", "--max-pixels", 31)
    assert outcome.code == 2
    assert "more pixels than the limit of 31" in outcome.err


def test_parts_of_a_file_are_chosen(run, tmp_path):
    parts = [
        OpenEXR.Part(
            {"name": name, "type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION},
            {"RGB": np.full((4, 8, 3), value, np.float32)},
        )
        for name, value in (("key", 1), ("fill", 2))
    ]
    with OpenEXR.File(parts) as file:
        file.write(str(tmp_path / "m.exr"))
    for options, value, note in (((), 1, True), (("--part", "fill"), 2, False)):
        outcome = run("envmap", "project", "m.exr", "--degree", 0, "--json", *options)
        found = json.loads(outcome.out)["coefficients"][0][0]
        assert found == pytest.approx(value * np.sqrt(4 * np.pi), rel=1e-6)
        assert ("holds several pictures, of which 'key' was read" in outcome.err) is note


def test_render_decodes_its_environment_apart_from_its_picture(run, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    Image.fromarray(np.full((4, 8, 3), 128, np.uint8)).save(tmp_path / "m.png")
    common = (
        "render",
        "shapes/torus.ply",
        "--environment",
        "m.png",
        "--size",
        16,
        "--exposure",
        0.5,
    )
    common += ("--no-cast-shadows", "--bits", 16)
    values = []
    for number, option in enumerate(("--linear-environment", "--srgb-environment")):
        assert run(*common, option, "--out", f"{number}.png").code == 0
        values.append(read_image(tmp_path / f"{number}.png"))
    value = 128 / 255
    lit = values[0] > 0.1
    ratio = ((value + 0.055) / 1.055) ** 2.4 / value
    np.testing.assert_allclose(values[1][lit] / values[0][lit], ratio, rtol=1e-3)


def test_reflect_writes_the_lobe_of_the_map_and_a_figure(run, smooth, tmp_path):
    outcome = run(
        *("envmap", "reflect", smooth, "--material", "phong:20", "--size", 16),
        *("--out", "g.hdr", "--figure", "g.png"),
    )
    assert outcome.code == 0
    assert (tmp_path / "g.png").stat().st_size > 5000
    environment, found = (read_environment_map(tmp_path / name) for name in (smooth, "g.hdr"))
    mirrored = found.directions
    lobe = np.maximum(mirrored @ environment.directions.reshape(-1, 3).T, 0) ** 20
    power = (environment.radiance * environment.solid_angles).reshape(3, -1)
    expected = 21 / (2 * np.pi) * np.moveaxis(lobe @ power.T, -1, 0)
    # RGBE has eight bits of the largest channel.
    assert np.abs(found.radiance - expected).max() < 0.01 * expected.max()


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ("ggx:-0.1", "roughness must lie in"),
        ("phong:1e400", "exponent must lie in"),
        ("ggx:0.01", "beyond degree 16"),
        ("merl:m.hdr", "MERL table of 90 x 90 x 180"),
        ("gold", "no material 'gold'"),
    ],
)
def test_reflect_refuses_materials_that_are_none(material, message, smooth, check_refused):
    check_refused(message, *("envmap", "reflect", smooth, "--material", material, "--out", "g.hdr"))
