"""The first-order, second-order and refined methods on images that the renderer made."""

from dataclasses import replace

import numpy as np
import pytest

from harmface.rendering import harmonic_images
from harmface.sphere import fibonacci_directions
from harmface.stereo import (
    angular_errors,
    factorize,
    first_order,
    image_stack,
    refine,
    second_order,
    without_convexity,
    without_linear_map,
)
from harmface.stereo.cues import NOTHING, Knowledge, outline_of
from harmface.stereo.light_models import HarmonicLight, PointLights
from harmface.stereo.many_sources import MODEL, points_again
from harmface.stereo.refinement import FIRST_IMAGES


def error(b, scene):
    normals = b / np.linalg.norm(b, axis=1, keepdims=True)
    return angular_errors(without_convexity(normals, scene.normals), scene.normals).mean()


@pytest.fixture(scope="module")
def lit_ball(ball, single_lights):
    """One point source an image."""
    return ball.images(single_lights, np.eye(len(single_lights)))


def test_degree_one_images_give_the_surface(hills, rng):
    light = rng.standard_normal((10, 4)) + 4 * np.eye(4)[0]
    images = light @ harmonic_images(hills.normals, hills.albedo, 1)
    found = first_order(factorize(images, 4).structure, hills.mask)
    assert found.cone.signature_held
    # Differences over cells err by 0.8 % on the shortest wave; the group is six numbers.
    assert error(found.b, hills) < 2


def test_first_and_second_order_under_point_sources(ball, lit_ball):
    structure = factorize(lit_ball, 9).structure
    outline = outline_of(ball.mask)
    first = first_order(structure[:4], ball.mask, Knowledge(outline))
    second = second_order(structure, ball.mask, first.b, Knowledge(outline))
    assert error(first.b, ball) < 12
    assert error(second.b, ball) < 6
    # The outline tells convex from concave.
    normals = second.b / np.linalg.norm(second.b, axis=1, keepdims=True)
    assert angular_errors(normals, ball.normals).mean() < 6


def test_point_sources_are_refined(ball, lit_ball, rng):
    images = lit_ball + 0.002 * np.abs(rng.standard_normal(lit_ball.shape))
    start = ball.b + 0.1 * rng.standard_normal(ball.b.shape)
    found = refine(ball.stack(images), start, Knowledge(outline_of(ball.mask)))
    assert found.model == PointLights(1, ambient=False)
    assert (np.diff(found.energies) < 0).all()
    assert error(found.b, ball) < 1.5
    predicted = found.model.predict(found.light, found.structure.T)
    assert np.sqrt(np.mean((predicted - images) ** 2)) < 0.01


def test_single_sources_without_noise_leave_the_differences_own_error(ball, lit_ball, rng):
    start = ball.b + 0.1 * rng.standard_normal(ball.b.shape)
    found = refine(ball.stack(lit_ball), start, Knowledge(outline_of(ball.mask)))
    structure = found.structure.T
    linear = without_linear_map(structure, ball.normals)
    assert angular_errors(linear, ball.normals).max() < 1e-3
    # Derivatives over the cells of a picture of 40 pixels.
    assert error(found.b, ball) < 0.6


def test_highlights_and_cast_shadows_do_not_count(ball, lit_ball, single_lights, rng):
    halfway = single_lights + np.array([0, 0, 1])
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    shiny = lit_ball + 0.3 * np.maximum(halfway @ ball.normals.T, 0) ** 20 * (lit_ball > 0)
    shiny[rng.random(shiny.shape) < 0.1] = 0
    start = ball.b + 0.1 * rng.standard_normal(ball.b.shape)
    found = refine(ball.stack(shiny), start, Knowledge(outline_of(ball.mask)))
    assert found.model == PointLights(1, ambient=False)
    assert error(found.b, ball) < 1.5


def test_several_sources_are_not_taken_for_one(ball, several_sources, rng):
    start = ball.b + 0.05 * rng.standard_normal(ball.b.shape)
    known = Knowledge(outline_of(ball.mask))
    found = refine(ball.stack(several_sources), start, known, pixels=200)
    assert found.model == PointLights(MODEL.count, ambient=True)
    on = (found.model.points(found.light) != 0).any(axis=2).sum(axis=1)
    assert np.median(on) == 2
    assert error(found.b, ball) < 1


