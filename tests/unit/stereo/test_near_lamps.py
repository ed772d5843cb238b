"""Lamps near a sphere and a relief."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import angular_errors, image_stack, photometric_stereo
from harmface.stereo.lamp_strengths import strengths_by_elimination
from harmface.stereo.near_lamps import fit_near_lamps, lamp_vectors
from tests.unit.stereo.near_scene import LAMPS, lamps_around, relief, sphere


@pytest.fixture(scope="module", params=[sphere, relief])
def scene(request):
    return request.param()


@pytest.fixture(scope="module")
def positions():
    return lamps_around()


@pytest.mark.parametrize("told", [True, False], ids=["strengths given", "strengths estimated"])
def test_near_lamps_are_not_distant(scene, positions, told, rng):
    strengths = np.exp(0.4 * rng.standard_normal(LAMPS))
    images = scene.photographs(positions, strengths, rng)
    given = strengths if told else None

    def found(**lamps):
        result = photometric_stereo(
            images, scene.mask, method="known-lights", strengths=given, **lamps
        )
        return result, angular_errors(result.normals[scene.mask], scene.normals)

    near, error = found(positions=positions)
    distance = np.linalg.norm(positions, axis=1, keepdims=True)
    _, distant_error = found(light=positions / distance)
    # Half a percent of noise, and the grid at the rim; treated as distant they bend the surface.
    assert error.mean() < 0.8
    assert distant_error.mean() > 12
    assert near.report.converged
    assert near.report.light_model == "near points"
    assert near.report.strengths == pytest.approx(strengths / strengths.mean(), rel=0.01)
    assert np.median(error) / 2 < near.report.noise_error < 2 * np.median(error)


def test_depth_is_in_widths_of_the_object(scene, positions, rng):
    images = scene.photographs(positions, np.ones(LAMPS), rng)
    fit = fit_near_lamps(image_stack(images, scene.mask), positions)
    assert np.abs(fit.depth - scene.points[:, 2]).mean() < 0.005


def test_shadows_and_highlights_are_left_out(scene, positions, rng):
    images = scene.photographs(positions, np.ones(LAMPS), rng)
    draw = rng.random(images.shape)
    images[draw < 0.05] += images.max()
    images[draw > 0.95] *= 0.1
    images = np.where(scene.mask, images, 0)
    found = photometric_stereo(images, scene.mask, method="known-lights", positions=positions)
    # At the rim a few lamps are left, and outliers among them win now and then.
    assert np.median(angular_errors(found.normals[scene.mask], scene.normals)) < 0.7


def test_lamps_far_away_are_distant_and_that_is_said(scene, positions, rng):
    far, equal = 1000 * positions, np.ones(LAMPS)
    images = scene.photographs(far, equal, rng)
    directions = positions / np.linalg.norm(positions, axis=1, keepdims=True)
    near, distant = (
        photometric_stereo(images, scene.mask, method="known-lights", strengths=equal, **lamps)
        for lamps in ({"positions": far}, {"light": directions})
    )
    between = angular_errors(near.normals[scene.mask], distant.normals[scene.mask])
    # A corner, 0.7 widths off, sees lamps 1600 widths away 0.025 degrees off.
    assert np.median(between) < 0.05
    assert any("more than 30 of the object's widths away" in each for each in near.report.warnings)


def test_the_light_of_a_lamp_falls_with_the_square_of_its_distance():
    vectors = lamp_vectors(
        np.array([[0.0, 0.0, 2.0]]), np.array([[0, 0, 0], [0, 0, 1.0], [0, 2, 2]])
    )
    assert np.allclose(vectors[0], [[0, 0, 1], [0, 0, 4], [0, -1, 0]])


def test_strengths_are_found_whatever_the_noise_of_dim_lamps(rng):
    lamps = np.array([[0.5, 0, 0.9], [-0.5, 0, 0.9], [0, 0.5, 0.9], [0, -0.5, 0.9], [0, 0, 1]] * 2)
    strengths = np.exp(0.8 * rng.standard_normal(10))
    b = np.array([0, 0, 0.8]) + 0.15 * rng.standard_normal((4000, 3))
    values = strengths[:, None] * (lamps @ b.T) + 0.02 * rng.standard_normal((10, 4000))
    vectors = np.broadcast_to(lamps[:, None], (10, 4000, 3))
    found = strengths_by_elimination(values, vectors, np.ones(values.shape))
    assert found == pytest.approx(strengths / strengths.mean(), rel=0.01)
    # The same signs as of light from behind: no lamp of positive strength does that.
    with pytest.raises(ArgumentError, match="no positive strengths"):
        values[3] *= -1
        strengths_by_elimination(values, vectors, np.ones(values.shape))
    with pytest.raises(ArgumentError, match="light some of the object"):
        weights = np.ones(values.shape)
        weights[2] = 0
        strengths_by_elimination(values, vectors, weights)


def test_three_lamps_count_as_equal(scene, positions, rng):
    some = positions[[0, 5, 10]] + np.array([[0.5, 0, 0], [-0.5, 0.5, 0], [0, -0.5, 0]])
    images = scene.photographs(some, np.ones(3), rng)
    found = photometric_stereo(images, scene.mask, method="known-lights", positions=some)
    assert any("taken as equal" in each for each in found.report.warnings)


@pytest.mark.usefixtures("unchecked")
def test_impossible_lamps_are_refused(scene, positions, rng):
    images = scene.photographs(positions, np.ones(LAMPS), rng)

    def refused(match, **arguments):
        with pytest.raises(ArgumentError, match=match):
            photometric_stereo(images, scene.mask, **{"method": "known-lights", **arguments})

    within = positions.copy()
    within[3] *= 0.1
    flat = positions * (1, 0, 1)
    directions = positions / np.linalg.norm(positions, axis=1, keepdims=True)
    refused("is 0.16 from it, within the object", positions=within)
    refused("in one plane", positions=flat)
    refused("one for each of the 16 images", positions=positions[:5])
    refused("must be finite", positions=positions * np.nan)
    refused("with both of them", positions=positions, light=directions)
    refused("with one of them", positions=positions, method="refined")
    refused("serves distant light only", positions=positions, smoothness=1.0)
    refused("strengths must be one for each of the 16", positions=positions, strengths=np.ones(3))
    refused("strengths must not be negative", positions=positions, strengths=-np.ones(LAMPS))
