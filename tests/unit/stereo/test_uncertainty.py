"""Told errors against the spread of repeated draws."""

import numpy as np
import pytest
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation
from scipy.stats import spearmanr

from harmface.stereo import angular_errors
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.known_lights import normals_from_directions
from harmface.stereo.light_models import PointLights
from harmface.stereo.per_pixel import fit_normals
from harmface.stereo.uncertainty import (
    beside_neighbours,
    confidence_of,
    map_error,
    noise_error,
    smoothed_noise,
)
from tests.unit.stereo.conftest import bas_relief

CONCAVE = np.diag([-1.0, -1.0, 1.0])


def test_noise_error_is_the_spread_of_repeated_fits(ball, single_lights):
    rng = np.random.default_rng(1)
    b = np.repeat(ball.b[500:501], 2000, axis=0)
    model = PointLights(1, ambient=False)
    images = model.predict(single_lights, b) + 0.01 * rng.standard_normal((24, 2000))
    found = fit_normals(images, model, single_lights, b)
    truth = np.repeat(ball.normals[500:501], 2000, axis=0)
    spread = np.sqrt(
        (angular_errors(found / np.linalg.norm(found, axis=1, keepdims=True), truth) ** 2).mean()
    )
    told = np.sqrt(
        (noise_error(images, model, single_lights, found, np.ones(images.shape)) ** 2).mean()
    )
    # 2000 draws know a root mean square to 1.6 %; dark observations carry noise but no slope, and
    # so do not enter the covariance.
    assert abs(told / spread - 1) < 0.1


@pytest.mark.parametrize("spread", [3.0, 6.0])
def test_neighbours_show_which_normals_noise_has_moved(hills, rng, spread):
    noise = np.full(len(hills.normals), spread)
    moved = directions_of(
        hills.normals + np.radians(spread / np.sqrt(2)) * rng.standard_normal(hills.normals.shape)
    )
    errors = angular_errors(moved, hills.normals)
    told = beside_neighbours(moved, hills.mask, noise)
    # Within the border four lines foretell a normal, with 0.94 / 4 of its variance: no more can be
    # told than draws of two components tell with such draws added.
    inner = binary_erosion(hills.mask, np.ones((5, 5)))[hills.mask]
    own, beside = rng.standard_normal((2, 20_000, 2))
    beside *= np.sqrt(0.94 / 4)
    best = spearmanr(np.linalg.norm(own, axis=1), np.linalg.norm(own + beside, axis=1)).statistic
    assert spearmanr(told[inner], errors[inner]).statistic == pytest.approx(best, abs=0.05)
    assert np.sqrt((told**2).mean()) == pytest.approx(np.sqrt((errors**2).mean()), rel=0.1)


def test_rough_surfaces_do_not_pass_for_noise(ball, rng):
    rough = directions_of(ball.normals + 0.1 * rng.standard_normal(ball.normals.shape))
    told = beside_neighbours(rough, ball.mask, np.full(len(rough), 0.2))
    assert told == pytest.approx(0.2, rel=0.05)
    assert not beside_neighbours(rough, ball.mask, np.zeros(len(rough))).any()


def test_a_pixel_without_neighbours_keeps_its_noise():
    mask = np.zeros((5, 5), bool)
    mask[2, [0, 4]] = True
    assert beside_neighbours(np.eye(3)[:2], mask, np.array([1.0, 2.0])) == pytest.approx([1, 2])


def test_noise_error_on_a_whole_surface(ball, single_lights, rng):
    """Pixels differ in how many lamps reach them, and each tells its own."""
    model = PointLights(1, ambient=False)
    clean = model.predict(single_lights, ball.b)
    told, squares = [], np.zeros(len(ball.b))
    for _ in range(30):
        images = clean + 0.01 * rng.standard_normal(clean.shape)
        lit = clean > 0.05
        found = normals_from_directions(images, single_lights, usable=lit)
        squares += angular_errors(directions_of(found), ball.normals) ** 2
        told.append(noise_error(images, model, single_lights, found, lit.astype(float)))
    spread, told = np.sqrt(squares / 30), np.sqrt(np.mean(np.square(told), axis=0))
    assert np.sqrt((told**2).mean()) == pytest.approx(np.sqrt((spread**2).mean()), rel=0.15)
    assert np.median(told) == pytest.approx(np.median(spread), rel=0.15)
    assert spearmanr(told, spread).statistic > 0.7


def test_the_unit_of_images_changes_no_error(ball, single_lights, rng):
    model = PointLights(1, ambient=False)
    images = np.abs(
        model.predict(single_lights, ball.b) + 0.01 * rng.standard_normal((24, len(ball.b)))
    )
    ones = np.ones(images.shape)
    once = noise_error(images, model, single_lights, ball.b, ones)
    for scale in (1e-4, 1e4):
        again = noise_error(scale * images, model, single_lights, scale * ball.b, ones)
        assert np.allclose(again, once, rtol=1e-9)


