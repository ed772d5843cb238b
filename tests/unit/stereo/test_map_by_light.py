"""The linear map and the albedo of harmonic structure, as light from points gives them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import spearmanr

from harmface.rendering import harmonic_images
from harmface.stereo import angular_errors, factorize, image_stack, refine
from harmface.stereo.cues import Knowledge, outline_of
from harmface.stereo.exact_second_order import exact_second_order
from harmface.stereo.linear_map import nearest_linear_map
from harmface.stereo.map_by_light import settled_by_light
from harmface.stereo.refinement import FIRST_IMAGES

SHEARED = np.array([[1.1, 0.05, 0.1], [0.0, 0.9, -0.1], [0.05, 0.0, 1.2]])


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


@pytest.mark.parametrize(("dimensions", "most", "albedo_most"), [(4, 2.0, 0.1), (9, 0.5, 0.05)])
def test_points_choose_the_map_and_the_albedo(
    ball, single_lights, rng, dimensions, most, albedo_most
):
    images = ball.images(single_lights, np.eye(len(single_lights)))
    structure = factorize(images, dimensions).structure
    # What the second order leaves open: a linear map, and albedo that depends on the normal.
    off = ball.b @ SHEARED.T * (0.8 + 0.3 * ball.normals[:, 2:])
    assert angular_errors(unit(off), ball.normals).mean() > 5
    known = Knowledge(outline_of(ball.mask))
    found = settled_by_light(ball.stack(images), structure, off, known, rng)
    assert found.fit.model.count == 1
    assert len(found.fit.light) == len(images)
    b = found.scaled_normals(structure)
    assert angular_errors(unit(b), ball.normals).mean() < most
    albedo = np.linalg.norm(b, axis=1) / ball.albedo
    assert np.std(np.log(albedo)) < albedo_most
    # Without noise, what the dimensions left out bend is all that is wrong.
    errors = angular_errors(unit(b), ball.normals)
    assert spearmanr(found.truncation_error, errors).statistic > 0.7
    assert found.truncation_error.mean() == pytest.approx(errors.mean(), rel=0.3)


def test_a_few_images_settle_the_light_of_all(ball, several_sources, rng):
    structure = factorize(several_sources, 9).structure
    known = Knowledge(outline_of(ball.mask))
    found = settled_by_light(ball.stack(several_sources), structure, ball.b, known, rng)
    assert found.fit.model.count > 1
    assert FIRST_IMAGES < len(found.fit.light) == len(several_sources)
    b = found.scaled_normals(structure)
    assert angular_errors(unit(b), ball.normals).mean() < 2


def test_harmonics_keep_what_they_explain(ball, rng):
    light = rng.standard_normal((24, 9)) + 8 * np.eye(9)[0]
    images = light @ harmonic_images(ball.normals, ball.albedo, 2)
    structure = factorize(images, 9).structure
    assert settled_by_light(ball.stack(images), structure, ball.b, Knowledge(), rng) is None


def test_points_that_explain_less_than_harmonics_are_not_asked(
    ball, single_lights, rng, monkeypatch
):
    images = ball.images(single_lights, np.eye(len(single_lights)))
    structure = factorize(images, 9).structure

    def astray(*args, **options):
        fit = refine(*args, **options)
        return replace(fit, light=0.5 * fit.light)

    monkeypatch.setattr("harmface.stereo.map_by_light.refine", astray)
    assert settled_by_light(ball.stack(images), structure, ball.b, Knowledge(), rng) is None


def test_only_exact_structure_is_taken_for_exact(ball, single_lights, rng):
    images = ball.images(single_lights, np.eye(len(single_lights)))
    structure = factorize(images, 9).structure
    assert exact_second_order(structure, structure, ball.mask, [ball.b], Knowledge(), rng) is None


def test_no_light_is_no_albedo(ball, single_lights, rng):
    images = ball.images(single_lights, np.eye(len(single_lights)))
    images[:, :5] = 0
    structure = factorize(images, 9).structure
    stack = image_stack(ball.pictures(images), ball.mask)
    found = settled_by_light(stack, structure, ball.b, Knowledge(outline_of(ball.mask)), rng)
    b = found.scaled_normals(structure)
    assert np.isfinite(b).all()
    assert np.abs(b[:5]).max() < 1e-6


@pytest.mark.parametrize("size", [3, 9])
def test_the_nearest_map_is_the_one_that_made_the_normals(ball, rng, size):
    """Lengths do not count, and neither does the sign of the structure."""
    mixing = rng.standard_normal((size, size))
    inside = np.concatenate([ball.b, rng.standard_normal((len(ball.b), size - 3))], axis=1)
    structure = (inside @ mixing.T) * -rng.uniform(0.5, 2, (len(inside), 1))
    rows = nearest_linear_map(structure, ball.normals)
    # Acute on average, so a structure of the other sign comes back turned.
    assert angular_errors(unit(structure @ rows.T), ball.normals).max() < 1e-4
    expected = np.linalg.inv(mixing)[:3]
    share = rows.ravel() @ expected.ravel()
    share /= np.linalg.norm(rows) * np.linalg.norm(expected)
    assert abs(abs(share) - 1) < 1e-9


def test_no_other_map_comes_nearer(ball, rng):
    """Nearer in the mean square of sines, whatever the lengths."""
    structure = ball.b @ SHEARED.T + 0.05 * rng.standard_normal(ball.b.shape)
    structure *= rng.uniform(0.2, 2, (len(structure), 1))

    def sines(rows):
        cosines = (unit(structure @ rows.T) * ball.normals).sum(axis=1)
        return float(np.mean(1 - cosines**2))

    rows = nearest_linear_map(structure, ball.normals)
    tried = rows + 0.003 * np.linalg.norm(rows) * rng.standard_normal((50, 3, 3))
    assert sines(rows) < min(sines(other) for other in tried)