def test_light_all_around_may_be_brighter_above(ball, several_sources):
    """Taken for uniform, it takes four points to explain it, which shear the surface."""
    known = Knowledge(outline_of(ball.mask))
    images = several_sources + np.array([0.1, 0.25, 0.1]) @ ball.b.T
    errors = []
    for seed in range(3):
        found = refine(ball.stack(images), ball.b, known, pixels=200, rng=seed)
        on = (found.model.points(found.light) != 0).any(axis=2).sum(axis=1)
        assert np.median(on) == 2
        assert found.model.gradient(found.light).any(axis=1).mean() > 0.8
        errors.append(error(found.b, ball))
    # The pixels drawn make it 1 to 3.
    assert np.median(errors) < 3


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_sheared_start_does_not_shear_the_light(ball, several_sources, seed):
    known = Knowledge(outline_of(ball.mask))
    sheared = ball.b @ np.transpose([[1, 0, 0], [0, 1, 0], [0.3, -0.2, 0.8]])
    found = refine(ball.stack(several_sources), sheared, known, pixels=200, rng=seed)
    assert error(found.b, ball) < 1


def test_all_images_mend_what_too_few_left_sheared(ball, several_sources, monkeypatch):
    monkeypatch.setattr("harmface.stereo.refinement.FIRST_IMAGES", 8)
    known = Knowledge(outline_of(ball.mask))
    sheared = ball.b @ np.transpose([[1, 0, 0], [0, 1, 0], [0.3, -0.2, 0.8]])
    found = refine(ball.stack(several_sources), sheared, known, pixels=200, rng=4)
    assert error(found.b, ball) < 1


def test_points_found_anew_are_kept_only_if_they_explain_more(ball, several_sources, monkeypatch):
    def astray(*args, gradient):
        fit = points_again(*args, gradient=gradient)
        return replace(fit, light=fit.light[::-1])

    # No more than are searched first: others would follow, and mend it.
    stack, known = ball.stack(several_sources[:FIRST_IMAGES]), Knowledge(outline_of(ball.mask))
    residual = refine(stack, ball.b, known, pixels=200).residual
    monkeypatch.setattr("harmface.stereo.refinement.points_again", astray)
    found = refine(stack, ball.b, known, pixels=200)
    assert found.residual < 1.1 * residual


def test_clipped_observations_of_several_sources_do_not_count(ball, several_sources, rng):
    level = np.percentile(several_sources, 85)
    clipped = ball.pictures(np.minimum(several_sources, level))
    start = ball.b + 0.05 * rng.standard_normal(ball.b.shape)
    known = Knowledge(outline_of(ball.mask))
    errors = []
    for saturated in (None, clipped >= level):
        stack = image_stack(clipped, ball.mask, saturated=saturated)
        structure = refine(stack, start, known, pixels=150).structure
        left = without_linear_map(structure[-3:].T, ball.normals)
        errors.append(angular_errors(left, ball.normals).mean())
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_flash_in_a_lit_room_is_one_point(ball, single_lights, seed):
    rng = np.random.default_rng(seed)
    images = np.maximum(single_lights @ ball.b.T, 0) + 0.1 * ball.albedo
    images *= 1 + 0.01 * rng.standard_normal(images.shape)
    start = ball.b + 0.05 * rng.standard_normal(ball.b.shape)
    known = Knowledge(outline_of(ball.mask))
    found = refine(ball.stack(images), start, known, pixels=200)
    assert found.model == PointLights(1, ambient=True)
    assert error(found.b, ball) < 1


def test_a_start_gone_astray_is_left_for_the_leading_dimensions(hills, rng):
    """On a relief they nearly span the scaled normals, whatever the start says."""
    sky = fibonacci_directions(80)
    weights = np.eye(80)[:32] + 0.7 * np.eye(80)[rng.permutation(45)[:32]]
    images = hills.images(sky, weights) + 0.3 * hills.albedo
    astray = rng.standard_normal(hills.b.shape) * 0.5 + (0, 0, 1)
    found = refine(hills.stack(images), astray, NOTHING)
    left = without_linear_map(found.structure.T, hills.normals)
    assert angular_errors(left, hills.normals).mean() < 1


def test_smooth_light_is_refined_as_harmonic(ball, rng):
    sky = fibonacci_directions(300)
    axes = fibonacci_directions(16)
    weights = np.exp(2 * axes @ sky.T + 0.5 * rng.standard_normal((16, 1))) / 300
    images = ball.images(sky, weights)
    start = ball.b + 0.05 * rng.standard_normal(ball.b.shape)
    found = refine(ball.stack(images), start, Knowledge(outline_of(ball.mask)))
    assert found.model == HarmonicLight(2)
    assert error(found.b, ball) < 1
    # Albedo comes back but for one scale: a few percent, as the light has some degree 4.
    ratio = np.linalg.norm(found.b, axis=1) / ball.albedo
    assert np.std(ratio / ratio.mean()) < 0.05


def test_same_seed_same_bytes(ball, lit_ball):
    structure = factorize(lit_ball, 4).structure
    results = [first_order(structure, ball.mask, rng=7).b for _ in range(2)]
    assert np.array_equal(*results)
