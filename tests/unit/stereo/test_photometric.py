import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import spearmanr

from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError
from harmface.rendering import harmonic_images, relight
from harmface.stereo import (
    angular_errors,
    factorization,
    image_stack,
    photometric_stereo,
    refine,
    without_convexity,
    without_linear_map,
    without_lorentz,
)
from harmface.stereo.coarse import coarse_factor, coarse_stack, spread_over, spread_to_nearest
from harmface.stereo.refinement import nearly_equal
from tests.unit.stereo.conftest import bumpy_ball, relief


@pytest.fixture(scope="module")
def photographs(ball, single_lights):
    return ball.pictures(ball.images(single_lights, np.eye(len(single_lights))))


def error(result, scene):
    return angular_errors(result.normals[scene.mask], scene.normals).mean()


def test_known_directions(ball, photographs, single_lights):
    result = photometric_stereo(photographs, ball.mask, light=single_lights)
    assert result.report.method == "known directions"
    # Dark observations are left out, so the fit is exact.
    assert error(result, ball) < 1e-4
    assert np.allclose(result.albedo[ball.mask], ball.albedo, rtol=1e-6)
    assert (result.normals[~ball.mask] == 0).all()


def test_known_coefficients(ball, rng):
    light = rng.standard_normal((12, 9)) + 5 * np.eye(9)[0]
    images = np.maximum(light @ harmonic_images(ball.normals, ball.albedo, 2), 0)
    result = photometric_stereo(ball.pictures(images), ball.mask, light=light)
    assert result.report.method == "known coefficients"
    assert np.median(angular_errors(result.normals[ball.mask], ball.normals)) < 1e-4
    clipped = np.minimum(images, np.percentile(images, 90))
    clipped, saturated = ball.pictures(clipped), ball.pictures(clipped < images) > 0
    whole = photometric_stereo(clipped, ball.mask, light=light, saturated=saturated)
    assert np.median(angular_errors(whole.normals[ball.mask], ball.normals)) < 1e-4


@pytest.fixture(scope="module")
def overexposed(photographs, ball):
    """A fifth of the observations clipped, each photograph divided by its own exposure."""
    exposures = np.random.default_rng(4).uniform(0.5, 2, (len(photographs), 1, 1))
    level = np.percentile((exposures * photographs)[:, ball.mask], 80)
    exposed = np.minimum(exposures * photographs, level)
    return exposed / exposures, exposed == level


@pytest.mark.parametrize("robust", [False, True])
def test_saturated_observations_are_left_out(ball, overexposed, single_lights, robust):
    images, saturated = overexposed
    known = {"light": single_lights, "robust": robust}
    result = photometric_stereo(images, ball.mask, saturated=saturated, **known)
    seen = result.expected_error[ball.mask] < 90
    assert seen.mean() > 0.95
    errors = angular_errors(result.normals[ball.mask], ball.normals)
    assert errors[seen].max() < 1e-4
    assert any("saturated and were left out" in warning for warning in result.report.warnings)
    assert error(photometric_stereo(images, ball.mask, **known), ball) > 1


def test_saturated_observations_under_unknown_light(ball, overexposed):
    images, saturated = overexposed
    result = photometric_stereo(images, ball.mask, saturated=saturated, order=1, outline=True)
    assert result.report.light_model == "one point"
    assert error(result, ball) < 1
    assert any("saturated and were left out" in warning for warning in result.report.warnings)
    linear = photometric_stereo(images, ball.mask, saturated=saturated, order=1, refine=False)
    assert any("expose less" in warning for warning in linear.report.warnings)


def test_pixels_that_too_few_lights_reach_are_guesses(ball, photographs, single_lights):
    some = np.arange(0, 24, 6)
    images = photographs[some]
    result = photometric_stereo(images, ball.mask, light=single_lights[some])
    few = (images[:, ball.mask] > 0).sum(axis=0) < 3
    assert few.mean() > 0.01
    expected = result.expected_error[ball.mask]
    assert (expected[few] == 90).all()
    # By the lit observations alone they would be 21 degrees off.
    assert angular_errors(result.normals[ball.mask], ball.normals)[few].mean() < 18
    assert np.median(expected[~few]) < 1
    assert any("their normals are guesses" in warning for warning in result.report.warnings)


