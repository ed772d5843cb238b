import csv
import json

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.cli.recognition import enroll
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import find_photographs, read_gallery, read_photographs
from harmface.recognition.methods import BEFORE, METHODS
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of

PEOPLE = 4


@pytest.fixture(scope="module")
def photographs():
    """The middle of each head under the 64 lights, 8 bits, as (people, 64, rows, columns)."""
    stacks = []
    for seed in range(PEOPLE):
        mesh = mesh_of(head(seed, n_vertices=5000))
        view = gbuffer(mesh, frame_orthographic(mesh, 64))
        images = render(view, light_of(yale64()), caster=mesh)[:, 12:60, 12:54]
        codes = 2 + 250 * images / images.max(axis=(1, 2), keepdims=True)
        codes += np.random.default_rng(seed).normal(0, 1, codes.shape)
        stacks.append(np.clip(codes, 0, 255).astype(np.uint8))
    return np.stack(stacks)


@pytest.fixture
def yale(photographs, tmp_path):
    for person, stack in enumerate(photographs, 1):
        folder = tmp_path / "yale" / f"yaleB{person:02d}"
        folder.mkdir(parents=True)
        for label, image in zip(yale64().labels, stack, strict=True):
            Image.fromarray(image).save(folder / f"yaleB{person:02d}_P00{label}.pgm")
        (folder / f"yaleB{person:02d}_P00_Ambient.pgm").write_bytes(b"not read")
        (folder / f"yaleB{person:02d}_P00A+000E+00.pgm.bad").write_bytes(b"spoilt")
        (folder / "yaleB.info").write_text("a list")
    return "yale"


def test_names_tell_subject_light_and_subset(yale, tmp_path):
    found = find_photographs(tmp_path / yale)
    assert len(found) == PEOPLE * 64
    subsets = np.bincount([photograph.subset for photograph in found])[1:]
    assert np.array_equal(subsets, PEOPLE * np.array([7, 12, 12, 14, 19]))
    kept, images = read_photographs(found)
    lights = np.array([photograph.light for photograph in kept])
    halves = images.mean(axis=1).reshape(len(images), 2, -1).mean(axis=2)
    aside = np.abs(lights[:, 0]) > 0.5
    assert aside.sum() > 50
    # Whatever the sign of the name's azimuth, light from +x brightens the right half.
    assert np.array_equal(halves[aside, 1] > halves[aside, 0], lights[aside, 0] > 0)


@pytest.mark.parametrize("gallery", ["ninepoints", "subset1"])
def test_people_are_recognised_under_the_grid(run, yale, gallery):
    outcome = run(
        *("evaluate", yale, "--gallery", gallery, "--json"),
        *("--methods", "best,subspace,tan-triggs+nearest"),
    )
    assert outcome.code == 0
    methods = json.loads(outcome.out)["methods"]
    assert set(methods) == {"best", "subspace", "tan-triggs+nearest"}
    best = methods["best"]
    enrolled = 9 if gallery == "ninepoints" else 7
    assert best["probes"] == PEOPLE * (64 - enrolled)
    assert sum(each["probes"] for each in best["subsets"].values()) == best["probes"]
    # Under grazing light, subset 5, other methods name rendered heads better, see docs/limits.md.
    assert sum(best["subsets"][str(n)]["errors"] for n in (2, 3, 4)) == 0
    if gallery == "subset1":
        baselines = (methods["subspace"], methods["tan-triggs+nearest"])
        assert best["errors"] < min(each["errors"] for each in baselines) / 2
    assert best["seconds_per_probe"] > 0


