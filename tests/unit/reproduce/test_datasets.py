import filecmp
import json
import os
import subprocess
import sys
import time

import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError, HarmfaceError
from harmface.io import read_dataset, read_mesh, read_npz
from harmface.reproduce.datasets import Request, environment_lights, make_dataset

SMALL = Request(2, "ninepoints", size=24, seed=3)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sets") / "set"
    make_dataset(folder, SMALL, workers=1)
    return folder


def same(one, other):
    compared = filecmp.dircmp(one, other)
    inside = [same(one / name, other / name) for name in compared.common_dirs]
    _, differ, odd = filecmp.cmpfiles(one, other, compared.common_files, shallow=False)
    return not (compared.left_only or compared.right_only or differ or odd) and all(inside)


def test_a_data_set_is_read_back_as_arrays(made):
    found = read_dataset(made)
    assert found.subjects == ["subject_0000", "subject_0001"]
    images = found.images("subject_0001")
    assert images.shape == (9, 24, 24)
    mask = found.mask("subject_0001")
    assert 0.2 < mask.mean() < 0.8
    # Pixels outside the mask hold at most the half-covered edge.
    assert images[:, ~mask].mean() < 0.1 * images[:, mask].mean()
    assert np.allclose(images.max(axis=(1, 2)), 0.9, atol=1e-4)


def test_the_manifest_tells_every_light(made):
    directions, irradiances = read_dataset(made).lights("subject_0000")
    assert np.array_equal(irradiances, np.eye(9))
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    record = json.loads((made / "manifest.json").read_text())["subjects"][0]
    assert len(record["parameters"]) >= 40
    assert record["images"][0]["exposure"] > 0


@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_run_goes_on_and_ends_with_the_same_bytes(made, tmp_path, workers):
    folder = tmp_path / "set"
    call = f"make_dataset(Path({str(folder)!r}), {SMALL!r}, workers={workers})"
    code = "\n".join(
        [
            "from pathlib import Path",
            "from harmface.reproduce.datasets import *",
            f"if __name__ == '__main__': {call}",
        ]
    )
    process = subprocess.Popen([sys.executable, "-c", code])
    deadline = time.monotonic() + 60
    while not (folder / "subject_0000" / "image_003.png").exists():
        assert time.monotonic() < deadline
        time.sleep(0.005)
    process.kill()
    process.wait()
    assert not (folder / "manifest.json").exists()
    make_dataset(folder, SMALL, workers=1)
    assert same(made, folder)


def test_workers_make_the_same_bytes(made, tmp_path):
    make_dataset(tmp_path / "set", SMALL, workers=2)
    assert same(made, tmp_path / "set")


def test_a_worker_that_ends_by_itself_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr("harmface.reproduce.datasets._exit_with_parent", os.abort)
    with pytest.raises(HarmfaceError, match=r"set: a process .* has ended, as .* memory runs out"):
        make_dataset(tmp_path / "set", SMALL, workers=2)


def test_a_finished_set_is_left_as_it_is(made):
    before = {path: path.stat().st_mtime_ns for path in made.rglob("*.png")}
    make_dataset(made, SMALL, workers=1)
    assert {path: path.stat().st_mtime_ns for path in made.rglob("*.png")} == before


def test_meshes_and_g_buffers_on_request(tmp_path):
    request = Request(1, "yale64", size=16, meshes=True, gbuffers=True, noise=0.02)
    make_dataset(tmp_path / "set", request, workers=1)
    subject = tmp_path / "set" / "subject_0000"
    assert len(read_mesh(subject / "mesh.ply").faces) > 10_000
    arrays, _ = read_npz(subject / "gbuffer.npz", "gbuffer", 1)
    assert arrays["normals"].shape == (16, 16, 3)
    subsets = [
        image["subset"]
        for image in json.loads((tmp_path / "set" / "manifest.json").read_text())["subjects"][0][
            "images"
        ]
    ]
    assert np.array_equal(np.bincount(subsets)[1:], [7, 12, 12, 14, 19])


