"""Points of an image, and a gradient of the light all around, no more than it needs."""

import numpy as np
import pytest

from harmface.stereo.fewest_points import fewest_points
from harmface.stereo.light_models import PointLights

MODEL = PointLights(4, ambient=True)
SOURCES = np.array([[0.8, 0.3, 0.5], [-0.4, -0.6, 0.7]])


@pytest.fixture
def split():
    """Two points and uniform light; of one point two halves, and a faint fourth."""
    aside = np.array([0.05, -0.05, 0.0])
    points = [SOURCES[0] / 2 + aside, SOURCES[1], SOURCES[0] / 2 - aside, [0.0, 0.01, 0.01]]
    return np.array([[*np.ravel(points), 0, 0, 0, 0.3]])


@pytest.fixture
def images(ball, rng):
    light = np.array([[*SOURCES.ravel(), 0, 0, 0, 0.3]])
    exact = PointLights(2, ambient=True).predict(light, ball.b)
    return exact + 0.005 * rng.standard_normal(exact.shape)


def points_on(light):
    points = MODEL.points(light)[0]
    return points[(points != 0).any(axis=1)]


def test_points_that_there_are_remain(ball, images, split):
    weights = np.ones(images.shape)
    light = fewest_points(images, MODEL, split, ball.b, weights, 20 * 0.005**2)
    found = points_on(light)
    assert len(found) == 2
    for source in SOURCES:
        assert np.linalg.norm(found - source, axis=1).min() < 0.01
    assert abs(light[0, -1] - 0.3) < 0.01
    assert not MODEL.gradient(light).any()


def test_halves_are_joined_though_a_needed_point_is_weaker(ball, rng):
    faint = 0.2 * SOURCES[1]
    true = np.array([[*SOURCES[0], *faint, 0, 0, 0, 0.3]])
    exact = PointLights(2, ambient=True).predict(true, ball.b)
    images = exact + 0.005 * rng.standard_normal(exact.shape)
    halves = [SOURCES[0] / 2, faint, SOURCES[0] / 2 + [0.0, 0.02, 0.0], np.zeros(3)]
    light = np.array([[*np.ravel(halves), 0, 0, 0, 0.3]])
    light = fewest_points(images, MODEL, light, ball.b, np.ones(images.shape), 20 * 0.005**2)
    assert len(points_on(light)) == 2
    assert np.linalg.norm(points_on(light) - faint, axis=1).min() < 0.01


def test_what_costs_more_than_its_price_stays(ball, images, split):
    MODEL.gradient(split)[:] = 0.01
    energy = ((images - MODEL.predict(split, ball.b)) ** 2).sum()
    kept = fewest_points(images, MODEL, split, ball.b, np.ones(images.shape), -energy)
    assert np.array_equal(kept, split)


def test_at_an_infinite_price_even_light_remains(ball, images, split):
    light = fewest_points(images, MODEL, split, ball.b, np.ones(images.shape), np.inf)
    assert not light[:, :-1].any()
    # The closed form of one unknown.
    even = images @ ball.albedo / (ball.albedo @ ball.albedo)
    assert np.allclose(light[:, -1], even)


def test_a_gradient_stays_where_it_is_needed(ball, rng):
    """A sky and a lamp, and points that say what the sky does."""
    sky = np.array([[*SOURCES[0], *np.zeros(9), 0.0, 0.3, 0.1, 0.5]])
    exact = MODEL.predict(sky, ball.b)
    images = exact + 0.005 * rng.standard_normal(exact.shape)
    start = sky + 0.05 * rng.standard_normal(sky.shape)
    found = fewest_points(images, MODEL, start, ball.b, np.ones(images.shape), 20 * 0.005**2)
    assert len(points_on(found)) == 1
    assert np.abs(MODEL.gradient(found) - MODEL.gradient(sky)).max() < 0.01


def test_images_do_not_mix(ball, images, split):
    weights = np.ones(images.shape)
    alone = fewest_points(images, MODEL, split, ball.b, weights, 20 * 0.005**2)
    other = np.array([[*np.roll(split[0, :12], 3), 0, 0, 0, 0.1]])
    pair = np.concatenate([images, 0.5 * images])
    both = fewest_points(
        pair, MODEL, np.concatenate([split, other]), ball.b, np.ones(pair.shape), 20 * 0.005**2
    )
    assert np.allclose(both[0], alone[0], atol=1e-12)