def test_a_table_a_figure_and_the_protocol_are_written(run, yale, tmp_path):
    arguments = ("evaluate", yale, "--methods", "subspace,tan-triggs+nearest", "--out", "report")
    (tmp_path / "yale" / "yaleB02" / "yaleB02_P00A+010E+00.pgm").write_bytes(b"junk")
    outcome = run(*arguments, "--skip-bad", "--json", "--size", "24x21")
    assert outcome.code == 0
    record = json.loads((tmp_path / "report" / "results.json").read_text())
    times = json.loads((tmp_path / "report" / "times.json").read_text())["seconds_per_probe"]
    for name, found in record["methods"].items():
        found_with_time = {**found, "seconds_per_probe": times[name]}
        assert json.loads(outcome.out)["methods"][name] == found_with_time
    protocol = record["protocol"]
    assert protocol["subjects"] == PEOPLE
    assert protocol["rows_and_columns"] == [24, 21]
    assert len(protocol["enrolled"]) == record["images_enrolled"] == 9 * PEOPLE
    assert protocol["enrolled"][0].startswith("yaleB01/yaleB01_P00A")
    assert "yaleB02_P00A+010E+00.pgm" in protocol["skipped"][0]
    assert set(protocol["versions"]) >= {"harmface", "numpy", "scikit-learn"}
    with (tmp_path / "report" / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["subset"] for row in rows] == 2 * ["1", "2", "3", "4", "5", "all"]
    for row in rows:
        found = record["methods"][row["method"]]
        found = found if row["subset"] == "all" else found["subsets"][row["subset"]]
        assert (int(row["errors"]), int(row["probes"])) == (found["errors"], found["probes"])
        assert float(row["rate"]) == found["errors"] / found["probes"]
        assert float(row["rate_low"]) <= float(row["rate"]) <= float(row["rate_high"])
    for found in record["methods"].values():
        assert found["probes"] == PEOPLE * 55 - 1
        match = found["cumulative_match"]
        assert match[0] == pytest.approx(1 - found["errors"] / found["probes"])
        assert match[-1] == 1
        for curve in found["roc"].values():
            assert curve == sorted(curve)
    with Image.open(tmp_path / "report" / "figure.png") as image:
        assert image.width > 1000
    # The same again replaces what it wrote; another folder's files stay.
    assert run(*arguments, "--skip-bad").code == 0
    (tmp_path / "report" / "mine.txt").write_text("kept")
    outcome = run(*arguments, "--skip-bad")
    assert outcome.code == 2
    assert "holds other files (mine.txt)" in outcome.err


def test_methods_are_compared_on_the_same_probes(run, yale):
    arguments = ("evaluate", yale, "--gallery", "first:2", "--size", "24x21")
    methods = ("--methods", "nearest,correlation,subspace")
    record = json.loads(run(*arguments, *methods, "--json").out)
    wrong = {name: set(found["misnamed"]) for name, found in record["methods"].items()}
    for name, found in record["methods"].items():
        assert len(wrong[name]) == found["errors"] > 0
        assert all(given != file.split("/")[0] for file, given in found["misnamed"].items())
    assert [found["method"] for found in record["differences"]] == ["correlation", "subspace"]
    for found in record["differences"]:
        assert found["against"] == "nearest"
        ours, theirs = wrong[found["method"]], wrong["nearest"]
        assert found["only_first"] == len(ours - theirs)
        assert found["only_second"] == len(theirs - ours)
        assert found["interval"][0] <= found["rate"] <= found["interval"][1]
    shown = run(*arguments, *methods).out
    assert "against nearest" in shown
    alone = run(*arguments, "--methods", "nearest")
    assert (alone.code, "against" in alone.out) == (0, False)


def test_a_folder_for_each_subject(run, photographs, tmp_path):
    frontal = np.flatnonzero(yale64().subset <= 2)
    for name, stack in zip("abc", photographs, strict=False):
        (tmp_path / "people" / name).mkdir(parents=True)
        for number, k in enumerate(frontal):
            Image.fromarray(stack[k]).save(tmp_path / "people" / name / f"{number:02d}.png")
    common = ("evaluate", "people", "--methods", "subspace")
    found = run(*common, "--gallery", "first:9", "--json", "--size", "24x21")
    assert json.loads(found.out)["methods"]["subspace"]["errors"] == 0
    names = [path.name for path in sorted((tmp_path / "people" / "a").iterdir())[:5]]
    (tmp_path / "list.txt").write_text("\n".join(names))
    listed = run(*common, "--gallery", "list.txt").out
    # Without lights there are no subsets, but all probes.
    assert listed.count("of 42") == 1
    assert "all" in listed


