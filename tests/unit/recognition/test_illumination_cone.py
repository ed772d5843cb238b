import numpy as np
import pytest
from scipy.optimize import nnls

from harmface.errors import ArgumentError
from harmface.recognition import (
    cone_distances,
    extreme_lights,
    lamp_images,
    low_dimensional_cone,
    scaled_normals,
)
from harmface.sphere import random_directions

PIXELS = 60


@pytest.fixture
def normals(rng):
    """Scaled normals of a surface that faces the viewer."""
    unit = random_directions(PIXELS, rng)
    unit[:, 2] = np.abs(unit[:, 2])
    return unit.T * rng.uniform(0.2, 1, PIXELS)


def test_rays_are_those_of_the_six_pairs_of_three_pixels():
    normals = np.array([[1.0, 0, 0], [0, 2, 0], [0, 0, 3]]).T
    lights = extreme_lights(normals, 6, 0)
    axes = np.eye(3)[[2, 1, 0]]
    assert np.allclose(np.abs(lights), np.repeat(axes, 2, axis=0))
    assert np.allclose(lights[::2], -lights[1::2])


def test_every_image_under_lamps_is_in_the_cone_of_all_rays(normals, rng):
    few = normals[:, :12]
    rays = lamp_images(few, extreme_lights(few, 12 * 11, 0))
    lamps = lamp_images(few, random_directions(20, rng))
    lamps = np.concatenate([lamps, rng.random((5, 20)) @ lamps])
    assert max(nnls(rays.T, image)[1] for image in lamps) < 1e-9
    beyond = few.T @ np.array([0.8, 0, -0.6])
    assert nnls(rays.T, beyond)[1] > 0.1


def test_parallel_normals_and_repeated_ones_give_no_further_rays(normals):
    once = extreme_lights(normals[:, :5], 1000, 0)
    again = np.concatenate([normals[:, :5], 2 * normals[:, :5], np.zeros((3, 4))], axis=1)
    assert len(once) == 20
    lights = extreme_lights(again, 1000, 0)
    assert len(lights) == 20
    assert {tuple(s) for s in once.round(9)} == {tuple(s) for s in lights.round(9)}


def test_rays_are_sampled_when_there_are_too_many(normals):
    one, same, other = (extreme_lights(normals, 30, seed) for seed in (1, 1, 2))
    assert one.shape == (30, 3)
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    images = lamp_images(normals, one)
    # Each lamp grazes two pixels, which face neither it nor its opposite.
    assert (np.abs(one @ normals) < 1e-12).sum(axis=1).min() >= 2
    assert images.min() >= 0


def test_visibility_casts_shadows(normals, rng):
    lights = extreme_lights(normals, 10, 0)
    visibility = rng.random((10, PIXELS)) < 0.5
    images = lamp_images(normals, lights, visibility)
    assert np.array_equal(images, np.where(visibility, lamp_images(normals, lights), 0))


def test_scaled_normals_are_found_up_to_a_linear_map(normals, rng):
    lights = random_directions(12, rng)
    lights[:, 2] = np.abs(lights[:, 2]) + 1.5
    images = np.maximum(lights @ normals, 0)
    found = scaled_normals(images)
    back = normals @ np.linalg.pinv(found)
    # A few pixels are lit by few of the lamps, and settle last.
    assert np.abs(back @ found - normals).max() < 2e-3
    plain = np.linalg.svd(images)[2][:3]
    assert np.abs(normals @ plain.T @ plain - normals).max() > 0.02


def test_distance_is_that_of_non_negative_least_squares(normals, rng):
    rays = lamp_images(normals, extreme_lights(normals, 40, 0))
    probes = rng.random((6, PIXELS)) + lamp_images(normals, random_directions(6, rng))
    cone = low_dimensional_cone(rays, PIXELS)
    expected = [nnls(rays.T, probe)[1] / np.linalg.norm(probe) for probe in probes]
    # The root of the search's tolerance, 1e-6.
    assert np.allclose(cone_distances(probes, *cone), expected, atol=1e-3)


def test_low_dimensions_hold_most_of_the_rays(normals):
    rays = lamp_images(normals, extreme_lights(normals, 200, 0))
    basis, inside = low_dimensional_cone(rays, 11)
    assert np.allclose(basis @ basis.T, np.eye(11))
    unit = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    assert np.allclose(inside, unit @ basis.T)
    # What GBK01 report for faces, and here of normals all over a hemisphere.
    assert (inside**2).sum() > 0.95 * len(rays)


def test_black_rays_are_left_out():
    basis, inside = low_dimensional_cone(np.array([[0.0, 0, 0], [0, 2, 0]]))
    assert np.allclose(np.abs(basis), [[0, 1, 0]])
    assert inside.shape == (1, 1)


FLAT = np.zeros((3, 5)) + np.array([[0.0], [0.0], [1.0]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: scaled_normals(np.ones((2, 5))), "at least 3 of a subject, got 2"),
        (lambda: scaled_normals(np.ones((4, 5))), "span three dimensions"),
        (lambda: scaled_normals(-np.ones((4, 5))), "must not be negative"),
        (lambda: scaled_normals(np.zeros((4, 5))), "all black"),
        (lambda: extreme_lights(FLAT, 10, 0), "span three dimensions"),
        (lambda: extreme_lights(np.eye(3), 1, 0), "count must be 2 or more"),
        (lambda: extreme_lights(np.full((3, 4), np.nan), 10, 0), "finite"),
        (lambda: extreme_lights(np.eye(3), 10, -1), "rng must be"),
        (lambda: low_dimensional_cone(np.zeros((3, 4))), "all be black"),
        (lambda: low_dimensional_cone(np.ones((3, 4)), 0), "dimension must be 1 or more"),
        (lambda: cone_distances(np.ones((1, 3)), np.ones((1, 4)), np.ones((2, 1))), "4 pixels"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