def test_observations_that_bent_a_plain_fit_count_in_its_expected_error(ball, single_lights, rng):
    images = ball.images(single_lights, np.eye(24))
    images[rng.random(images.shape) < 0.1] += 0.5
    images = ball.pictures(np.abs(images + 0.005 * rng.standard_normal(images.shape)))
    expected = {}
    for robust in (False, True):
        result = photometric_stereo(images, ball.mask, light=single_lights, robust=robust)
        expected[robust] = result.expected_error[ball.mask].mean()
        # A standard deviation, of errors that differ from pixel to pixel.
        assert expected[robust] == pytest.approx(error(result, ball), rel=0.3)
    assert expected[True] < 0.2 * expected[False]


def under_highlights(scene, lights, rng, strength):
    halves = lights + np.array([0, 0, 1])
    halves /= np.linalg.norm(halves, axis=1, keepdims=True)
    images = scene.images(lights, np.eye(len(lights)))
    images += strength * np.maximum(halves @ scene.normals.T, 0) ** 15 * (images > 0)
    return scene.pictures(np.abs(images + 0.003 * rng.standard_normal(images.shape)))


@pytest.mark.parametrize("known", [True, False])
def test_expected_error_tells_which_normals_are_wrong(ball, single_lights, rng, known):
    images = under_highlights(ball, single_lights, rng, 0.2)
    light = {"light": single_lights, "robust": True} if known else {"outline": True}
    result = photometric_stereo(images, ball.mask, **light)
    errors = angular_errors(result.normals[ball.mask], ball.normals)
    expected = result.expected_error[ball.mask]
    assert spearmanr(expected, errors).statistic > 0.5
    assert 0.5 < expected.mean() / errors.mean() < 2


@pytest.mark.parametrize("refined", [True, False])
def test_highlights_do_not_pass_for_other_light(ball, hills, single_lights, rng, refined):
    """Broad ones look like other points, but like no uniform light."""
    for scene, strength in ((ball, 0.3), (hills, 0.1)):
        images = under_highlights(scene, single_lights, rng, strength)
        result = photometric_stereo(images, scene.mask, refine=refined)
        assert result.report.light_model == "one point"
        normals = without_convexity(result.normals[scene.mask], scene.normals)
        assert angular_errors(normals, scene.normals).mean() < (3 if refined else 5)


@pytest.mark.parametrize("refined", [True, False])
def test_lamps_need_not_be_equal(ball, single_lights, rng, refined):
    """A linear map makes eight of any lamps equal, which must not pass for evidence."""
    images = np.maximum(single_lights * rng.uniform(0.7, 1.3, (24, 1)) @ ball.b.T, 0)
    images = np.abs(images + 0.005 * rng.standard_normal(images.shape))
    result = photometric_stereo(ball.pictures(images), ball.mask, outline=True, refine=refined)
    assert error(result, ball) < 7
    assert result.expected_error[ball.mask].mean() > error(result, ball) / 2


def test_lamps_are_equal_if_more_are_than_a_map_can_make_so(rng):
    directions = rng.standard_normal((20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)

    def equal(strengths):
        return nearly_equal(directions[: len(strengths)] * np.array(strengths)[:, None])

    assert equal([1.0] * 17 + [2.0] * 3)
    assert not equal([1.0] * 15 + [2.0] * 5)
    assert not equal([1.0] * 8 + [0.8, 1.2])
    assert equal([0.5, 1.0, 1.0, 2.0])


def test_known_light_takes_little_more_memory_than_the_stack(rng, monkeypatch):
    monkeypatch.setattr(factorization, "CHUNK", 2**17)
    lights = rng.standard_normal((100, 3)) * 0.2 + (0, 0, 1)
    b = rng.uniform((-0.5, -0.5, 0.5), (0.5, 0.5, 1.5), (192, 192, 3))
    images = np.maximum(np.einsum("fi,hwi->fhw", lights, b), 0)
    done = []
    tracemalloc.start()
    photometric_stereo(images, light=lights, progress=done.append)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # The masked copy, which observations are usable, and some hundred numbers a pixel.
    assert peak < 2 * images.nbytes
    assert len(done) > 100
    assert done == sorted(done)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    "scene", [bumpy_ball(), bumpy_ball(110), relief()], ids=["ball", "blocks", "relief"]
)
def test_images_of_its_own_degree_are_exact(rng, order, scene):
    """At 110 pixels across what all share is found on blocks, whose means are of no degree."""
    light = rng.standard_normal((24, (order + 1) ** 2)) + 8 * np.eye((order + 1) ** 2)[0]
    images = light @ harmonic_images(scene.normals, scene.albedo, order)
    found = photometric_stereo(scene.pictures(images), scene.mask, order=order, refine=False)
    assert not found.report.warnings
    normals = without_lorentz(found.normals[scene.mask], scene.normals)
    assert angular_errors(normals, scene.normals).max() < 1e-4
    # The cues' own choice suffers from differences over cells alone. A relief has no outline.
    chosen = without_convexity(found.normals[scene.mask], scene.normals)
    assert angular_errors(chosen, scene.normals).mean() < 1