def test_nothing_is_known_of_pixels_without_light(ball, single_lights):
    model = PointLights(1, ambient=False)
    b = ball.b.copy()
    b[:5] = 0
    images = model.predict(single_lights, b)
    found = noise_error(images, model, single_lights, b, np.ones(images.shape))
    assert (found[:5] == 90).all()
    assert (found[5:] < 1e-3).all()


def test_three_observations_do_not_pass_for_sure(ball, single_lights, rng):
    """They fit exactly; what the noise is, other pixels tell."""
    model = PointLights(1, ambient=False)
    clean = model.predict(single_lights, ball.b)
    images = np.abs(clean + 0.01 * rng.standard_normal(clean.shape))
    weights = (clean > 0).astype(float)
    pixel = int((single_lights @ ball.normals.T > 0.1).sum(axis=0).argmax())
    three = [int(each) for each in np.flatnonzero(single_lights @ ball.normals[pixel] > 0.1)[:3]]
    weights[:, pixel] = 0
    weights[three, pixel] = 1
    b = ball.b.copy()
    b[pixel] = np.linalg.solve(single_lights[three], images[three, pixel])
    found = noise_error(images, model, single_lights, b, weights)
    inverse = np.linalg.inv(single_lights[three])
    n = b[pixel] / np.linalg.norm(b[pixel])
    across = np.eye(3) - np.outer(n, n)
    expected = np.degrees(0.01 * np.linalg.norm(across @ inverse) / np.linalg.norm(b[pixel]))
    assert found[pixel] == pytest.approx(expected, rel=0.1)


def test_what_a_fit_has_taken_out_is_noise_no_more(ball, rng):
    noisy = directions_of(ball.b + 0.05 * ball.albedo[:, None] * rng.standard_normal(ball.b.shape))
    noise = np.full(len(noisy), np.degrees(0.05 * np.sqrt(2)))
    kept = smoothed_noise(noise, noisy, 3.0 * noisy, ball.mask)
    assert np.allclose(kept, noise)
    # Half of the way to the truth takes a quarter of the variance: the mean square of 50 pixels
    # or so in a window is known to 14 %.
    half = directions_of((noisy + ball.normals) / 2)
    left = smoothed_noise(noise, noisy, half, ball.mask)
    assert np.median(left / noise) == pytest.approx(np.sqrt(3 / 4), rel=0.05)
    # A fit cannot take more than three quarters.
    all_of_it = smoothed_noise(noise, noisy, np.roll(ball.b, 200, axis=0), ball.mask)
    assert np.allclose(all_of_it, noise / 2)


def test_an_error_of_the_map_is_the_angle_by_which_normals_move(ball):
    turn = Rotation.from_rotvec([np.radians(4), 0, 0]).as_matrix()
    moved = angular_errors(ball.normals @ turn.T, ball.normals)
    found = map_error([(1.0, turn)], np.eye(3), ball.b)
    assert np.allclose(found.angle, moved)
    # It is the lean of the middle of the slopes.
    assert found.tilt[0] == pytest.approx(4, rel=0.05)
    assert found.tilt[0] > 4 * found.tilt[1]
    # Weighted squares add up.
    both = map_error([(0.5, turn), (1.75, turn)], np.eye(3), ball.b)
    assert np.allclose(both.angle, 1.5 * moved)
    assert both.tilt[0] == pytest.approx(1.5 * found.tilt[0])
    # Beyond a right angle nothing is known.
    assert map_error([(1000.0, turn)], np.eye(3), ball.b).angle.max() == 90


def test_a_stretch_is_told_as_such(ball):
    maps = [(0.5, bas_relief(0, 0, np.exp(0.2))), (0.5, bas_relief(0, 0, np.exp(-0.2)))]
    found = map_error(maps, np.eye(3), ball.b)
    assert found.stretch == pytest.approx(0.2, rel=0.01)
    assert found.angle.min() < 1 < found.angle.max()
    level = map_error(maps, np.eye(3), np.tile([[0.0, 0, 1]], (9, 1)))
    assert level.angle == pytest.approx(0)


@pytest.mark.parametrize("other", [np.eye(3), -np.eye(3), CONCAVE, 5 * CONCAVE, -CONCAVE])
def test_sign_size_and_concave_counterpart_are_no_error(ball, other):
    rows = np.array([[0.9, 0.3, -0.2], [-0.4, 1.1, 0.3], [0.2, 0.1, 0.7]])
    v = ball.b @ np.linalg.inv(rows).T
    found = map_error([(1.0, other @ rows)], rows, v)
    assert found.angle.max() < 1e-5
    assert found.tilt == pytest.approx((0, 0), abs=1e-6)
    assert found.stretch == pytest.approx(0, abs=1e-9)


def test_confidence_falls_with_the_error():
    assert np.allclose(confidence_of(np.array([0.0, 5.0, 45.0])), [1, 0.5, 0.1])
