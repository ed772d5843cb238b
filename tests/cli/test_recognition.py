import dataclasses
import json
import shutil

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.cli import main
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_gallery, read_image, write_gallery, write_image, write_ply
from harmface.recognition import SubjectClassifier
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of


@pytest.fixture(scope="module")
def heads(tmp_path_factory):
    folder = tmp_path_factory.mktemp("heads") / "faces"
    with pytest.raises(SystemExit, match="0"):
        main(["synth", "faces", "--count", "3", "--seed", "1", "--out", str(folder)])
    return folder


@pytest.fixture
def faces(run, heads, tmp_path):
    shutil.copytree(heads, tmp_path / "faces")


def width_of(path):
    with Image.open(path) as image:
        return image.width


@pytest.fixture
def gallery(run, faces):
    assert run("enroll", "faces", "--size", 48, "--out", "gallery.npz").code == 0


def test_a_rendered_face_is_recognised(run, gallery):
    for number in range(3):
        out = f"probe_{number}.png"
        mesh = f"faces/face_{number:03d}.ply"
        assert run("render", mesh, "--light", "40,20", "--size", 48, "--out", out).code == 0
    probes = [f"probe_{number}.png" for number in range(3)]
    outcome = run("recognize", "gallery.npz", *probes, "--json")
    assert outcome.code == 0
    results = json.loads(outcome.out)["results"]
    assert [result["image"] for result in results] == probes
    assert [result["ranking"][0]["subject"] for result in results] == [
        "face_000",
        "face_001",
        "face_002",
    ]
    for result in results:
        distances = [entry["distance"] for entry in result["ranking"]]
        assert len(distances) == 3
        assert distances == sorted(distances)
        assert 0 < distances[0] < 0.3


def test_a_table_for_people(run, gallery):
    run("render", "faces/face_001.ply", "--light", "-30,10", "--size", 48, "--out", "p.png")
    outcome = run("recognize", "gallery.npz", "p.png", "--method", "4d", "--top", 2)
    assert outcome.code == 0
    assert "face_001" in outcome.out
    assert "rank" in outcome.out


def test_subjects_are_named_after_their_files(run, faces, tmp_path):
    assert run("enroll", "faces/face_002.ply", "faces/face_000.ply", "--out", "g.npz").code == 0
    assert read_gallery(tmp_path / "g.npz").classes_.tolist() == ["face_000", "face_002"]
    # Whatever the order of enrolment, names stay with their faces.
    run("render", "faces/face_002.ply", "--light", "10,10", "--size", 64, "--out", "p.png")
    result = json.loads(run("recognize", "g.npz", "p.png", "--json").out)["results"][0]
    assert [entry["subject"] for entry in result["ranking"]] == ["face_002", "face_000"]


def test_cast_shadows_bring_the_subspace_nearer(run, gallery):
    run("render", "faces/face_002.ply", "--light", "60,30", "--size", 48, "--out", "p.png")
    best = [
        json.loads(run("recognize", "gallery.npz", "p.png", "--method", method, "--json").out)[
            "results"
        ][0]["ranking"][0]
        for method in ("9d", "shadowed+9d", "best")
    ]
    assert [each["subject"] for each in best] == ["face_002"] * 3
    assert best[0]["distance"] > best[1]["distance"] > best[2]["distance"]


def test_encoded_and_eight_bit_photographs(run, gallery):
    run(
        *("render", "faces/face_001.ply", "--light", "20,30", "--size", 48),
        *("--bits", 8, "--srgb", "--out", "p.png"),
    )
    outcome = run("recognize", "gallery.npz", "p.png", "--srgb", "--json")
    best = json.loads(outcome.out)["results"][0]["ranking"][0]
    assert best["subject"] == "face_001"
    assert best["distance"] < 0.3


def test_every_method_of_meshes_names_the_face(run, faces):
    arguments = ("--size", 24, "--method", "25d")
    assert run("enroll", "faces", *arguments, "--out", "g.npz").code == 0
    run("render", "faces/face_001.ply", "--light", "-30,10", "--size", 24, "--out", "p.png")
    found = {}
    for method in (
        *("3d", "4d", "9d", "shadowed+9d", "16d", "25d", "non-negative-4d", "non-negative-9d"),
        *("shadowed+robust", "harmonic+cone", "likelihood", "local", "lbph"),
    ):
        outcome = run("recognize", "g.npz", "p.png", "--method", method, "--json")
        result = json.loads(outcome.out)["results"][0]
        assert result["ranking"][0]["subject"] == "face_001", method
        found[method] = result["ranking"][0]["distance"]
    assert found["3d"] > found["4d"] > found["9d"] > found["shadowed+9d"]
    assert found["shadowed+9d"] > found["16d"] > found["25d"]
    assert found["non-negative-4d"] >= found["4d"]
    assert found["non-negative-9d"] >= found["9d"]
    # What the gallery was made for is what it does unless told.
    default = json.loads(run("recognize", "g.npz", "p.png", "--json").out)
    assert default["method"] == "25d"
    assert default["results"][0]["ranking"][0]["distance"] == found["25d"]