@pytest.mark.parametrize(
    ("order", "refine", "method", "most"),
    [(1, False, "first order", 12), (2, False, "second order", 3), (2, True, "refined", 2)],
)
def test_nothing_known(ball, photographs, order, refine, method, most):
    result = photometric_stereo(photographs, ball.mask, order=order, refine=refine)
    assert result.report.method == method
    assert result.report.convexity == "outline"
    assert error(result, ball) < most
    inside = ball.mask
    assert np.allclose(np.linalg.norm(result.normals[inside], axis=1), 1)
    assert result.albedo.max() == pytest.approx(1)
    assert ((result.confidence[inside] > 0) & (result.confidence[inside] <= 1)).all()
    basis = harmonic_images(result.normals[inside], result.albedo[inside])
    left = photographs[:, inside] - relight(result.lighting, basis)
    share = np.linalg.norm(left) / np.linalg.norm(photographs)
    assert share == pytest.approx(result.report.residual)
    # Nine harmonics hold 98 % of the energy of a point source's images and more.
    assert share < 0.15


def test_a_relief_has_no_outline(hills, single_lights):
    images = hills.pictures(hills.images(single_lights, np.eye(24)))
    result = photometric_stereo(images)
    assert result.report.convexity == "assumed"
    normals = without_convexity(result.normals.reshape(-1, 3), hills.normals)
    assert angular_errors(normals, hills.normals).mean() < 2


def test_known_normals_and_symmetry_are_used(ball, photographs):
    known = np.zeros((*ball.mask.shape, 3))
    truth = np.zeros_like(known)
    truth[ball.mask] = ball.normals
    for row, column in ((12, 20), (25, 12), (28, 27)):
        known[row, column] = truth[row, column]
    result = photometric_stereo(
        photographs, ball.mask, normals_known=known, order=2, refine=False, outline=False
    )
    assert result.report.convexity == "known normals"
    assert error(result, ball) < 5
    symmetric = photometric_stereo(photographs, ball.mask, symmetric=True, order=1, refine=False)
    plain = photometric_stereo(photographs, ball.mask, order=1, refine=False)
    assert not np.array_equal(symmetric.normals, plain.normals)


