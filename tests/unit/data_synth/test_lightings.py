"""Lights against the published lists, and the mixtures against what they promise."""

import re

import numpy as np
import pytest

from data_synth.lightings import (
    Lights,
    mixed,
    nine_points,
    uniform_directional,
    yale64,
    yale_subset,
)

# The first four subsets as published with the database; the fifth is the rest.
PUBLISHED_SUBSETS = {
    1: "A+000E+00 A-010E+00 A+010E+00 A-005E+10 A+005E+10 A-005E-10 A+005E-10",
    2: "A+000E-20 A-010E-20 A+020E-10 A-025E+00 A-015E+20 A-020E-10 A+000E+20 A+010E-20 "
    "A+020E+10 A+025E+00 A+015E+20 A-020E+10",
    3: "A+000E-35 A-035E+15 A-035E-20 A-020E-40 A-035E+40 A-050E+00 A+000E+45 A+035E+15 "
    "A+035E-20 A+020E-40 A+035E+40 A+050E+00",
    4: "A-050E-40 A+060E-20 A-060E-20 A-035E+65 A-070E+00 A-070E-35 A-070E+45 A+050E-40 "
    "A+060E+20 A-060E+20 A+035E+65 A+070E+00 A+070E-35 A+070E+45",
}


def test_yale64_has_64_distinct_single_lights_named_as_published() -> None:
    lights = yale64()
    assert lights.directions.shape == (64, 3)
    assert len(set(lights.labels)) == 64
    assert all(re.fullmatch(r"A[+-]\d{3}E[+-]\d{2}", label) for label in lights.labels)
    np.testing.assert_array_equal(lights.weights, np.eye(64))


@pytest.mark.parametrize("subset", PUBLISHED_SUBSETS)
def test_yale64_subsets_are_the_published_ones(subset: int) -> None:
    lights = yale64()
    assert lights.subset is not None
    labels = {label for label, s in zip(lights.labels, lights.subset, strict=True) if s == subset}
    assert labels == set(PUBLISHED_SUBSETS[subset].split())