def test_bad_input_is_refused(run, yale, check_refused, tmp_path):
    evaluate = ("evaluate", yale)
    (tmp_path / "empty").mkdir()
    (tmp_path / "wrong.txt").write_text("nobody.png")
    check_refused("is not a folder", "evaluate", "nowhere")
    check_refused("fewer than two subjects", "evaluate", "empty")
    check_refused("method must be best", *evaluate, "--methods", "magic")
    check_refused("method must be best", *evaluate, "--methods", "best,")
    check_refused("HxW", *evaluate, "--size", "48")
    check_refused("whole number", *evaluate, "--gallery", "first:x")
    check_refused("leaves no probe", *evaluate, "--gallery", "first:64")
    check_refused("names nobody.png", *evaluate, "--gallery", "wrong.txt")
    check_refused("missing.txt: does not exist", *evaluate, "--gallery", "missing.txt")
    spoilt = tmp_path / "yale" / "yaleB01" / "yaleB01_P00A+010E-20.pgm"
    spoilt.write_bytes(b"P5 nonsense")
    check_refused("yaleB01_P00A.010E-20.pgm: cannot be read", *evaluate)
    check_refused("cannot be read", *evaluate, "--out", "report")
    outcome = run(*evaluate, "--skip-bad", "--methods", "correlation", "--json")
    assert outcome.code == 0
    assert json.loads(outcome.out)["skipped"] == 1
    assert "skipped" in outcome.err
    Image.fromarray(np.zeros((48, 42), np.uint8)).save(spoilt)
    check_refused("shows nothing", *evaluate)
    Image.fromarray(np.arange(100, dtype=np.uint8).reshape(10, 10)).save(spoilt)
    check_refused("has 10 x 10 pixels", *evaluate)
    spoilt.unlink()
    (tmp_path / "yale" / "again").mkdir()
    (tmp_path / "yale" / "again" / "yaleB01_P00A+000E+00.pgm").write_bytes(b"P5")
    check_refused("second folder of subject 'yaleB01'", *evaluate)


def test_lights_are_needed_for_galleries_by_light(photographs, check_refused, tmp_path):
    for name, stack in zip("ab", photographs, strict=False):
        (tmp_path / "people" / name).mkdir(parents=True)
        Image.fromarray(stack[0]).save(tmp_path / "people" / name / "1.png")
    check_refused("names that tell the light", "evaluate", "people", "--gallery", "ninepoints")


def test_the_help_names_every_method():
    told = enroll.__annotations__["method"].__metadata__[0].help
    words = told.replace(",", " ").replace(";", " ").replace(".", " ").split()
    assert set(METHODS) <= set(words)
    assert {f"{name}+" for name in BEFORE} <= set(words)


def test_sessions_links_and_ratios_of_sides(run, photographs, tmp_path):
    for person, stack in enumerate(photographs[:2]):
        for session in ("may", "june"):
            folder = tmp_path / "archive" / f"person{person}" / session
            folder.mkdir(parents=True)
            for number, image in enumerate(stack[:6]):
                Image.fromarray(image).save(folder / f"{number}.png")
        (tmp_path / "people").mkdir(exist_ok=True)
        (tmp_path / "people" / f"person{person}").symlink_to(
            tmp_path / "archive" / f"person{person}"
        )
    common = ("enroll", "people", "--out", "g.npz", "--method", "nearest")
    outcome = run(*common)
    assert outcome.code == 2
    assert "--sessions" in outcome.err
    outcome = run(*common, "--sessions", "--size", "20x40")
    assert outcome.code == 0, outcome.err
    assert "middle is cut out for another ratio of sides" in outcome.err
    assert read_gallery(tmp_path / "g.npz").gallery_.photographs.images.shape == (24, 20, 40)
    # A probe is cut as the gallery was, and one of another ratio is refused.
    probe = "archive/person0/may/1.png"
    outcome = run("recognize", "g.npz", probe, "--json")
    assert json.loads(outcome.out)["results"][0]["ranking"][0]["subject"] == "person0"
    with Image.open(tmp_path / probe) as image:
        image.crop((0, 0, image.width // 2, image.height)).save(tmp_path / "half.png")
    outcome = run("recognize", "g.npz", "half.png")
    assert outcome.code == 2
    assert "another ratio of sides" in outcome.err