def test_nothing_is_fitted_again(run, gallery, monkeypatch):
    run("render", "faces/face_001.ply", "--light", "-30,10", "--size", 48, "--out", "p.png")
    whole = run("recognize", "gallery.npz", "p.png", "--json")
    monkeypatch.setattr(SubjectClassifier, "_fitted", None)
    assert run("recognize", "gallery.npz", "p.png", "--json").out == whole.out


def test_meshes_serve_the_methods_of_photographs(run, faces, tmp_path):
    run("enroll", "faces", "--size", 48, "--method", "local", "--out", "g.npz")
    gallery = read_gallery(tmp_path / "g.npz").gallery_
    assert gallery.aligned
    assert not gallery.mask.all()
    run("render", "faces/face_002.ply", "--light", "60,30", "--size", 48, "--out", "p.png")
    image = read_image(tmp_path / "p.png")
    write_image(tmp_path / "p.png", image)
    image[~gallery.mask] = 0.7
    write_image(tmp_path / "indoors.png", image)
    for method in ("local", "tan-triggs+nearest"):
        arguments = ("p.png", "indoors.png", "--method", method, "--figure", "why.png", "--json")
        record = json.loads(run("recognize", "g.npz", *arguments).out)
        rankings = [result["ranking"] for result in record["results"]]
        assert rankings[0][0]["subject"] == "face_002"
        # What is behind a head plays no part.
        assert rankings[1] == rankings[0]
    assert width_of(tmp_path / "why.png") > 400
    loose = SubjectClassifier.from_gallery(dataclasses.replace(gallery, aligned=False), "local")
    write_gallery(tmp_path / "loose.npz", loose)
    framed, loose = (
        json.loads(run("recognize", file, "p.png", "--json").out)["results"][0]["ranking"]
        for file in ("g.npz", "loose.npz")
    )
    # Moved copies explain more than the photographs alone.
    assert framed[0]["distance"] > loose[0]["distance"]


def test_a_stranger_is_rejected_and_an_enrolled_face_is_not(run, gallery, tmp_path):
    run("synth", "faces", "--count", 1, "--seed", 9, "--out", "others")
    for name, mesh in (("known", "faces/face_001.ply"), ("stranger", "others/face_000.ply")):
        run("render", mesh, "--light", "30,20", "--size", 48, "--out", f"{name}.png")
    arguments = ("recognize", "gallery.npz", "known.png", "stranger.png", "--reject", 0.1)
    record = json.loads(run(*arguments, "--json").out)
    known, stranger = record["results"]
    assert (known["known"], stranger["known"]) == (True, False)
    rejection = record["rejection"]
    # Nine pictures of each of three heads.
    assert rejection["strangers"] == 27
    assert rejection["false_accept_rate"] == 0.1
    assert known["margin_in_place"] > rejection["least_margin"] > stranger["margin_in_place"]
    first, second = (entry["distance"] for entry in known["ranking"][:2])
    assert known["margin"] == pytest.approx(1 - first / second)
    for result in record["results"]:
        assert sum(entry["probability"] for entry in result["ranking"]) == pytest.approx(1)
    assert known["ranking"][0]["probability"] > 0.9 > stranger["ranking"][0]["probability"]
    table = run(*arguments, "--figure", "why.png").out
    assert "accepted (10.00% of strangers are expected to exceed" in table
    assert "rejected as a stranger" in table
    assert width_of(tmp_path / "why.png") > 600


@pytest.fixture(scope="module")
def photographs():
    """Three heads under the 64 lights, 8 bits."""
    stacks = []
    for seed in range(3):
        mesh = mesh_of(head(seed, n_vertices=5000))
        view = gbuffer(mesh, frame_orthographic(mesh, 64))
        images = render(view, light_of(yale64()), caster=mesh)[:, 12:60, 12:54]
        stacks.append((250 * images / images.max(axis=(1, 2), keepdims=True)).astype(np.uint8))
    return np.stack(stacks)


