"""Non-negative light against light that is known."""

import numpy as np
import pytest
from scipy.optimize import nnls

from harmface.stereo.light_models import PointLights
from harmface.stereo.non_negative import (
    UNSEEN,
    best_point,
    dense_light,
    fit_dense_light,
    points_of,
)
from harmface.stereo.per_image import fit_light


@pytest.fixture
def three_sources():
    """Light from one direction of 100 in each of three images, and uniform light."""
    model = dense_light(100)
    light = np.zeros((3, 101))
    facing = np.flatnonzero(model.directions[:, 2] > 0.3)[[0, 9, 20]]
    light[np.arange(3), facing] = 1.0
    light[:, -1] = 0.2
    return model, light, model.directions[facing]


@pytest.mark.parametrize("weighted", [False, True])
def test_dense_light_finds_its_own(ball, three_sources, weighted, rng):
    model, light, _ = three_sources
    images = model.predict(light, ball.b)
    weights = rng.uniform(0.2, 1, images.shape) if weighted else None
    assert np.abs(fit_dense_light(images, model, ball.b, weights=weights) - light).max() < 1e-3


def test_dense_light_is_the_best_without_negative_parts(ball, rng):
    """Karush-Kuhn-Tucker: no slope where there is light, none downwards where there is not."""
    model = dense_light(100)
    images = rng.uniform(0, 1, (2, len(ball.b)))
    weights = rng.uniform(0.2, 1, images.shape)
    columns = model.columns(ball.b)
    size = np.linalg.norm(columns, axis=1)
    size = np.maximum(size, UNSEEN * size.max())
    for price in (0.0, 2.0):
        light = fit_dense_light(images, model, ball.b, weights=weights, price=price)
        assert (light >= 0).all()
        slope = (weights * (model.predict(light, ball.b) - images)) @ columns.T / size
        slope[:, :-1] += price
        assert np.abs(slope[light > 0]).max() < 1e-6
        assert slope.min() > -1e-6


def test_a_price_leaves_fewer_directions(ball, three_sources, rng):
    model, light, _ = three_sources
    images = model.predict(light, ball.b) + 0.02 * rng.standard_normal((3, len(ball.b)))
    free = fit_dense_light(images, model, ball.b)
    priced = fit_dense_light(images, model, ball.b, price=4 * 0.02)
    assert (priced[:, :-1] > 0).sum() < (free[:, :-1] > 0).sum() / 2
    assert np.abs(priced[:, -1] - 0.2).max() < 0.05


@pytest.mark.parametrize("weighted", [False, True])
def test_a_gradient_besides_is_eliminated(ball, three_sources, weighted, rng):
    """The result is the same whatever g . b is added, and leaves nothing but such an image."""
    model, light, _ = three_sources
    images = model.predict(light, ball.b)
    changing = images + np.array([0.4, -0.3, 0.2]) @ ball.b.T
    weights = rng.uniform(0.2, 1, images.shape) if weighted else None

    def found(values, price):
        return fit_dense_light(values, model, ball.b, weights=weights, price=price, gradient=True)

    assert np.allclose(found(changing, 0.02), found(images, 0.02))
    left = changing - model.predict(found(changing, 0.0), ball.b)
    slope = np.linalg.lstsq(ball.b, left.T, rcond=None)[0].T
    assert np.abs(left - slope @ ball.b.T).max() < 1e-3
    assert np.abs(left).max() > 0.1


def test_points_gather_what_lies_together(ball, three_sources):
    model, light, sources = three_sources
    points = points_of(light, model, ball.b, 2)
    assert np.allclose(points[:, :3], sources)
    assert np.allclose(points[:, 3:], [0, 0, 0, 0, 0, 0, 0.2])


def test_points_between_directions_are_explained_by_those_around(ball):
    """Points to spare make up for clusters of directions that hardly light anything."""
    dense = dense_light(400)
    between = np.array([[0.5, 0.1, 0.8, -0.6, 0.3, 0.7, 0, 0, 0, 0.3]])
    images = PointLights(2, ambient=True).predict(between, ball.b)
    start = points_of(fit_dense_light(images, dense, ball.b, price=0.03), dense, ball.b, 4)
    model = PointLights(4, ambient=True)
    _, energy = fit_light(images, model, start, ball.b, np.ones(images.shape))
    assert np.sqrt(energy[0] / images.size) < 1e-3


def test_the_best_point_is_that_of_all_directions_tried(ball, rng):
    model = dense_light(60)
    made = model.columns(ball.b)[[3, 30, 50, 8]] + 0.5 * model.columns(ball.b)[[17, 31, 2, 40]]
    # Uniform light beside what would be brightest in the last image would have to be negative.
    images = np.vstack([made + 0.1 * rng.random(made.shape), made[:1] ** 3])
    weights = rng.integers(0, 2, images.shape).astype(float)
    found = best_point(images, model, ball.b, weights)
    columns = model.columns(ball.b)
    for image, weight, light in zip(images, weights, found, strict=True):
        root = np.sqrt(weight)
        tried = [nnls((columns[[j, -1]] * root).T, image * root) for j in range(60)]
        best = int(np.argmin([left for _, left in tried]))
        point, uniform = tried[best][0]
        assert np.allclose(light, [*point * model.directions[best], 0, 0, 0, uniform])


def test_no_light_is_no_point(ball):
    model = dense_light(100)
    assert np.array_equal(points_of(np.zeros((1, 101)), model, ball.b, 2), np.zeros((1, 10)))


def test_light_of_each_image_settles_from_nearby(ball, rng):
    model = PointLights(2, ambient=True)
    light = np.array(
        [[0.5, 0.1, 0.8, -0.6, 0.3, 0.7, 0.1, 0, 0.2, 0.3], [0.2, -0.5, 0.8, 0, 0, 0, 0, 0, 0, 0.1]]
    )
    images = model.predict(light, ball.b)
    weights = rng.uniform(0.5, 1, images.shape)
    start = light + 0.1 * (light != 0) * rng.standard_normal(light.shape)
    found, energy = fit_light(images, model, start, ball.b, weights)
    assert np.abs(found - light).max() < 1e-6
    assert energy.max() < 1e-9
    outlier = np.zeros(images.shape)
    outlier[:, ::5] = 2
    weights[:, ::5] = 0
    found, _ = fit_light(images + outlier, model, start, ball.b, weights)
    assert np.abs(found - light).max() < 1e-6
