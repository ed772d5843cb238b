import json

import numpy as np
import pytest
from PIL import Image
from scipy.io import loadmat, savemat

from data_synth.lightings import uniform_directional
from data_synth.shapes import bumpy_sphere
from harmface.conventions import linear_to_srgb
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_image, read_mesh, write_image
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of
from tests.unit.stereo.mirror_sphere import mirrored, pixels, rays
from tests.unit.stereo.near_scene import LAMPS, lamps_around, relief

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
        *("stereo", *files, "--mask", capture / "mask.png", "--method", "4d", "--out", "surface"),
        *("--lights", capture / "light_directions.txt"),
    )
    assert outcome.code == 0
    assert "note: the directions of the lights are not used" in outcome.out
    summary = json.loads((tmp_path / "surface" / "summary.json").read_text())
    assert summary["method"] == "4d"
    assert "mean_angular_error_degrees" not in summary


def test_smoothness_evens_out_noise(run, check_refused, capture, tmp_path, rng):
    for path in capture.glob("0*.png"):
        image = read_image(path)
        write_image(path, np.clip(image + 0.02 * rng.standard_normal(image.shape), 0, 1))
    errors = []
    for more in ((), ("--smoothness", "3")):
        out = tmp_path / f"surface{len(more)}"
        outcome = run("stereo", "ball", "--method", "known-lights", *more, "--out", out)
        assert outcome.code == 0
        errors.append(json.loads((out / "summary.json").read_text())["mean_angular_error_degrees"])
    assert errors[1] < 0.9 * errors[0]
    harmonic = ("stereo", "ball", "--method", "9d", "--smoothness", "3", "--out", "refused")
    check_refused("smoothness needs the method 'refined'", *harmonic)


@pytest.mark.filterwarnings("ignore::harmface.errors.FileWarning")
@pytest.mark.parametrize("form", ["obj", "glb"])
def test_other_meshes_and_views_are_written(run, capture, tmp_path, form):
    known = ("stereo", "ball", "--method", "known-lights", "--focal", "60")
    outcome = run(*known, "--mesh-format", form, "--out", "surface")
    assert outcome.code == 0
    mesh = read_mesh(tmp_path / "surface" / f"mesh.{form}")
    # Distances from the camera, in units of their mean.
    assert np.ptp(mesh.vertices[:, 2]) > 0.1
    assert abs(mesh.vertices[:, 2].mean() + 1) < 0.01
    assert abs(np.median(mesh.albedo) - 0.8) < 0.01
    again = run(*known, "--out", "surface")
    assert again.code == 2
    assert f"holds other files (mesh.{form}" in again.err.replace("mtl", form)


def test_what_the_user_should_know_is_said(run, capture, tmp_path):
    lights = np.loadtxt(capture / "light_directions.txt")
    np.savetxt(tmp_path / "down.txt", lights * (1, -1, 1))
    known = ("stereo", "ball", "--method", "known-lights")
    outcome = run(*known, "--lights", "down.txt", "--out", "down")
    assert "note: the normals fit a surface better upside down" in outcome.out
    for path in capture.glob("0*.png"):
        encoded = linear_to_srgb(np.clip(2 * read_image(path), 0, 1))
        Image.fromarray(np.round(255 * encoded).astype(np.uint8)).save(path)  # says nothing of it
    outcome = run(*known, "--out", "encoded")
    notes = json.loads((tmp_path / "encoded" / "summary.json").read_text())["notes"]
    assert len(notes) == 2
    assert all(f"note: {note}" in outcome.out for note in notes)
    assert "look gamma-encoded" in notes[0]
    assert "of the observations are saturated" in notes[1]


def test_what_a_channel_clips_is_left_out(run, capture, tmp_path):
    flashes = np.random.default_rng(0).uniform(0.5, 1, (COUNT, 1)) * (3.0, 1.5, 1.0)
    np.savetxt(capture / "light_intensities.txt", flashes)
    for path, flash in zip(sorted(capture.glob("0*.png")), flashes, strict=True):
        image = read_image(path)
        write_image(path, np.minimum(image[..., None] * flash, 1), bits=8)
    outcome = run("stereo", "ball", "--method", "known-lights", "--out", "known")
    summary = json.loads((tmp_path / "known" / "summary.json").read_text())
    assert 0.1 < summary["saturated_share"] < 0.5
    assert summary["mean_angular_error_degrees"] < 0.5
    assert "saturated and were left out" in outcome.out
    outcome = run("stereo", "ball", "--method", "4d", "--out", "unknown")
    assert "observations are saturated: expose less" in outcome.out