@pytest.fixture
def people(photographs, tmp_path):
    """A folder for each of ann, bob and eve: eight photographs under light from the front."""
    frontal = np.flatnonzero(yale64().subset <= 2)[:8]
    for name, stack in zip(("ann", "bob", "eve"), photographs, strict=True):
        (tmp_path / "people" / name).mkdir(parents=True)
        for number, k in enumerate(frontal):
            Image.fromarray(stack[k]).save(tmp_path / "people" / name / f"{number}.png")
    probe = np.flatnonzero(yale64().subset == 2)[-1]
    Image.fromarray(photographs[1, probe]).save(tmp_path / "probe.png")
    return "people"


def test_photographs_are_enrolled_and_recognised(run, people, tmp_path):
    outcome = run("enroll", people, "--gallery", "first:8", "--out", "g.npz")
    assert "3 subjects, 24 photographs at 48 x 42 pixels" in outcome.out
    enrolled = read_gallery(tmp_path / "g.npz")
    assert enrolled.gallery_.facts["files"][:2] == ["ann/0.png", "ann/1.png"]
    assert enrolled.method == "framed+whitened"
    for method in ("local", "subspace", "equalized+correlation", "gradient-direction"):
        arguments = ("recognize", "g.npz", "probe.png", "--method", method, "--reject", 0.1)
        record = json.loads(run(*arguments, "--figure", "why.png", "--json").out)
        result = record["results"][0]
        assert result["ranking"][0]["subject"] == "bob"
        assert result["ranking"][0]["probability"] > 1 / 3
        assert record["rejection"]["strangers"] == 24
    # Without a light to show, five columns are left.
    assert width_of(tmp_path / "why.png") < 900


def test_probes_are_treated_as_the_enrolled_photographs_were(run, people, photographs, tmp_path):
    for path in (tmp_path / people).rglob("*.png"):
        with Image.open(path) as image:
            larger = image.resize((84, 96))
        larger.save(path)
    Image.fromarray(photographs[2, 20]).resize((84, 96)).save(tmp_path / "large.png")
    run("enroll", people, "--size", "24x21", "--srgb", "--out", "g.npz")
    record = json.loads(run("recognize", "g.npz", "large.png", "--json").out)
    assert record["results"][0]["ranking"][0]["subject"] == "eve"
    told = json.loads(run("recognize", "g.npz", "large.png", "--srgb", "--json").out)
    assert told["results"] == record["results"]


def test_fewer_photographs_than_dimensions_are_told_and_do(run, people, tmp_path):
    for number in range(2, 8):
        (tmp_path / people / "ann" / f"{number}.png").unlink()
    enrolled = run("enroll", people, "--method", "local", "--out", "g.npz")
    assert "(fewest 2, of ann)" in enrolled.out
    record = json.loads(run("recognize", "g.npz", "probe.png", "--json").out)
    ranking = record["results"][0]["ranking"]
    assert ranking[0]["subject"] == "bob"
    # Two photographs are too few to hold some out, so nothing tells how sure a name is.
    assert ranking[0]["probability"] is None


def test_one_photograph_a_person_is_enough(run, people, tmp_path):
    enrolled = run("enroll", people, "--gallery", "first:1", "--out", "g.npz").out
    assert "for framed+whitened" in enrolled
    outcome = run("recognize", "g.npz", "probe.png", "--reject", 0.1, "--json")
    result = json.loads(outcome.out)["results"][0]
    assert result["ranking"][0]["subject"] == "bob"
    # Other people stand in for photographs that cannot be left out.
    assert sum(entry["probability"] for entry in result["ranking"]) == pytest.approx(1)


def test_misframed_probes_are_moved_and_named(run, people, photographs, tmp_path):
    run("enroll", people, "--method", "framed+local", "--out", "g.npz")
    moved = np.roll(photographs[1, 20], (3, -2), axis=(0, 1))
    Image.fromarray(moved).save(tmp_path / "moved.png")
    outcome = run("recognize", "g.npz", "moved.png", "--json")
    result = json.loads(outcome.out)["results"][0]
    assert result["ranking"][0]["subject"] == "bob"
    assert result["framing"]["right"] == pytest.approx(-2, abs=1)
    assert result["framing"]["down"] == pytest.approx(3, abs=1)
    assert "moved.png: is framed otherwise" in outcome.err


