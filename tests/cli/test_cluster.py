import json
import shutil

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from data_synth.lightings import uniform_directional
from harmface.recognition import subject_photographs
from harmface.reproduce.synthetic import light_of, mesh_of

PEOPLE, LIGHTS = ("ann", "bob", "cy"), 20


@pytest.fixture(scope="module")
def photographs(tmp_path_factory):
    """A folder for each of three heads under 20 lights of its own within 45 degrees."""
    folder = tmp_path_factory.mktemp("photographs")
    rng = np.random.default_rng(0)
    for seed, name in enumerate(PEOPLE):
        (folder / name).mkdir()
        lights = light_of(uniform_directional(LIGHTS, rng, max_polar=45.0))
        images = subject_photographs(mesh_of(head(seed, n_vertices=5000)), lights, 64)
        for number, image in enumerate(images[:, 12:60, 12:54]):
            codes = np.rint(250 * image / image.max()).astype(np.uint8)
            Image.fromarray(codes).save(folder / name / f"{name}{number:02d}.png")
    return folder


def test_photographs_are_sorted_by_person(run, photographs):
    outcome = run("cluster", photographs, "--count", 3, "--json")
    assert outcome.code == 0, outcome.err
    found = json.loads(outcome.out)
    assert found["purity"] == found["adjusted_rand"] == 1
    for group in found["groups"]:
        assert group["labels"] == {group["photographs"][0].split("/")[0]: LIGHTS}
    assert found["kmeans"]["purity"] < 1
    # The groups are the labels, so k-means is as far from the one as from the other.
    assert found["kmeans"]["agreement"] == pytest.approx(found["kmeans"]["adjusted_rand"])


@pytest.mark.parametrize("method", ["conic", "gradient-direction"])
def test_other_methods_beat_k_means(run, photographs, method):
    outcome = run("cluster", photographs, "--count", 3, "--method", method, "--json")
    found = json.loads(outcome.out)
    assert found["method"] == method
    assert found["purity"] > found["kmeans"]["purity"]


def test_nobody_need_say_who_it_is(run, photographs, tmp_path):
    for path in photographs.glob("*/*.png"):
        shutil.copy(path, tmp_path / path.name)
    outcome = run("cluster", ".", "--count", 3, "--json")
    assert outcome.code == 0, outcome.err
    found = json.loads(outcome.out)
    assert "purity" not in found
    assert not found["count_estimated"]
    people = [
        {name.rstrip("0123456789.png") for name in group["photographs"]}
        for group in found["groups"]
    ]
    assert all(len(names) == 1 for names in people)
    shown = run("cluster", ".")
    assert shown.code == 0
    assert "people, as estimated" in shown.out
    assert "agreement with k-means" in shown.out


def test_a_table_for_people(run, photographs):
    outcome = run("cluster", photographs, "--count", 3)
    assert outcome.code == 0
    assert "ann 20" in outcome.out
    assert "purity 1.000; k-means of the pixels 0." in outcome.out


def test_too_few_or_no_photographs_are_refused(check_refused, photographs, tmp_path):
    check_refused("at least 2 and fewer than the 60", "cluster", photographs, "--count", 1)
    check_refused("at least 2 and fewer than the 60", "cluster", photographs, "--count", 60)
    check_refused("method must be", "cluster", photographs, "--method", "nonsense")
    check_refused("must hold harmonic images", "cluster", photographs, "--method", "9d")
    (tmp_path / "empty").mkdir()
    check_refused("holds no photographs", "cluster", "empty")
    (tmp_path / "few").mkdir()
    for name in ("ann00.png", "ann01.png"):
        shutil.copy(photographs / "ann" / name, tmp_path / "few")
    check_refused("holds 2 photographs", "cluster", "few")
