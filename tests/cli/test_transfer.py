import numpy as np
import pytest
from PIL import Image

from data_synth.shapes import half_sphere
from harmface.geometry import Mesh
from harmface.io import read_npz, write_ply
from harmface.io.parts import Parts
from harmface.reproduce.synthetic import mesh_of


@pytest.fixture
def bowl(tmp_path):
    mesh = mesh_of(half_sphere(16)).flipped().rotated(np.diag([1.0, -1.0, -1.0]))
    mesh = Mesh(mesh.vertices, mesh.faces, mesh.normals, np.full(mesh.vertices.shape, 0.5))
    write_ply(tmp_path / "bowl.ply", mesh)
    return "bowl.ply"


def picture(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(float)


def test_transfer_is_written_and_rendered(run, bowl, tmp_path):
    common = (bowl, "--degree", 2, "--samples", 512)
    for bounces in (0, 2, "all"):
        outcome = run("transfer", *common, "--bounces", bounces, "--out", f"{bounces}.npz")
        assert outcome.code == 0, outcome.err
        assert "9 coefficients of" in outcome.out
        assert "edges bound holes" in outcome.err
    arrays, _ = read_npz(tmp_path / "all.npz", "transfer", 1)
    # Red of albedo 0.5: 0.443113 / (1 - 0.25).
    assert arrays["transfer"][0, 0].mean() == pytest.approx(0.590818, rel=0.02)
    assert read_npz(tmp_path / "0.npz", "transfer", 1)[0]["transfer"].shape[0] == 9
    (tmp_path / "white.json").write_text('{"coefficients": [[3.5449077, 0, 0, 0]]}')
    levels = []
    for bounces in (0, 2, "all"):
        outcome = run(
            *("render", bowl, "--transfer", f"{bounces}.npz", "--environment", "white.json"),
            *("--size", 24, "--exposure", 0.3, "--out", f"{bounces}.png"),
        )
        assert outcome.code == 0, outcome.err
        image = picture(tmp_path / f"{bounces}.png")
        levels.append(np.median(image[image > 20]))
    assert levels[0] < levels[1] < levels[2] < 1.5 * levels[0]


def test_every_kind_of_light_goes_by_the_transfer(run, bowl, tmp_path):
    run("transfer", bowl, "--degree", 1, "--samples", 128, "--bounces", 0, "--out", "t.npz")
    for light in (("--light", "30,20"), ("--environment", "grace")):
        outcome = run("render", bowl, "--transfer", "t.npz", *light, "--size", 16, "--out", "r.png")
        assert outcome.code == 0, outcome.err
        assert picture(tmp_path / "r.png").max() > 50


def test_the_same_command_goes_on_where_it_was(run, bowl, tmp_path, monkeypatch):
    monkeypatch.setattr("harmface.rendering.precomputed_transfer.PAIRS", 2**17)
    command = ("transfer", bowl, "--degree", 2, "--bounces", 1, "--samples", 1024, "--out")
    assert run(*command, "whole.npz").code == 0
    made = []
    save = Parts.save

    def stop_after_two(self, name, arrays, facts):
        if len(made) == 2:
            raise KeyboardInterrupt
        made.append(name)
        save(self, name, arrays, facts)

    monkeypatch.setattr(Parts, "save", stop_after_two)
    assert run(*command, "t.npz").code == 130
    assert len(list(tmp_path.glob(".harmface-part-*"))) == 2
    again = []
    monkeypatch.setattr(
        Parts, "save", lambda self, name, *rest: (again.append(name), save(self, name, *rest))[0]
    )
    assert run(*command, "t.npz").code == 0
    assert again and not set(made) & set(again)
    assert not list(tmp_path.glob(".harmface-part-*"))
    assert (tmp_path / "t.npz").read_bytes() == (tmp_path / "whole.npz").read_bytes()


def test_parts_of_another_output_are_left_alone(run, bowl, tmp_path):
    Parts(tmp_path, "key", "other.npz").save("points 0", {"a": np.ones(2)}, {})
    assert run("transfer", bowl, "--degree", 0, "--samples", 64, "--out", "t.npz").code == 0
    assert Parts(tmp_path, "key", "other.npz").load("points 0") is not None


def test_bad_input_is_refused(run, bowl, check_refused, tmp_path):
    transfer = ("transfer", bowl, "--out", "t.npz")
    check_refused_out = [
        ("--bounces must be a whole number or all", "--bounces", "some"),
        ("--max-degree must be 0 or more", "--max-degree", -1),
        ("samples must be even", "--samples", 33),
    ]
    for pattern, *arguments in check_refused_out:
        outcome = run(*transfer, *arguments)
        assert outcome.code == 2 and pattern in outcome.err
        assert not (tmp_path / "t.npz").exists()
    check_refused("no.ply: ", "transfer", "no.ply", "--out", "t.npz")
    assert run(*transfer, "--samples", 64, "--degree", 1).code == 0
    render = ("render", "--transfer", "t.npz", "--environment", "grace", "--out", "r.png")
    run("synth", "shapes", "--out", "shapes")
    check_refused("t.npz: holds the transfer of another mesh", *render, "shapes/vase.ply")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "t.npz").read_bytes()[:500])
    check_refused(
        "cut.npz: is not a harmface transfer file",
        *("render", bowl, "--transfer", "cut.npz", "--environment", "grace", "--out", "r.png"),
    )
    check_refused(
        "t.npz: is read as well",
        "render",
        bowl,
        "--transfer",
        "t.npz",
        "--light",
        "0,0",
        "--out",
        "t.npz",
    )