def test_a_probe_without_a_face_is_named(run, people, tmp_path):
    run("enroll", people, "--gallery", "first:1", "--method", "whitened", "--out", "g.npz")
    noise = np.random.default_rng(0).integers(0, 255, (48, 42), np.uint8)
    Image.fromarray(noise).save(tmp_path / "noise.png")
    outcome = run("recognize", "g.npz", "noise.png", "probe.png", "--json")
    noise, face = json.loads(outcome.out)["results"]
    assert noise["far_from_all"] and not face["far_from_all"]
    assert outcome.err.count("shows no face framed as the gallery") == 1
    assert "noise.png" in outcome.err
    run("enroll", people, "--method", "local", "--out", "l.npz")
    result = json.loads(run("recognize", "l.npz", "noise.png", "--json").out)["results"][0]
    assert result["far_from_all"] is None


def test_other_people_are_learned_from(run, people, photographs, check_refused, tmp_path):
    for number in range(4):
        (tmp_path / "others" / f"{number}").mkdir(parents=True)
        for k in (3, 20, 40):
            image = photographs[number % 3, k].astype(float) ** (1 - 0.1 * number)
            path = tmp_path / "others" / f"{number}" / f"{k}.png"
            Image.fromarray((255 * image / image.max()).astype(np.uint8)).save(path)
    learn = ("enroll", people, "--gallery", "first:1", "--learn-from", "others")
    assert run(*learn, "--out", "g.npz").code == 0
    shutil.rmtree(tmp_path / "others" / "3")
    check_refused("at least 4 people.*got 3", *learn, "--out", "h.npz")
    check_refused("is not a folder", *learn[:-1], "nowhere", "--out", "h.npz")


def test_one_subject_has_a_distance_but_no_margin(run, faces, check_refused):
    outcome = run("enroll", "faces/face_000.ply", "--size", 32, "--out", "g.npz")
    assert outcome.out.startswith("1 subject at")
    run("render", "faces/face_000.ply", "--light", "0,0", "--size", 32, "--out", "p.png")
    outcome = run("recognize", "g.npz", "p.png", "--figure", "why.png", "--json")
    result = json.loads(outcome.out)["results"][0]
    assert result["margin"] is None
    assert [entry["probability"] for entry in result["ranking"]] == [None]
    assert "margin" not in run("recognize", "g.npz", "p.png").out
    check_refused("three subjects", "recognize", "g.npz", "p.png", "--reject", 0.1)


def test_a_bad_file_is_named_and_the_rest_goes_on_if_told(run, faces, people, tmp_path):
    (tmp_path / people / "bob" / "3.png").write_bytes(b"junk")
    (tmp_path / "faces" / "cut.ply").write_bytes(b"ply")
    for source, name in ((people, "3.png"), ("faces", "cut.ply")):
        refused = run("enroll", source, "--out", "g.npz")
        assert refused.code == 2
        assert name in refused.err
        outcome = run("enroll", source, "--out", "g.npz", "--skip-bad")
        assert outcome.code == 0
        assert name in outcome.err
        assert "1 file skipped" in outcome.err
    run("enroll", people, "--out", "g.npz", "--skip-bad")
    Image.new("L", (42, 48)).save(tmp_path / "dark.png")
    outcome = run("recognize", "g.npz", "dark.png", "probe.png", "none.png", "--skip-bad", "--json")
    record = json.loads(outcome.out)
    assert record["skipped"] == 2
    assert [result["image"] for result in record["results"]] == ["probe.png"]
    assert "dark.png: is all black" in outcome.err
    assert "none.png: does not exist" in outcome.err
    outcome = run("recognize", "g.npz", "dark.png", "--skip-bad")
    assert outcome.code == 2
    assert "no image is left" in outcome.err
    for path in (tmp_path / "faces").glob("face*"):
        path.write_bytes(b"ply")
    outcome = run("enroll", "faces", "--out", "g.npz", "--skip-bad")
    assert outcome.code == 2
    assert "no mesh could be read" in outcome.err


def test_methods_a_gallery_cannot_serve_are_refused(run, gallery, people, check_refused, tmp_path):
    run("enroll", people, "--method", "subspace", "--out", "photographs.npz")
    with_probe = ("recognize", "photographs.npz", "probe.png")
    assert json.loads(run(*with_probe, "--json").out)["method"] == "subspace"
    check_refused("harmonic images.*enroll meshes", *with_probe, "--method", "9d")
    check_refused("names that tell the light", *with_probe, "--method", "relit+local")
    check_refused("method must be best, or one of local", *with_probe, "--method", "magic")
    Image.new("L", (48, 48), 9).save(tmp_path / "flat.png")
    check_refused("one value everywhere that faces are", "recognize", "gallery.npz", "flat.png")
    check_refused("rate must lie between", *with_probe, "--reject", 2)
    check_refused(r"ends in \.png", *with_probe, "--figure", "why.jpg")
    check_refused(
        "shows 40 images at most, got 41", *with_probe, *40 * ["probe.png"], "--figure", "a.png"
    )


