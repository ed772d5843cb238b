import json

import numpy as np
import pytest
from PIL import Image

from data_synth.faces import head
from data_synth.lightings import yale64
from harmface.geometry import frame_orthographic, gbuffer
from harmface.io import read_gallery
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of

PEOPLE = 3
GRID = yale64()
USED = np.flatnonzero((GRID.subset == 1) | (GRID.subset == 5))[::2]
FRONTAL = int((GRID.subset[USED] == 1).sum())


@pytest.fixture(scope="module")
def photographs():
    """The middle of each head under every other light of the first and last subset, 8 bits."""
    lights = light_of(GRID)
    some = type(lights)(lights.directions[USED], np.eye(len(USED)))
    stacks = []
    for seed in range(PEOPLE):
        mesh = mesh_of(head(seed, n_vertices=5000))
        images = render(gbuffer(mesh, frame_orthographic(mesh, 48)), some, caster=mesh)
        images = images[:, 9:45, 9:39]
        stacks.append(np.clip(2 + 230 * images / images.max(), 0, 255).astype(np.uint8))
    return stacks


@pytest.fixture
def yale(photographs, tmp_path):
    for person, stack in enumerate(photographs, 1):
        folder = tmp_path / "yale" / f"yaleB{person:02d}"
        folder.mkdir(parents=True)
        for light, image in zip(USED, stack, strict=True):
            Image.fromarray(image).save(folder / f"{folder.name}_P00{GRID.labels[light]}.pgm")
    return "yale"


@pytest.fixture
def unlit(photographs, tmp_path):
    """The same under names that do not tell the light."""
    for person, stack in enumerate(photographs):
        (tmp_path / "plain" / f"person{person}").mkdir(parents=True)
        for number, image in enumerate(stack):
            Image.fromarray(image).save(tmp_path / "plain" / f"person{person}" / f"{number}.png")
    return "plain"


def test_what_was_not_photographed_is_rendered(run, yale):
    methods = ("--methods", "best,local,relit+local,relit+subspace")
    outcome = run("evaluate", yale, "--gallery", "subset1", *methods, "--json")
    assert outcome.code == 0
    record = json.loads(outcome.out)
    assert record["protocol"]["settings"]["best"] == "framed+whitened"
    assert record["images_enrolled"] == PEOPLE * FRONTAL
    curves = {name: each["roc"] for name, each in record["methods"].items()}
    assert curves["relit+local"] != curves["local"]
    found = record["methods"]["relit+local"]
    assert found["errors"] <= found["probes"] / 10


def test_without_known_lights_nothing_is_rendered(run, unlit, check_refused):
    outcome = run("evaluate", unlit, "--gallery", "first:4", "--json")
    assert json.loads(outcome.out)["protocol"]["settings"] == {"best": "framed+whitened"}
    arguments = ("evaluate", unlit, "--gallery", "first:4", "--methods", "relit+local")
    check_refused("names that tell the light", *arguments)


def test_enrolled_surfaces_join_the_gallery(run, yale, tmp_path):
    assert (
        run(
            "enroll", yale, "--gallery", "subset1", "--method", "relit+local", "--out", "g.npz"
        ).code
        == 0
    )
    gallery = read_gallery(tmp_path / "g.npz").gallery_
    assert len(gallery.photographs.images) == PEOPLE * FRONTAL
    # Of the nine points of light the frontal one was photographed.
    assert len(gallery.relit.images) == PEOPLE * 8
    probe = tmp_path / "yale" / "yaleB02" / f"yaleB02_P00{GRID.labels[USED[-1]]}.pgm"
    found = json.loads(run("recognize", "g.npz", str(probe), "--json").out)
    assert found["results"][0]["ranking"][0]["subject"] == "yaleB02"


def test_surfaces_are_recovered_from_photographs_of_known_light_only(unlit, check_refused):
    arguments = ("enroll", unlit, "--method", "relit+local", "--out", "g.npz")
    check_refused("names that tell the light", *arguments)