def test_gamma_is_noticed(hills, single_lights):
    images = hills.pictures(hills.images(single_lights, np.eye(24)))
    images = images / images.max()
    for photographs, noticed in ((images, False), (linear_to_srgb(images), True)):
        result = photometric_stereo(photographs, order=1, refine=False, outline=False)
        assert any("gamma" in warning for warning in result.report.warnings) == noticed


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i, m: {"images": i[:8]}, "at least 9, got 8"),
        (lambda i, m: {"images": i[:3], "order": 1}, "at least 4, got 3"),
        (lambda i, m: {"images": i[:2], "light": np.eye(3)[:2]}, "at least 3, got 2"),
        (lambda i, m: {"order": 3}, "order must be 1 or 2"),
        (lambda i, m: {"smoothness": -1.0}, "smoothness must be at least 0"),
        (lambda i, m: {"smoothness": np.inf}, "smoothness must be at least 0 and finite"),
        (lambda i, m: {"smoothness": 1.0, "refine": False}, "smoothness needs refinement"),
        (lambda i, m: {"mask": m[1:]}, "mask must have"),
        (lambda i, m: {"mask": ~m & m}, "at least one pixel"),
        (lambda i, m: {"images": i * np.nan}, "finite"),
        (lambda i, m: {"images": i[:1].repeat(12, axis=0)}, "alike"),
        (lambda i, m: {"light": np.eye(3)}, "row for each of the 24 images"),
        (lambda i, m: {"light": np.ones((24, 2))}, "light must be"),
        (lambda i, m: {"light": np.ones((24, 5))}, "square"),
        (lambda i, m: {"normals_known": np.zeros((3, 3, 3))}, "normals_known must have"),
        (lambda i, m: {"normals_known": np.zeros((*m.shape, 3))}, "at least 2 normals"),
        (lambda i, m: {"normals_known": np.ones((*m.shape, 3))}, "unit vectors"),
    ],
)
def test_nonsense_is_refused(ball, photographs, change, message):
    arguments = {"images": photographs, "mask": ball.mask, **change(photographs, ball.mask)}
    with pytest.raises(ArgumentError, match=message):
        photometric_stereo(**arguments)


def test_blocks_are_means_and_spread_back(rng):
    images = rng.uniform(0.1, 1, (5, 13, 11))
    mask = np.ones((13, 11), bool)
    mask[4, 5] = False
    stack = image_stack(images, mask)
    coarse = coarse_stack(stack, 3)
    assert coarse.mask.shape == (4, 3)
    assert not coarse.mask[1, 1]
    assert coarse.mask.sum() == 11
    assert np.allclose(coarse.picture(coarse.values[2])[3, 2], images[2, 9:12, 6:9].mean())
    assert coarse_stack(stack, 1) is stack
    assert coarse_factor(np.ones((256, 256), bool)) == 4
    rows = rng.standard_normal((2, 5))
    spread = spread_over((rows @ coarse.values).T, coarse.values, stack.values)
    assert np.allclose(spread, (rows @ stack.values).T)
    numbers = stack.picture(spread_to_nearest(np.arange(11.0), coarse.mask, mask, 3), -1)
    assert (numbers[:3, :6] == np.repeat([0, 1], 3)).all()
    # Neither the last row and columns nor the pixels about the hole have a whole block.
    assert numbers[12, 0] == numbers[11, 0] == 8
    assert numbers[0, 10] == numbers[0, 8] == 2
    assert numbers[3, 3] in (1, 3, 4, 6)


@pytest.mark.parametrize("known", ["directions", "coefficients", "nothing"])
def test_normals_of_one_surface_have_less_noise(ball, single_lights, rng, known):
    if known == "coefficients":
        light = rng.standard_normal((12, 9)) + 8 * np.eye(9)[0]
        images = light @ harmonic_images(ball.normals, ball.albedo, 2)
    else:
        light = single_lights if known == "directions" else None
        images = ball.images(single_lights, np.eye(24))
    images = images + 0.02 * np.abs(images).max() * rng.standard_normal(images.shape)
    images = ball.pictures(np.maximum(images, 0))

    def left(smoothness):
        """Return the error that no linear map of all normals explains: that of the noise."""
        result = photometric_stereo(images, ball.mask, light=light, smoothness=smoothness)
        normals = without_linear_map(result.normals[ball.mask], ball.normals)
        return angular_errors(normals, ball.normals).mean()

    plain, smooth = left(None), left(1.0)
    # Two of three numbers come from one; the rim, where a spline ends, gains little.
    assert smooth < 0.85 * plain


def test_a_refinement_led_astray_is_set_aside(ball, several_sources, monkeypatch):
    from harmface.stereo import unknown_light

    def astray(stack, b, known, *, rng):
        found = refine(stack, b, known, rng=rng)
        # A shear of all normals: the images stay explained, the surface does not exist.
        shear = np.eye(3)
        shear[0, 1] = 1.5
        return replace(found, transformation=shear @ found.transformation)

    monkeypatch.setattr(unknown_light, "refined", astray)
    result = photometric_stereo(ball.pictures(several_sources), ball.mask)
    assert result.report.method == "second order"
    assert result.report.light_model is None
    assert any("set aside" in warning for warning in result.report.warnings)
    assert error(result, ball) < 6