def test_measured_normals_and_lamps_decide_what_photographs_leave_open(
    run, check_refused, capture, tmp_path
):
    """Measured as those of the concave counterpart, they make the ball concave."""
    lights = np.loadtxt(capture / "light_directions.txt")
    (tmp_path / "one.txt").write_text("# column row x y z\n20 12 0 -0.5 1\n")
    run("stereo", "ball", "--normals-known", "one.txt", "--out", "normals")
    summary = json.loads((tmp_path / "normals" / "summary.json").read_text())
    assert summary["convexity"] == "known normals"
    lines = [f"{k + 1} {-lights[k, 0]} {-lights[k, 1]} {lights[k, 2]}" for k in (0, 3)]
    (tmp_path / "two.txt").write_text("\n".join(lines))
    run("stereo", "ball", "--directions-known", "two.txt", "--out", "lamps")
    summary = json.loads((tmp_path / "lamps" / "summary.json").read_text())
    assert summary["convexity"] == "known directions"
    assert lamps_off(summary, lights * (-1, -1, 1)) < 3
    refused = ("stereo", "ball", "--out", "none", "--method", "4d")
    check_refused("serve the method 'refined' only", *refused, "--normals-known", "one.txt")


def lamps_off(summary, lights):
    found = np.array(summary["lamp_directions"])
    return np.degrees(np.arccos(np.clip((found * lights).sum(axis=1), -1, 1))).max()


@pytest.fixture
def sphere(capture):
    """Photographs of a mirror sphere under the lamps of the capture, and its mask."""
    lights = np.loadtxt(capture / "light_directions.txt")
    mask = pixels(rays()[0].astype(float)) > 0.5
    return lights, np.clip(mirrored(lights), 0, 1), mask


def test_a_mirror_sphere_tells_the_lamps(run, check_refused, capture, sphere, tmp_path):
    lights, images, mask = sphere
    (tmp_path / "chrome").mkdir()
    for number, image in enumerate(images):
        write_image(tmp_path / "chrome" / f"{number}.png", image, bits=8)
    write_image(tmp_path / "chrome" / "mask.png", mask.astype(float), bits=8)
    (capture / "light_directions.txt").unlink()
    known = ("stereo", "ball", "--method", "known-lights", "--chrome-ball", "chrome")
    outcome = run(*known, "--out", "surface")
    assert outcome.code == 0
    assert "note: the lamps are those that the mirror sphere shows, 40.0 pixels" in outcome.out
    summary = json.loads((tmp_path / "surface" / "summary.json").read_text())
    # Half a pixel of a sphere of 40 in radius.
    assert lamps_off(summary, lights) < 1.5
    assert summary["mean_angular_error_degrees"] < 0.5
    write_image(tmp_path / "chrome" / "7.png", np.zeros(mask.shape), bits=8)
    check_refused(r"7\.png: shows no highlight", *known, "--out", "none")
    (tmp_path / "chrome" / "7.png").unlink()
    check_refused("chrome: holds 23 photographs of the mirror sphere", *known, "--out", "few")


def test_a_mirror_sphere_beside_the_object_tells_the_lamps(
    run, check_refused, capture, sphere, tmp_path
):
    lights, images, mask = sphere
    (tmp_path / "both").mkdir()
    object_mask = read_image(capture / "mask.png")

    def beside(left, right):
        height = len(right)
        padded = np.zeros((height, left.shape[1]))
        padded[: len(left)] = left
        return np.concatenate([padded, right], axis=1)

    for number, image in enumerate(images):
        both = beside(read_image(capture / f"{number:03d}.png"), image)
        write_image(tmp_path / "both" / f"{number:03d}.png", both)
    zeros = np.zeros(mask.shape)
    write_image(tmp_path / "both" / "ball.png", beside(0 * object_mask, mask * 1.0), bits=8)
    sphere_alone = ("stereo", "both", "--method", "known-lights")
    sphere_alone += ("--chrome-ball-mask", "both/ball.png", "--out", "surface")
    check_refused("needs the object's own mask", *sphere_alone)
    write_image(tmp_path / "both" / "mask.png", beside(object_mask, zeros), bits=8)
    outcome = run(*sphere_alone)
    assert outcome.code == 0
    summary = json.loads((tmp_path / "surface" / "summary.json").read_text())
    assert summary["images"] == COUNT
    # Half a pixel of a sphere of 40 in radius.
    assert lamps_off(summary, lights) < 1.5


def test_near_lamps_are_given_as_positions(run, check_refused, tmp_path, rng):
    scene, positions = relief(), lamps_around()
    images = scene.photographs(positions, np.ones(LAMPS), rng, noise=0)
    (tmp_path / "photos").mkdir()
    for number, image in enumerate(images):
        write_image(tmp_path / "photos" / f"{number}.png", image / images.max())
    write_image(tmp_path / "photos" / "mask.png", scene.mask.astype(float), bits=8)
    near = ("stereo", "photos", "--method", "known-lights", "--near-lamps")
    check_refused("photos: holds no file of lamps' positions", *near, "--out", "none")
    np.savetxt(tmp_path / "lights.txt", positions)
    assert run(*near, "--out", "near").code == 0
    normals = np.load(tmp_path / "near" / "normals.npy")
    error = np.degrees(np.arccos(np.clip((normals[scene.mask] * scene.normals).sum(1), -1, 1)))
    assert error.mean() < 0.3
    summary = json.loads((tmp_path / "near" / "summary.json").read_text())
    assert summary["light_model"] == "near points"
    # Positions are never guessed from lengths.
    distant = run("stereo", "photos", "--method", "known-lights", "--out", "distant")
    assert "which are not used; give intensities as a fourth number, or say that" in distant.out
    normals = np.load(tmp_path / "distant" / "normals.npy")
    assert np.abs((normals[scene.mask] * scene.normals).sum(1)).mean() < np.cos(np.radians(10))
    ball = ("--chrome-ball", "photos", "--out", "none")
    check_refused("tells directions, but --near-lamps needs positions", *near, *ball)
    refined = ("stereo", "photos", "--near-lamps", "--out", "none")
    check_refused("--near-lamps serves --method known-lights", *refined)


