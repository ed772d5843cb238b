"""The closed forms on images of point sources, and of their own degree."""

import numpy as np
import pytest

from harmface.rendering import harmonic_images
from harmface.stereo import angular_errors, factorize, without_convexity, without_lorentz
from harmface.stereo.harmonic import exact_second_order, first_order, second_order
from harmface.stereo.lorentz import METRIC, fit_null_cone


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def error(b, scene):
    normals = unit(b)
    return angular_errors(without_convexity(normals, scene.normals), scene.normals).mean()


@pytest.fixture(scope="module")
def closed(ball, single_lights):
    """One point source an image, and both closed forms."""
    space = factorize(ball.images(single_lights, np.eye(len(single_lights))), 9)
    rng = np.random.default_rng(0)
    first = first_order(space.structure[:4], ball.mask, noise=space.noise, rng=rng)
    second = second_order(space.structure, ball.mask, first, noise=space.noise)
    return space.structure, first, second


def test_degree_one_images_give_the_surface(hills, rng):
    light = rng.standard_normal((10, 4)) + 4 * np.eye(4)[0]
    images = light @ harmonic_images(hills.normals, hills.albedo, 1)
    space = factorize(images, 4)
    found = first_order(space.structure, hills.mask, noise=space.noise, rng=rng)
    assert found.signature_held
    # Differences over cells err by 0.8 % on the shortest wave; the group is six numbers.
    assert error(found.b, hills) < 2
    assert np.std(np.log(np.linalg.norm(found.b, axis=1) / hills.albedo)) < 0.03
    # Its rows are those of a Lorentz transformation of null vectors.
    rows = found.gauge.rows
    assert np.allclose(rows @ -METRIC @ rows.T, np.eye(3), atol=1e-9)
    null = ((found.numbers @ METRIC) * found.numbers).sum(axis=1)
    assert np.abs(null).max() < 1e-9 * np.max(found.numbers**2)
    assert np.allclose(found.numbers @ rows.T, found.b)
    # The quadric is taken as it is if it is known: it may be better than that of means.
    cone = fit_null_cone(space.structure * np.array([[1.0], [1], [1], [1.2]]))
    other = first_order(space.structure, hills.mask, noise=space.noise, rng=rng, cone=cone)
    assert np.allclose(other.numbers, (cone.frame @ space.structure).T)


def test_first_and_second_order_under_point_sources(ball, closed):
    structure, first, second = closed
    assert error(first.b, ball) < 12
    assert error(second.b, ball) < 6
    # Linear in the images' dimensions, and refining nothing.
    for dimensions, found in ((4, first), (9, second)):
        used = structure[:dimensions].T
        rows = np.linalg.lstsq(used, found.b, rcond=None)[0]
        assert np.allclose(used @ rows, found.b)


def test_only_exact_structure_is_taken_for_exact(ball, closed, rng, monkeypatch):
    monkeypatch.setattr("harmface.stereo.harmonic.ITERATIONS", 20)
    structure, first, _ = closed
    assert exact_second_order(structure, structure, ball.mask, first, rng) is None


def test_exact_structure_is_known_but_for_a_lorentz_transformation(ball, rng, closed):
    light = rng.standard_normal((24, 9)) + 8 * np.eye(9)[0]
    images = light @ harmonic_images(ball.normals, ball.albedo, 2)
    structure = factorize(images, 9).structure
    _, first, _ = closed
    exact = exact_second_order(structure, structure, ball.mask, first, rng)
    assert angular_errors(without_lorentz(unit(exact.b), ball.normals), ball.normals).max() < 1e-4
    # Cues choose it, of a surface of 40 pixels with texture: rather that than none.
    assert error(exact.b, ball) < 8
