"""Galleries in stores, and commands on Dask."""

import json

import numpy as np
import pytest

from harmface.io import write_environment_map, write_image


@pytest.fixture
def people(tmp_path, rng):
    for name in "abc":
        (tmp_path / "people" / name).mkdir(parents=True)
        spanning = rng.random((3, 10, 8))
        for number in range(4):
            image = np.tensordot(rng.random(3), spanning, axes=1) / 3
            write_image(tmp_path / "people" / name / f"{number}.png", image)
    return tmp_path / "people"


def answers(outcome):
    assert outcome.code == 0, outcome.err
    return json.loads(outcome.out)["results"]


def test_stores_are_recognised_as_files_are(run, people):
    assert run("enroll", people, "--method", "subspace", "--out", "big.zarr").code == 0
    assert "12 probes" in run("pack", people, "--like", "big.zarr", "--out", "probes.zarr").out
    alone = answers(run("recognize", "big.zarr", "probes.zarr", "--top", 2, "--json"))
    shared = run("recognize", "big.zarr", "probes.zarr", "--top", 2, "--json", "--workers", 2)
    assert "dashboard: http://" in shared.err
    assert answers(shared) == alone
    first = run("recognize", "big.zarr", "probes.zarr", "--top", 2, "--json", "--first-pass", 2)
    assert [each["ranking"][0]["subject"] for each in answers(first)] == list("aaaabbbbcccc")
    assert run("enroll", people, "--method", "subspace", "--out", "small.npz").code == 0
    images = [each["image"] for each in alone]
    known = answers(run("recognize", "small.npz", *images, "--top", 2, "--json"))
    for one, other in zip(alone, known, strict=True):
        assert one["ranking"][0]["subject"] == other["ranking"][0]["subject"]
        assert one["ranking"][1]["distance"] == pytest.approx(
            other["ranking"][1]["distance"], abs=1e-6
        )
    shown = run("recognize", "big.zarr", "probes.zarr", "--top", 1)
    assert shown.out.count("margin") == 12


def test_every_command_gives_the_same_on_dask(run, people, tmp_path, rng):
    (tmp_path / "maps").mkdir()
    write_environment_map(tmp_path / "maps" / "a.hdr", rng.random((8, 16, 3), dtype=np.float32))
    small = ("--identities", 2, "--lightings", "ninepoints", "--size", 12)
    for command in (
        ("synth", "dataset", *small),
        ("evaluate", people, "--gallery", "first:2", "--methods", "subspace"),
        ("envmap", "project", "maps"),
    ):
        for name, more in (("here", ()), ("there", ("--workers", 2))):
            outcome = run(*command, "--out", f"{command[0]}-{name}", *more)
            assert outcome.code == 0, outcome.err
        one, other = (
            {
                path.relative_to(tmp_path / f"{command[0]}-{name}"): path.read_bytes()
                for path in sorted((tmp_path / f"{command[0]}-{name}").rglob("*"))
                if path.is_file() and path.name != "times.json"
            }
            for name in ("here", "there")
        )
        assert one == other


def test_what_cannot_be_is_refused_in_a_line(run, people, check_refused):
    check_refused("must be subspace, 3d", "enroll", people, "--method", "lbph", "--out", "g.zarr")
    check_refused("are for galleries in stores", "enroll", people, "--workers", 2, "--out", "g.npz")
    check_refused(
        "no scheduler answers", "evaluate", people, "--gallery", "first:1", "--scheduler", "nowhere"
    )
    check_refused("is no store", "pack", people, "--like", "none.zarr", "--out", "p.zarr")
    check_refused("must end in .zarr", "pack", people, "--like", "none.zarr", "--out", "p.npz")
    check_refused("are for a folder of maps", "envmap", "project", "a.hdr", "--workers", 2)
    assert run("enroll", people, "--method", "subspace", "--out", "big.zarr").code == 0
    check_refused("probes must be one too", "recognize", "big.zarr", people / "a" / "0.png")
    check_refused("there are --top", "recognize", "big.zarr", "probes.zarr", "--reject", 0.1)
    check_refused("lies in what is", "enroll", people, "--out", people / "g.zarr")