@pytest.mark.parametrize("photographs", [1, 4])
def test_lamps_of_three_colours_shine_at_once(run, capture, tmp_path, photographs):
    lights = np.loadtxt(capture / "light_directions.txt")[: 3 * photographs]
    # The first three are within 60 degrees of the axis, but a surface in shadow has no normal.
    lights[:, 2] += 1
    lights /= np.linalg.norm(lights, axis=1, keepdims=True)
    truth, mask = loadmat(capture / "Normal_gt.mat")["Normal_gt"], read_image(capture / "mask.png")
    images = np.maximum(np.tensordot(lights, truth, (1, 2)), 0)
    (tmp_path / "colour").mkdir()
    for number in range(photographs):
        channels = np.moveaxis(images[3 * number : 3 * number + 3], 0, -1)
        write_image(tmp_path / "colour" / f"{number}.png", channels)
    write_image(tmp_path / "colour" / "mask.png", mask, bits=8)
    np.savetxt(tmp_path / "colour" / "lights.txt", lights)
    outcome = run(
        *("stereo", "colour", "--method", "known-lights", "--coloured-lamps", "--out", "surface")
    )
    assert outcome.code == 0
    normals = np.load(tmp_path / "surface" / "normals.npy")
    lit = (np.tensordot(lights, truth, (1, 2)) > 0.05).sum(axis=0) >= 3
    lit &= mask > 0.5
    assert lit.sum() > 0.7 * (mask > 0.5).sum()
    error = np.degrees(np.arccos(np.clip((normals[lit] * truth[lit]).sum(axis=-1), -1, 1)))
    assert error.mean() < 0.2


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
    balls = ("--chrome-ball", "ball", "--chrome-ball-mask", "small.png")
    check_refused("--chrome-ball and --chrome-ball-mask both", *stereo, *known, *balls)
    check_refused("--chrome-ball-mask serves --method known-lights", *stereo, *balls[2:])
    check_refused("small.png: has 4 x 4 pixels", *stereo, *known, *balls[2:])
    check_refused("gamma must be one of linear, srgb", *stereo, "--gamma", "2.2")
    check_refused("mesh-format must be one of ply, obj, glb", *stereo, "--mesh-format", "stl")
    check_refused("focal must be a positive number", *stereo, "--focal", "-3")
    check_refused("focal must be a positive number", *stereo, "--focal", "nan")
    check_refused("needs --lights", "stereo", *files, "--out", "s", *known)
    check_refused("1 lines of 3 numbers, but 24", *stereo, *known, "--lights", "short.txt")
    check_refused("not a table of numbers", *stereo, *known, "--lights", "text.txt")
    check_refused("at least 4, got 3", "stereo", *files[:3], "--method", "4d", "--out", "s")
    check_refused("at least 9, got 8", "stereo", *files[:8], "--method", "9d", "--out", "s")
    check_refused("at least 4, got 3", "stereo", *files[:3], "--out", "s")
    check_refused("holds no photographs", "stereo", "mine", "--out", "s")
    check_refused("nothing.png: does not exist", "stereo", "nothing.png", "--out", "s")
    size = "small.png: has 4 x 4 pixels, 000.png has 48 x 48"
    check_refused(size, "stereo", *files, "--mask", "small.png", "--out", "s")
    check_refused(size, "stereo", *files, "small.png", "--out", "s")
    write_image(tmp_path / "black.png", np.zeros((48, 48)))
    check_refused(
        "black.png: is an empty mask", "stereo", *files, "--mask", "black.png", "--out", "s"
    )
    (tmp_path / "broken.png").write_bytes(files[0].read_bytes()[:200])
    check_refused("broken.png: cannot be read", "stereo", *files, "broken.png", "--out", "s")
    (tmp_path / "alike").mkdir()
    for number, exposure in enumerate(np.linspace(0.5, 1, 9)):
        write_image(tmp_path / "alike" / f"{number}.png", exposure * read_image(files[0]))
    check_refused(r"alike up to exposure \(rank 1\)", "stereo", "alike", "--out", "s")
    (tmp_path / "behind.txt").write_text("0 0.1 -1\n" * COUNT)
    check_refused("every light behind", *stereo, *known, "--lights", "behind.txt")
    check_refused(
        "holds other files", "stereo", *files, *known, "--lights", directions, "--out", "mine"
    )
    (capture / "Normal_gt.mat").write_bytes(b"MATLAB")
    check_refused("Normal_gt", *stereo)
    (capture / "filenames.txt").write_text("../secret.png")
    check_refused("plain file names", *stereo)
