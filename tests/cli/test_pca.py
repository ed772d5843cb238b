import json

import numpy as np
import pytest


@pytest.fixture
def ball(run):
    run("synth", "shapes", "--out", "shapes")
    return "shapes/sphere.ply"


def test_a_sphere_has_its_published_fractions(run, ball, tmp_path):
    outcome = run("pca", ball, "--size", 96, "--figure", "modes.png", "--json")
    assert outcome.code == 0
    found = json.loads(outcome.out)
    # The project's figures for every visible pixel the same weight, mean subtracted.
    expected = [0.428, 0.241, 0.241, 0.024, 0.024, 0.019]
    assert np.allclose(found["eigenvalue_fractions"][:6], expected, atol=0.003)
    assert np.allclose(np.cumsum(found["eigenvalue_fractions"]), found["cumulative"])
    assert (tmp_path / "modes.png").stat().st_size > 5000


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--keep-mean"], [0.619, 0.151, 0.151, 0.035]),
        (["--light", "front"], [0.361, 0.361, 0.225, 0.022]),
        (["--light", "cone:90"], [0.361, 0.361, 0.225, 0.022]),
    ],
)
def test_light_and_mean_change_the_fractions(run, ball, options, expected):
    found = json.loads(run("pca", ball, "--size", 96, "--json", *options).out)
    assert np.allclose(found["eigenvalue_fractions"][:4], expected, atol=0.003)


def test_images_without_harmonics_agree(run, ball):
    found = json.loads(run("pca", ball, "--size", 48, "--empirical", 1500, "--json").out)
    low, high = np.array(found["empirical"]["interval_95"])[:5].T
    # Five intervals of 95 %, widened by half for all of them to cover at once.
    middle, half = (low + high) / 2, 0.75 * (high - low)
    assert (np.abs(np.array(found["eigenvalue_fractions"][:5]) - middle) <= half).all()
    # A sphere's fifth and sixth modes have nearly the same share: one of five angles is loose.
    assert max(found["empirical"]["principal_angles_degrees"][1:]) < 5


def test_a_basis_file_serves_as_well_as_its_mesh(run, ball):
    run("basis", ball, "--size", 96, "--out", "b.npz")
    mesh = json.loads(run("pca", ball, "--size", 96, "--json").out)
    file = json.loads(run("pca", "b.npz", "--json").out)
    # A basis is supersampled, a PCA of a mesh is not.
    assert np.allclose(mesh["eigenvalue_fractions"], file["eigenvalue_fractions"], atol=0.01)


def test_albedo_counts_on_request(run, ball):
    vase = ball.replace("sphere", "vase")
    white = json.loads(run("pca", vase, "--size", 64, "--json").out)
    painted = json.loads(run("pca", vase, "--size", 64, "--albedo", "mesh", "--json").out)
    difference = np.subtract(white["eigenvalue_fractions"], painted["eigenvalue_fractions"])
    assert np.abs(difference).max() > 1e-3


def test_a_table_for_people(run, ball):
    assert "cumulative" in run("pca", ball, "--size", 32).out


def test_nonsense_is_refused(ball, check_refused):
    check_refused("uniform, front or cone:DEGREES", "pca", ball, "--light", "moon")
    check_refused("uniform, front or cone:DEGREES", "pca", ball, "--light", "cone:200")
    check_refused("uniform, front or cone:DEGREES", "pca", ball, "--light", "30")
    check_refused("mesh or constant", "pca", ball, "--albedo", "white")
    check_refused("at least 9 images", "pca", ball, "--empirical", 4)
    check_refused("degree must be 0 or more", "pca", ball, "--degree", -1)
    check_refused("none varies", "pca", ball, "--degree", 0)
    check_refused("does not exist", "pca", "nothing.npz")