def test_near_lamps_light_a_mesh(run, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    assert run("synth", "scene", "--out", "scene.toml").code == 0
    outcome = run(
        *("nearlight", "shapes/bumpy_sphere.ply", "--scene", "scene.toml", "--size", 32),
        *("--figure", "near.png", "--out", "n.png"),
    )
    assert outcome.code == 0, outcome.err
    errors = [float(line.split()[-1].rstrip("%")) for line in outcome.out.splitlines()[:4]]
    one, one_gradient, eight, eight_gradient = errors
    assert one_gradient < one and eight_gradient < min(eight, one_gradient)
    assert picture(tmp_path / "n.png").max() > 150
    assert picture(tmp_path / "near.png").shape[1] > 1000
    outcome = run(
        *("nearlight", "shapes/bumpy_sphere.ply", "--scene", "scene.toml", "--size", 16),
        *("--samples", 3, "--no-gradient", "--out", "m.png"),
    )
    assert outcome.code == 0, outcome.err


def test_scenes_that_make_no_sense_are_refused(run, check_refused, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    ball = "[[sphere]]\ncenter = [2, 0, 2]\nradius = 0.2\nradiance = [1, 1, 1]\n"
    scenes = {
        "is no TOML file": "[[sphere",
        "has the unknown key lamp": "[[lamp]]\na = 1\n",
        "sphere 1 has the unknown key size": ball + "size = 1\n",
        "sphere 1 lacks the key radius": ball.replace("radius = 0.2\n", ""),
        "frame must be world or object": 'frame = "room"\n' + ball,
        "must be written ..sphere..": ball.replace("[[", "[").replace("]]", "]"),
        "radius must be above 0": ball.replace("0.2", "-1"),
        "radiance must be one number": ball.replace("[1, 1, 1]", "[1, 1]"),
        "radiance must be finite and not negative": ball.replace("[1, 1, 1]", "[1, -1, 1]"),
        "a light that is not dark": ball.replace("[1, 1, 1]", "0"),
        "a place must lie within 1e\\+15": ball.replace("[2, 0, 2]", "[2, 0, 1e200]"),
        "normal must not be zero": ball.replace("sphere", "disc") + "normal = [0, 0, 1e200]\n",
        "three coordinates": ball.replace("[2, 0, 2]", "[2, 0]"),
        "none.ply: ": ball + '[[mesh]]\nfile = "none.ply"\nradiance = 1\n',
        "bounding box": ball.replace("[2, 0, 2]", "[0, 0, 0]"),
    }
    command = ("nearlight", "shapes/torus.ply", "--scene", "scene.toml", "--out", "n.png")
    for pattern, text in scenes.items():
        (tmp_path / "scene.toml").write_text(text)
        check_refused(pattern, *command)
    (tmp_path / "scene.toml").write_text(ball)
    check_refused("samples must be 1", *command, "--samples", 0)
    check_refused("exponent must be above 0", *command, "--exponent", 0)


def test_meshes_and_points_in_a_scene(run, tmp_path):
    run("synth", "shapes", "--out", "shapes")
    (tmp_path / "scene.toml").write_text(
        "[[point]]\nposition = [0, 0, 3]\nintensity = 5\n"
        '[[mesh]]\nfile = "shapes/hills.ply"\nradiance = [0, 0, 0]\n'
    )
    (tmp_path / "open.toml").write_text("[[point]]\nposition = [0, 0, 3]\nintensity = 5\n")
    for scene in ("scene", "open"):
        outcome = run(
            "nearlight",
            "shapes/sphere.ply",
            "--scene",
            f"{scene}.toml",
            "--size",
            16,
            "--out",
            f"{scene}.png",
        )
        assert outcome.code == 0, outcome.err
    assert picture(tmp_path / "open.png").max() > 100
