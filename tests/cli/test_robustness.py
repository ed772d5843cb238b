"""Whatever happens ends in one line; outputs are no inputs; names are shown as they are."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import harmface.light
from harmface.io import claim, write_environment_map, write_gallery
from harmface.recognition import Gallery, Photographs, SubjectClassifier


@pytest.fixture
def sky(tmp_path):
    write_environment_map(tmp_path / "sky.hdr", np.ones((4, 8, 3), np.float32))
    return "sky.hdr"


@pytest.fixture
def broken(monkeypatch):
    """A defect in the middle of a command."""

    def fail(*arguments):
        raise KeyError("[/x]\x1b[31m\n" + 1000 * "y")

    monkeypatch.setattr(harmface.light, "project", fail)


def test_a_defect_is_one_line_and_a_code_of_its_own(run, sky, broken):
    outcome = run("envmap", "project", sky)
    assert outcome.code == 3
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert "a defect of harmface" in outcome.err
    assert "KeyError" in outcome.err
    assert "--debug" in outcome.err
    assert "\x1b" not in outcome.err
    assert len(outcome.err) < 500


def test_debug_shows_where(run, sky, broken):
    for arguments in (("--debug", "envmap", "project", sky), ("envmap", "project", sky, "--debug")):
        outcome = run(*arguments)
        assert outcome.code == 3
        assert "Traceback" in outcome.err
        assert "in fail" in outcome.err


def test_a_lack_of_memory_is_said(run, sky, monkeypatch):
    def fail(*arguments):
        raise MemoryError("Unable to allocate 9 TiB" + 1000 * "y")

    monkeypatch.setattr(harmface.light, "project", fail)
    outcome = run("envmap", "project", sky)
    assert outcome.code == 2
    assert "not enough memory (Unable to allocate 9 TiByy" in outcome.err
    assert "give smaller input" in outcome.err
    assert len(outcome.err) < 300
    assert outcome.err.count("\n") == 1


LONG = "x" * 300


@pytest.mark.parametrize(
    "arguments",
    [
        ("envmap", "project", LONG + ".hdr"),
        ("basis", LONG + ".ply", "--out", "b.npz"),
        ("enroll", LONG, "--out", "g.npz"),
        ("evaluate", LONG),
        ("recognize", LONG, "a.png"),
        ("synth", "shapes", "--out", LONG),
        ("synth", "dataset", "--identities", 1, "--out", LONG),
        ("reproduce", "--only", "energy-by-degree", "--out", LONG),
        ("envmap", "rotate", "sky.hdr", "--out", LONG + ".hdr"),
        ("synth", "faces", "--count", 1, "--out", "a/b/" + 20 * (LONG[:250] + "/")),
    ],
    ids=lambda arguments: " ".join(map(str, arguments))[:24],
)
def test_paths_that_are_too_long_are_refused(sky, check_refused, arguments):
    check_refused("too long|not a folder|not exist", *arguments)


def test_an_output_is_no_input(sky, check_refused, tmp_path):
    (tmp_path / "link.hdr").symlink_to(tmp_path / "sky.hdr")
    (tmp_path / "people" / "a").mkdir(parents=True)
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "people" / "a" / "1.png")
    (tmp_path / "m.ply").write_text("ply")
    rotate = ("envmap", "rotate", sky, "--out")
    check_refused("is read as well", *rotate, sky)
    check_refused("is read as well", *rotate, "./link.hdr")
    check_refused("is read as well", "envmap", "irradiance", sky, "--out", sky)
    check_refused("is read as well", "basis", "m.ply", "--out", "m.ply")
    check_refused("two outputs", "basis", "m.ply", "--out", "b.png", "--figure", "./b.png")
    check_refused("is read as well", "enroll", "people", "--out", "people/a/new.png")
    check_refused("lies in people", "evaluate", "people", "--out", "people/report")
    check_refused("lies in heads", "synth", "faces", "--out", "heads", "--sheet", "heads/s.png")
    assert harmface.io.read_environment_map(tmp_path / "sky.hdr").total().min() > 0


def test_devices_and_pipes_are_no_outputs(sky, check_refused, tmp_path, terminal):
    os.mkfifo(tmp_path / "pipe.hdr")
    for path in (terminal, "pipe.hdr"):
        check_refused("a device or a pipe", "envmap", "rotate", sky, "--out", path)
    check_refused("cannot be written", "envmap", "rotate", sky, "--out", "no/such/folder.hdr")


def test_of_two_commands_on_one_output_one_is_refused(run, sky, check_refused, tmp_path):
    (tmp_path / "heads").mkdir()
    with claim(tmp_path / "t.hdr"), claim(tmp_path / "heads"):
        outcome = run("envmap", "rotate", sky, "--out", "t.hdr")
        assert (outcome.code, outcome.err.count("\n")) == (2, 1)
        assert "another process is writing there" in outcome.err
        assert run("synth", "faces", "--count", 1, "--out", "heads").code == 2
        assert run("synth", "shapes", "--out", "heads").code == 2
    assert run("envmap", "rotate", sky, "--out", "t.hdr").code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["heads", "sky.hdr", "t.hdr"]


def test_brackets_in_names_are_no_markup(run, tmp_path):
    images = np.random.default_rng(0).random((4, 8, 8))
    names = ("[/x] :smile:", "[/x] :smile:", "[bold]b[/bold]", "[bold]b[/bold]")
    photographs = Photographs(np.array(names), images)
    gallery = Gallery(photographs, photographs.everywhere)
    folder = tmp_path / "a[" / "b]"  # together a closing tag
    folder.mkdir(parents=True)
    write_gallery(folder / "g.npz", SubjectClassifier.from_gallery(gallery, "nearest"))
    Image.fromarray((255 * images[0]).astype(np.uint8)).save(folder / "[bold].png")
    outcome = run("recognize", "a[/b]/g.npz", "a[/b]/[bold].png")
    assert outcome.code == 0, outcome.err
    for name in ("[/x] :smile:", "[bold]b[/bold]", "[bold].png"):
        assert name in outcome.out
    write_environment_map(tmp_path / "e.hdr", np.ones((4, 8, 3), np.float32))
    outcome = run("envmap", "rotate", "e.hdr", "--out", "a[/b]/i.hdr")
    assert outcome.code == 0, outcome.err
    assert "a[/b]/i.hdr" in outcome.out


def test_names_that_are_no_text_are_spelt_out(sky, tmp_path):
    command = "import sys; from harmface.cli import main; main(sys.argv[1:])"
    name = os.fsencode(tmp_path) + b"/t\xff.hdr"
    found = subprocess.run(
        [sys.executable, "-c", command, "envmap", "rotate", tmp_path / sky, "--out", name],
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONUTF8": "1"},
    )
    assert (found.returncode, found.stderr) == (0, b"")
    assert os.path.exists(name)  # noqa: PTH110 - a path of bytes


@pytest.mark.parametrize("options", [(), ("--json",)], ids=["table", "json"])
def test_a_reader_that_has_seen_enough_ends_the_command_quietly(sky, tmp_path, options):
    command = "import sys; from harmface.cli import main; main(sys.argv[1:])"
    with subprocess.Popen(
        [sys.executable, "-c", command, "envmap", "project", tmp_path / sky, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        process.stdout.close()
        assert process.stderr.read() == b""


def test_a_stopped_reproduction_goes_on_where_it_was(run, tmp_path, monkeypatch):
    from harmface.reproduce.registry import EXPERIMENTS

    claims = ("energy-by-degree", "worst-pixel-error")
    whole = ("reproduce", "--only", *claims, "--out", "whole")
    assert run(*whole).code == 0
    calls = []

    def counted(name):
        own = EXPERIMENTS[name]
        return lambda: calls.append(name) or own()

    def stopped():
        raise KeyboardInterrupt

    first, second = (counted(name) for name in claims)
    monkeypatch.setitem(EXPERIMENTS, claims[0], first)
    monkeypatch.setitem(EXPERIMENTS, claims[1], stopped)
    again = ("reproduce", "--only", *claims, "--out", "again")
    assert run(*again).code == 130
    assert not (tmp_path / "again" / "report.html").exists()
    monkeypatch.setitem(EXPERIMENTS, claims[1], second)
    assert run(*again).code == 0
    assert calls == list(claims)
    files = ["report.html", "results.json", "times.json"]
    assert sorted(path.name for path in (tmp_path / "again").iterdir()) == files
    for name in files[:2]:
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_stopped_evaluation_goes_on_where_it_was(run, tmp_path, monkeypatch):
    rng = np.random.default_rng(0)
    for person in "abc":
        (tmp_path / "people" / person).mkdir(parents=True)
        own = rng.random((12, 10))
        for number in range(5):
            codes = 200 * own + 50 * rng.random(own.shape)
            picture = tmp_path / "people" / person / f"{number}.png"
            Image.fromarray(codes.astype(np.uint8)).save(picture)
    common = ("evaluate", "people", "--gallery", "first:2", "--methods", "nearest,correlation")
    assert run(*common, "--out", "whole").code == 0
    measure, calls = SubjectClassifier.distances, []

    def once(classifier, probes):
        calls.append(classifier)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return measure(classifier, probes)

    monkeypatch.setattr(SubjectClassifier, "distances", once)
    assert run(*common, "--out", "again").code == 130
    assert run(*common, "--out", "again").code == 0
    assert len(calls) == 3
    whole, again = tmp_path / "whole", tmp_path / "again"
    assert sorted(path.name for path in again.iterdir()) == sorted(
        path.name for path in whole.iterdir()
    )
    for name in ("results.json", "table.csv", "figure.png"):
        assert (whole / name).read_bytes() == (again / name).read_bytes()
    assert "seconds_per_probe" not in (whole / "results.json").read_text()
    times = json.loads((again / "times.json").read_text())["seconds_per_probe"]
    assert set(times) == {"nearest", "correlation"}
    # Other photographs are another job: nothing of the first is used.
    assert run(*common, "--out", "again", "--size", "6x5").code == 0
    assert len(calls) == 5