def test_what_cannot_be_enrolled_is_refused(faces, people, check_refused, tmp_path):
    enroll = ("enroll", "--out", "g.npz")
    check_refused("harmonic images.*enroll meshes", *enroll, people, "--method", "9d")
    check_refused("method must be best", *enroll, people, "--method", "magic")
    check_refused("method must be best", *enroll, "faces", "--method", "magic")
    check_refused("for photographs, not meshes", *enroll, "faces", "--gallery", "first:2")
    check_refused("for meshes, not photographs", *enroll, people, "--rotate", "x:90")
    check_refused("HxW", *enroll, people, "--size", 48)
    check_refused("whole number for meshes", *enroll, "faces", "--size", "48x42")
    check_refused("nowhere: does not exist", *enroll, "nowhere")
    Image.new("L", (10, 10), 9).save(tmp_path / people / "eve" / "9.png")
    check_refused("9.png: has 10 x 10 pixels, others 48 x 42", *enroll, people)
    (tmp_path / people / "eve" / "9.png").unlink()
    (tmp_path / people / "more").mkdir()
    (tmp_path / people / "ann").rename(tmp_path / people / "more" / "bob")
    check_refused("second folder of subject 'bob'", *enroll, people)
    (tmp_path / people / "more" / "bob").rename(tmp_path / "away")
    (tmp_path / people / "eve").rename(tmp_path / "gone")
    check_refused("fewer than two subjects", *enroll, people)


def test_bad_input_is_refused(gallery, check_refused, tmp_path, rng):
    def picture(name, codes):
        Image.fromarray(codes).save(tmp_path / name)
        return name

    noise = rng.integers(0, 256, (48, 48), dtype=np.uint8)
    good = picture("good.png", noise)
    recognize = ("recognize", "gallery.npz")
    check_refused("none.npz: does not exist", "recognize", "none.npz", good)
    check_refused("missing.png: does not exist", *recognize, "missing.png")
    check_refused(
        "small.png: has 8 x 9 pixels.*resize", *recognize, picture("small.png", noise[:8, :9])
    )
    check_refused("black.png: is all black", *recognize, picture("black.png", noise * 0))
    check_refused("method must be best", *recognize, good, "--method", "5d")
    check_refused("1 or more", *recognize, good, "--top", 0)
    (tmp_path / "text.png").write_text("hello")
    check_refused("text.png: cannot be read as an image", *recognize, "text.png")
    broken = bytearray((tmp_path / "gallery.npz").read_bytes())
    broken[1000] ^= 1
    (tmp_path / "broken.npz").write_bytes(broken)
    check_refused("broken.npz: is damaged", "recognize", "broken.npz", good)
    check_refused("text.png: is not a harmface gallery", "recognize", "text.png", good)


def test_bad_meshes_are_refused(faces, check_refused, tmp_path):
    (tmp_path / "empty.ply").write_bytes(b"")
    (tmp_path / "cut.ply").write_bytes((tmp_path / "faces" / "face_000.ply").read_bytes()[:5000])
    (tmp_path / "bare").mkdir()
    (tmp_path / "again").mkdir()
    (tmp_path / "again" / "face_000.obj").write_text("v 0 0 0")
    enroll = ("enroll", "--out", "g.npz")
    check_refused("no.ply: does not exist", *enroll, "no.ply")
    check_refused("empty.ply: is empty", *enroll, "empty.ply")
    check_refused("cut.ply: promises .* elements", *enroll, "cut.ply")
    check_refused("bare: holds no mesh", *enroll, "bare")
    mesh = mesh_of(head(0, n_vertices=5000))
    write_ply(tmp_path / "black.ply", dataclasses.replace(mesh, albedo=0 * mesh.albedo))
    check_refused("black.ply: mesh is black under some light", *enroll, "black.ply")
    check_refused("second mesh of subject 'face_000'", *enroll, "faces", "again")
    check_refused("size must be 1 or more", *enroll, "faces", "--size", 0)
    check_refused("nowhere.*cannot be written", "enroll", "faces", "--out", "nowhere/g.npz")