def test_yale64_directions_follow_their_labels() -> None:
    lights = yale64()
    direction = dict(zip(lights.labels, lights.directions, strict=True))
    np.testing.assert_allclose(direction["A+000E+00"], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(direction["A+000E+90"], [0, 1, 0], atol=1e-15)
    half, root = 0.5, np.sqrt(0.5)
    # To the subject's right is to the image's left.
    np.testing.assert_allclose(
        direction["A+070E+45"],
        [-np.sin(np.radians(70)) * root, root, np.cos(np.radians(70)) * root],
        atol=1e-15,
    )
    np.testing.assert_allclose(direction["A-120E+00"], [np.sqrt(0.75), 0, -half], atol=1e-15)


def test_yale_subset_keeps_shape_and_limits() -> None:
    angles = np.radians([[0, 11, 24, 49], [76, 80, 120, 180]])
    directions = np.stack([np.sin(angles), np.zeros_like(angles), np.cos(angles)], axis=-1)
    np.testing.assert_array_equal(yale_subset(directions), [[1, 1, 2, 3], [4, 5, 5, 5]])


def test_nine_points_are_on_the_front_at_their_published_angles() -> None:
    lights = nine_points()
    polar = np.degrees(np.arccos(lights.directions[:, 2]))
    np.testing.assert_allclose(polar, [0, 68, 74, 80, 85, 85, 85, 85, 51], atol=1e-12)
    azimuth = np.degrees(np.arctan2(lights.directions[1:, 1], lights.directions[1:, 0]))
    np.testing.assert_allclose(azimuth, [-90, 108, 52, -42, -137, 146, -4, 67], atol=1e-12)


def test_nine_points_span_nine_dimensions() -> None:
    directions = uniform_directional(2000, 1).directions
    images = np.maximum(directions @ nine_points().directions.T, 0.0)
    assert np.linalg.matrix_rank(images) == 9


def test_uniform_directional_has_the_moments_of_the_sphere() -> None:
    n = 4000
    directions = uniform_directional(n, 3).directions
    # Each component has mean 0 and variance 1/3, its square variance 4/45: five deviations.
    assert np.abs(directions.mean(axis=0)).max() < 5 * np.sqrt(1 / 3 / n)
    assert np.abs((directions**2).mean(axis=0) - 1 / 3).max() < 5 * np.sqrt(4 / 45 / n)


def test_uniform_directional_keeps_to_its_cap() -> None:
    directions = uniform_directional(500, 3, max_polar=30.0).directions
    assert directions[:, 2].min() >= np.cos(np.radians(30))
    assert directions[:, 2].min() < np.cos(np.radians(29))


def test_mixed_lights_the_best_lit_normal_with_one() -> None:
    lights = mixed(12, 5, directions=256)
    irradiance = np.maximum(lights.directions @ lights.directions.T, 0.0) @ lights.weights.T
    # A sum of 256 products of either order: rounding grows with its length at most.
    np.testing.assert_allclose(irradiance.max(axis=0), 1.0, rtol=256 * np.finfo(float).eps)


def test_mixed_images_have_an_ambient_part_and_differ() -> None:
    lights = mixed(12, 5)
    assert lights.weights.shape == (12, 512)
    assert (lights.weights > 0).all()
    spread = lights.weights / np.linalg.norm(lights.weights, axis=1, keepdims=True)
    assert (spread @ spread.T - np.eye(12)).max() < 0.999


def test_mixed_images_range_from_soft_light_to_hard() -> None:
    weights = mixed(50, 5).weights
    largest = (weights / weights.sum(axis=1, keepdims=True)).max(axis=1)
    assert largest.min() < 0.02
    assert largest.max() > 0.5


def test_mixed_directions_integrate_the_sphere() -> None:
    directions = mixed(1, 5).directions
    # Equal weights on the golden spiral: first and second moments to about 1 / J.
    assert np.abs(directions.mean(axis=0)).max() < 1 / 512
    assert np.abs(directions.T @ directions / 512 - np.eye(3) / 3).max() < 1 / 512


@pytest.mark.parametrize("make", [uniform_directional, mixed])
def test_the_same_seed_gives_the_same_lights(make) -> None:
    once, again, other = make(7, 11), make(7, np.random.default_rng(11)), make(7, 12)
    assert once.directions.tobytes() == again.directions.tobytes()
    assert once.weights.tobytes() == again.weights.tobytes()
    assert not np.array_equal(once.directions, other.directions)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"directions": np.ones((2, 2))}, "directions must have shape"),
        ({"directions": np.ones((2, 3))}, "directions must be unit"),
        ({"weights": np.ones((1, 3))}, "weights must have shape"),
        ({"weights": -np.ones((1, 2))}, "weights must be finite and non-negative"),
        ({"weights": np.full((1, 2), np.nan)}, "weights must be finite and non-negative"),
        ({"labels": ()}, "labels must name"),
        ({"subset": np.ones(2, int)}, "subset must have shape"),
    ],
)
def test_lights_refuse_nonsense(change: dict, complaint: str) -> None:
    sound = {
        "name": "two",
        "directions": np.eye(3)[:2],
        "weights": np.ones((1, 2)),
        "labels": ("both",),
    }
    Lights(**sound)
    with pytest.raises(ValueError, match=complaint):
        Lights(**(sound | change))


@pytest.mark.parametrize(
    ("call", "complaint"),
    [
        (lambda: uniform_directional(0, 1), "n must be at least 1"),
        (lambda: uniform_directional(1, 1, max_polar=0.0), "max_polar must be in"),
        (lambda: mixed(0, 1), "n must be at least 1"),
        (lambda: mixed(1, 1, directions=63), "directions must be at least 64"),
    ],
)
def test_makers_refuse_nonsense(call, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        call()