def test_noise_has_the_standard_deviation_asked_for(made, tmp_path):
    from dataclasses import replace

    make_dataset(tmp_path / "set", replace(SMALL, noise=0.05), workers=1)
    noisy = read_dataset(tmp_path / "set").images("subject_0000")
    clean = read_dataset(made).images("subject_0000")
    bright = (clean > 0.2) & (clean < 0.7)
    scaled = (noisy - clean)[bright] / np.sqrt(clean[bright])
    # The standard error of a standard deviation of n values is 1 / sqrt(2 n) of it.
    assert scaled.std() == pytest.approx(0.05, rel=4 / np.sqrt(2 * bright.sum()) + 0.02)


def test_environments_are_grey_lights_of_unit_total():
    lights = environment_lights()
    assert np.allclose(lights.weights.sum(axis=1), 1)
    assert (lights.weights >= 0).all()


def test_other_folders_are_refused(made, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    with pytest.raises(FileError, match=r"holds other files \(thesis.tex\)"):
        make_dataset(tmp_path / "mine", SMALL)
    with pytest.raises(FileError, match="other results"):
        make_dataset(made, Request(3, "ninepoints", size=24, seed=3))
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="cannot be used as a folder"):
        make_dataset(tmp_path / "file", SMALL)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, "yale64"), "identities"),
        ((1, "sunset"), "lightings must be one of"),
        ((1, "yale64", 0), "size"),
        ((1, "yale64", 8, -1), "seed"),
        ((1, "yale64", 8, 0, 3.0), "identity_scale"),
        ((1, "yale64", 8, 0, 1.0, -0.1), "noise"),
    ],
)
def test_nonsense_is_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        Request(*arguments)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[", "is no manifest"),
        ("{}", "is no manifest"),
        ('{"format": "x", "version": 1, "subjects": []}', "version 1 is needed"),
        (
            '{"format": "harmface-dataset", "version": 1, "subjects": '
            '[{"name": "../..", "images": [{"file": "passwd"}]}]}',
            "no plain file name",
        ),
        (
            '{"format": "harmface-dataset", "version": 1, "subjects": '
            '[{"name": ["a"], "images": []}]}',
            "no plain file name",
        ),
        (
            '{"format": "harmface-dataset", "version": 1, "subjects": '
            '[{"name": "a", "images": [{"file": "a\\u0000b"}]}]}',
            "no plain file name",
        ),
        ('{"format": "' + "x" * 9999 + '", "version": 1, "subjects": []}', "version 1 is needed"),
        ("[" * 100_000, "is no manifest"),
    ],
    ids=range(8),
)
def test_foreign_manifests_are_refused(tmp_path, text, message):
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(FileError, match=message) as error:
        read_dataset(tmp_path)
    assert len(str(error.value)) < 500 + len(str(tmp_path))


@pytest.mark.parametrize(
    "lights",
    [
        '"directions": [[0, 0, 1]], "images": [{"file": "i", "irradiances": 3}]',
        '"directions": [[0, 0, 1]], "images": [{"file": "i"}]',
        '"directions": [[0, 0]], "images": []',
        '"images": []',
        '"directions": [[0, 0, 1]], "images": [{"file": "i", "irradiances": '
        '{"direction": [-1], "value": [1]}}]',
        '"directions": [[0, 0, 1]], "images": [{"file": "i", "irradiances": '
        '{"direction": [1e400], "value": [1]}}]',
    ],
)
def test_lights_that_make_no_sense_are_refused(tmp_path, lights):
    (tmp_path / "manifest.json").write_text(
        f'{{"format": "harmface-dataset", "version": 1, "subjects": [{{"name": "a", {lights}}}]}}'
    )
    with pytest.raises(FileError, match="has no lights of use for 'a'"):
        read_dataset(tmp_path).lights("a")


def test_unknown_subjects_are_named(made):
    with pytest.raises(ArgumentError, match="no subject is called 'bob'"):
        read_dataset(made).images("bob")
