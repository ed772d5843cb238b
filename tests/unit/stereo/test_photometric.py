"""Photographs of analytic surfaces in, surfaces out."""

import tracemalloc

import numpy as np
import pytest

from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError, HarmfaceError
from harmface.rendering import harmonic_images, relight
from harmface.stereo import (
    angular_errors,
    factorization,
    image_stack,
    photometric_stereo,
    without_convexity,
)
from harmface.stereo.coarse import coarse_factor, coarse_stack, nearest_blocks, spread_over
from harmface.stereo.photometric import MOST_KNOWN, _known_normals
from tests.unit.stereo.conftest import Quadric, front_lights


@pytest.fixture(scope="module")
def photographs(ball, single_lights):
    return ball.pictures(ball.images(single_lights, np.eye(len(single_lights))))


def error(result, scene):
    return angular_errors(result.normals[scene.mask], scene.normals).mean()


def rendered(shape, lamps, rng, noise=0.005, albedo=None):
    """Return photographs of a shape, the cosine clamped, with noise of the brightest value."""
    a = 1.0 if albedo is None else albedo
    values = np.maximum(lamps @ shape.normals.T, 0) * a
    values += noise * values.max() * rng.standard_normal(values.shape)
    images = np.zeros((len(lamps), *shape.mask.shape))
    images[:, shape.mask] = np.maximum(values, 0)
    return images


class Vase:
    """A solid of revolution about y, of radius 12 + 4 sin(y / 7), in pixels."""

    def __init__(self, size=48):
        y, x = np.mgrid[size - 1 : -size : -2, 1 - size : size : 2] / 2.0
        radius = 12 + 4 * np.sin(y / 7)
        self.mask = (np.abs(x) < radius) & (np.abs(y) < size / 2 - 4)
        x, y, radius = (each[self.mask] for each in (x, y, radius))
        gradient = np.stack([x, -radius * 4 / 7 * np.cos(y / 7), np.sqrt(radius**2 - x**2)], axis=1)
        self.normals = gradient / np.linalg.norm(gradient, axis=1, keepdims=True)


def test_known_directions(ball, photographs, single_lights):
    result = photometric_stereo(photographs, ball.mask, method="known-lights", light=single_lights)
    assert result.report.method == "known-lights"
    assert result.report.map_error == 0
    assert result.report.strengths == pytest.approx(np.ones(24), abs=1e-3)
    # The strengths of equal lamps are found to that, and dark observations are left out.
    assert error(result, ball) < 0.05
    assert np.allclose(result.albedo[ball.mask], ball.albedo, rtol=2e-3)
    assert (result.normals[~ball.mask] == 0).all()


def test_directions_times_strengths_are_taken_as_they_are(ball, photographs, single_lights):
    strengths = np.linspace(0.5, 2, 24)
    images = strengths[:, None, None] * photographs
    result = photometric_stereo(
        images, ball.mask, method="known-lights", light=single_lights, strengths=strengths
    )
    assert error(result, ball) < 1e-4
    assert result.report.cues == ()
    assert np.allclose(result.albedo[ball.mask], ball.albedo, rtol=1e-6)
    # Without them they are found.
    found = photometric_stereo(images, ball.mask, method="known-lights", light=single_lights)
    assert found.report.strengths == pytest.approx(strengths / strengths.mean(), rel=0.02)
    assert error(found, ball) < 0.5
    # Three lamps have no strengths to find: taken as equal.
    three = photometric_stereo(
        photographs[:3], ball.mask, method="known-lights", light=single_lights[:3]
    )
    assert three.report.strengths == pytest.approx((1, 1, 1))


def test_known_coefficients(ball, rng):
    light = rng.standard_normal((12, 9)) + 5 * np.eye(9)[0]
    images = np.maximum(light @ harmonic_images(ball.normals, ball.albedo, 2), 0)
    known = {"method": "known-lights", "light": light}
    result = photometric_stereo(ball.pictures(images), ball.mask, **known)
    assert result.report.light_model == "harmonic"
    assert result.lamps is None
    assert np.median(angular_errors(result.normals[ball.mask], ball.normals)) < 1e-4
    clipped = np.minimum(images, np.percentile(images, 90))
    clipped, saturated = ball.pictures(clipped), ball.pictures(clipped < images) > 0
    whole = photometric_stereo(clipped, ball.mask, saturated=saturated, **known)
    assert np.median(angular_errors(whole.normals[ball.mask], ball.normals)) < 1e-4


@pytest.fixture(scope="module")
def overexposed(photographs, ball):
    """A fifth of the observations clipped, each photograph divided by its own exposure."""
    exposures = np.random.default_rng(4).uniform(0.5, 2, (len(photographs), 1, 1))
    level = np.percentile((exposures * photographs)[:, ball.mask], 80)
    exposed = np.minimum(exposures * photographs, level)
    return exposed / exposures, exposed == level


def test_saturated_observations_are_left_out(ball, overexposed, single_lights):
    images, saturated = overexposed
    known = {"method": "known-lights", "light": single_lights, "strengths": np.ones(24)}
    result = photometric_stereo(images, ball.mask, saturated=saturated, **known)
    seen = result.expected_error[ball.mask] < 90
    assert seen.mean() > 0.95
    errors = angular_errors(result.normals[ball.mask], ball.normals)
    assert errors[seen].max() < 1e-4
    assert any("saturated and were left out" in warning for warning in result.report.warnings)
    assert error(photometric_stereo(images, ball.mask, **known), ball) > 1


def test_pixels_that_too_few_lights_reach_are_guesses(ball, photographs, single_lights):
    some = np.arange(0, 24, 6)
    images = photographs[some]
    result = photometric_stereo(
        images,
        ball.mask,
        method="known-lights",
        light=single_lights[some],
        strengths=np.ones(len(single_lights[some])),
    )
    few = (images[:, ball.mask] > 0).sum(axis=0) < 3
    assert few.mean() > 0.01
    expected = result.expected_error[ball.mask]
    assert (expected[few] == 90).all()
    # By the lit observations alone they would be 21 degrees off.
    assert angular_errors(result.normals[ball.mask], ball.normals)[few].mean() < 18
    assert np.median(expected[~few]) < 1
    assert any("their normals are guesses" in warning for warning in result.report.warnings)


def test_equal_lamps(rng):
    shape = Quadric((20.0, 15.0, 17.0))
    lamps = front_lights(24)
    result = photometric_stereo(rendered(shape, lamps, rng), shape.mask)
    assert result.report.method == "refined"
    assert result.report.light_model == "one point"
    assert result.report.convexity == "outline"
    # Noise of half a percent, and ten degrees of freedom at most that 600 cells tell.
    assert error(result, shape) < 3
    assert result.report.strengths == pytest.approx(np.ones(24), abs=0.1)
    assert {told.name: told.accepted for told in result.report.cues}["equal lamps"]
    inside = shape.mask
    assert np.allclose(np.linalg.norm(result.normals[inside], axis=1), 1)
    assert result.albedo.max() == pytest.approx(1)
    assert ((result.confidence[inside] > 0) & (result.confidence[inside] <= 1)).all()
    assert (result.normals[~inside] == 0).all() and (result.expected_error[~inside] == 0).all()
    found = result.lamps / np.linalg.norm(result.lamps, axis=1, keepdims=True)
    assert np.median(angular_errors(found, lamps)) < 3


@pytest.mark.parametrize(
    ("shape", "count"),
    [(Quadric((20.0, 15.0, 17.0)), 12), (Vase(), 48)],
    ids=["ellipsoid", "vase"],
)
def test_lamps_of_unequal_strengths(shape, count):
    rng = np.random.default_rng(7)
    lamps = front_lights(count) * np.exp(0.5 * rng.standard_normal((count, 1)))
    result = photometric_stereo(rendered(shape, lamps, rng), shape.mask)
    assert error(result, shape) <= 3


def test_a_cylinder_does_not_collapse(rng):
    """Where a surface is straight one way, integrability leaves more open than bas-reliefs."""
    x = np.arange(-23.5, 24) / 20
    mask = np.broadcast_to(np.abs(x) < 1, (48, 48)).copy()
    mask[:3] = mask[-3:] = False
    across = np.broadcast_to(x, mask.shape)[mask]
    normals = np.stack([across, 0 * across, np.sqrt(1 - across**2)], axis=1)
    images = np.zeros((24, *mask.shape))
    values = np.maximum(front_lights(24) @ normals.T, 0)
    images[:, mask] = np.maximum(values + 0.005 * rng.standard_normal(values.shape), 0)
    result = photometric_stereo(images, mask)
    errors = angular_errors(result.normals[mask], normals)
    told = np.median(result.expected_error[mask])
    assert np.median(errors) < 15 or 0.5 < told / np.median(errors) < 2


def test_outliers_get_low_weights(ball, single_lights, rng):
    """A tenth of the observations is far off; the normals hardly notice."""
    images = ball.images(single_lights, np.eye(24))
    hit = (rng.random(images.shape) < 0.1) & (images > 0.1)
    images[hit] *= rng.uniform(2, 4, hit.sum())
    images = ball.pictures(np.abs(images + 0.003 * rng.standard_normal(images.shape)))
    known = photometric_stereo(
        images,
        ball.mask,
        method="known-lights",
        light=single_lights,
        strengths=np.ones(len(single_lights)),
    )
    # A plain fit would be off by ten degrees and more.
    lit = images[:, ball.mask] > 0.02
    plain = np.stack(
        [
            np.linalg.lstsq(single_lights[seen], values[seen], rcond=None)[0]
            for values, seen in zip(images[:, ball.mask].T, lit.T, strict=True)
        ]
    )
    plain /= np.linalg.norm(plain, axis=1, keepdims=True)
    assert error(known, ball) < 0.2 * angular_errors(plain, ball.normals).mean()
    unknown = photometric_stereo(images, ball.mask)
    assert error(unknown, ball) < 0.5 * angular_errors(plain, ball.normals).mean()


@pytest.mark.parametrize(
    ("method", "kind"),
    [
        ("refined", "coplanar"),
        ("refined", "mostly dark"),
        ("refined", "one lit pixel"),
        ("4d", "coplanar"),
        ("9d", "one lit pixel"),
    ],
)
def test_poor_light_ends_in_doubt_or_in_one_clear_line(method, kind):
    rng = np.random.default_rng(2)
    shape = Quadric((12.0, 9.0, 10.0), size=28)
    angle = np.linspace(-1, 1, 12)
    arc = np.stack([np.sin(angle), np.zeros(12), np.cos(angle)], axis=1)
    images = rendered(shape, arc, rng, noise=0.0 if kind == "coplanar" else 0.01)
    if kind == "mostly dark":
        images[:, :, :20] = 0
    if kind == "one lit pixel":
        images = np.zeros_like(images)
        images[:, 14, 14] = rng.uniform(0.1, 1, 12)
        images[:, 14, 15] = rng.uniform(0.1, 1, 12)
    try:
        result = photometric_stereo(images, shape.mask, method=method)
    except HarmfaceError:
        return
    assert np.isfinite(result.normals).all()
    assert np.isfinite(result.albedo).all()
    errors = angular_errors(result.normals[shape.mask], shape.normals)
    told = np.median(result.expected_error[shape.mask])
    assert told > 5 or np.median(errors) < 10


def test_everything_dark_is_refused():
    with pytest.raises(HarmfaceError):
        photometric_stereo(np.zeros((12, 20, 20)))


@pytest.mark.parametrize(("method", "most"), [("4d", 12), ("9d", 6)])
def test_closed_forms(ball, photographs, method, most):
    result = photometric_stereo(photographs, ball.mask, method=method)
    assert result.report.method == method
    assert result.report.signature_held is not None
    assert result.report.convexity == "outline"
    assert error(result, ball) < most
    inside = ball.mask
    basis = harmonic_images(result.normals[inside], result.albedo[inside])
    left = photographs[:, inside] - relight(result.lighting, basis)
    share = np.linalg.norm(left) / np.linalg.norm(photographs)
    assert share == pytest.approx(result.report.residual)


def test_known_normals_decide_convexity_and_symmetry_is_used(ball, photographs):
    truth = np.zeros((*ball.mask.shape, 3))
    truth[ball.mask] = ball.normals * (-1, -1, 1)
    known = np.zeros_like(truth)
    for row, column in ((12, 20), (25, 12), (28, 27)):
        known[row, column] = truth[row, column]
    result = photometric_stereo(photographs, ball.mask, normals_known=known)
    assert result.report.convexity == "known normals"
    concave = angular_errors(result.normals[ball.mask], ball.normals * (-1, -1, 1))
    assert concave.mean() < 5
    symmetric = photometric_stereo(photographs, ball.mask, symmetric=True)
    assert "symmetry" in {told.name for told in symmetric.report.cues}


def test_directions_of_some_lamps_decide_convexity_and_the_map(ball, photographs, single_lights):
    sheared = photographs * np.exp(np.random.default_rng(1).normal(0, 0.5, (24, 1, 1)))
    directions = single_lights / np.linalg.norm(single_lights, axis=1, keepdims=True)
    few = np.zeros((24, 3))
    few[[2, 9, 17, 20]] = directions[[2, 9, 17, 20]] * (-1, -1, 1)
    result = photometric_stereo(sheared, ball.mask, directions_known=few)
    assert result.report.convexity == "known directions"
    concave = angular_errors(result.normals[ball.mask], ball.normals * (-1, -1, 1))
    assert concave.mean() < 1
    found = result.lamps / np.linalg.norm(result.lamps, axis=1, keepdims=True)
    assert angular_errors(found[few.any(axis=1)], few[few.any(axis=1)]).max() < 2
    # A lamp beside the camera tells the tilt of the surface, but not whether it is convex.
    front = np.zeros((24, 3))
    front[np.argmax(directions[:, 2])] = (0, 0, 1)
    result = photometric_stereo(sheared, ball.mask, directions_known=front)
    assert result.report.convexity == "outline"
    assert "known directions" in {told.name for told in result.report.cues if told.accepted}


def test_directions_of_one_lamp_do_not_fit_several(ball, photographs):
    room = photographs + np.roll(photographs, 7, axis=0) + np.roll(photographs, 11, axis=0)
    front = np.tile([0.0, 0.0, 1.0], (24, 1))
    with pytest.raises(ArgumentError, match="one lamp an image, but these images show"):
        photometric_stereo(room, ball.mask, directions_known=front)


def test_known_normals_are_columns_spread_over_all(rng):
    mask = rng.random((40, 40)) < 0.8
    normals = np.zeros((40, 40, 3))
    chosen = rng.random((40, 40)) < 0.5
    normals[chosen] = (0.6, 0, 0.8)
    pixels, given = _known_normals(normals, mask)
    assert len(pixels) == MOST_KNOWN
    assert chosen[mask][pixels].all()
    assert pixels[0] < 10 and pixels[-1] > mask.sum() - 10
    assert np.allclose(given, (0.6, 0, 0.8))
    assert _known_normals(None, mask) is None


def test_a_relief_has_no_outline(hills, single_lights):
    images = hills.pictures(hills.images(single_lights, np.eye(24)))
    result = photometric_stereo(images)
    assert result.report.convexity == "assumed"
    assert any("convex was assumed" in warning for warning in result.report.warnings)
    normals = without_convexity(result.normals.reshape(-1, 3), hills.normals)
    assert angular_errors(normals, hills.normals).mean() < 3


def test_gamma_is_noticed(hills, single_lights):
    images = hills.pictures(hills.images(single_lights, np.eye(24)))
    images = images / images.max()
    known = {"method": "known-lights", "light": single_lights, "strengths": np.ones(24)}
    for photographs, noticed in ((images, False), (linear_to_srgb(images), True)):
        result = photometric_stereo(photographs, **known)
        assert any("gamma" in warning for warning in result.report.warnings) == noticed


def known(**given):
    """Return arguments of known lights, some of them wrong."""
    return {"method": "known-lights", "light": np.tile([0.0, 0.0, 1.0], (24, 1)), **given}


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda i, m: {"method": "5d"}, "method must be one of 4d, 9d, refined, known-lights"),
        (lambda i, m: {"images": i[:8], "method": "9d"}, "at least 9, got 8"),
        (lambda i, m: {"images": i[:3], "method": "4d"}, "at least 4, got 3"),
        (lambda i, m: {"images": i[:3]}, "at least 4, got 3"),
        (
            lambda i, m: {"images": i[:2], "method": "known-lights", "light": np.eye(3)[:2]},
            "at least 3, got 2",
        ),
        (lambda i, m: {"method": "known-lights"}, "must be given .* with neither of them"),
        (lambda i, m: {"light": np.ones((24, 3))}, "must be given .* with one of them"),
        (lambda i, m: {"smoothness": -1.0}, "smoothness must be at least 0"),
        (lambda i, m: {"smoothness": np.inf}, "smoothness must be at least 0 and finite"),
        (lambda i, m: {"smoothness": np.nan}, "smoothness must be at least 0 and finite"),
        (lambda i, m: {"smoothness": 1.0, "method": "4d"}, "smoothness needs the method"),
        (lambda i, m: {"symmetric": True, "method": "9d"}, "symmetric serve the method 'refined'"),
        (
            lambda i, m: {"normals_known": np.zeros((*m.shape, 3)), "method": "4d"},
            "serve the method 'refined' only, got '4d'",
        ),
        (lambda i, m: {"images": i[0]}, "one size for all"),
        (lambda i, m: {"mask": m[1:]}, "mask must have"),
        (lambda i, m: {"mask": ~m & m}, "at least one pixel"),
        (lambda i, m: {"images": i * np.nan}, "finite"),
        (lambda i, m: {"images": -i}, "negative"),
        (lambda i, m: {"images": i[:1].repeat(12, axis=0)}, "alike"),
        (lambda i, m: {"saturated": i[0] > 0}, "saturated must tell"),
        (lambda i, m: {"saturated": i >= 0}, "saturated must leave observations"),
        (lambda i, m: {"method": "known-lights", "light": np.eye(3)}, "each of the 24 images"),
        (lambda i, m: {"method": "known-lights", "light": np.ones((24, 3))}, "unit vectors"),
        (
            lambda i, m: {"strengths": np.ones(24)},
            "strengths are those of lamps in light",
        ),
        (lambda i, m: known(strengths=np.ones(3)), "one for each of the 24 lamps"),
        (lambda i, m: known(strengths=-np.ones(24)), "strengths must not be negative"),
        (lambda i, m: known(light=np.ones((24, 4)), strengths=np.ones(24)), "belong to directions"),
        (lambda i, m: {"method": "known-lights", "light": np.ones((24, 2))}, "light must be"),
        (lambda i, m: {"method": "known-lights", "light": np.ones((24, 5))}, "square"),
        (lambda i, m: {"method": "known-lights", "light": np.full((24, 3), np.nan)}, "finite"),
        (lambda i, m: {"normals_known": np.zeros((3, 3, 3))}, "normals_known must have"),
        (lambda i, m: {"normals_known": np.zeros((*m.shape, 3))}, "a normal within the mask"),
        (lambda i, m: {"directions_known": np.zeros((24, 3))}, "but all are zero"),
        (lambda i, m: {"directions_known": np.ones((3, 3))}, "each of the 24 images"),
        (lambda i, m: {"directions_known": np.ones((24, 3))}, "unit vectors"),
        (
            lambda i, m: {"directions_known": np.eye(24)[:, :3], "method": "9d"},
            "directions_known and symmetric serve the method 'refined' only, got '9d'",
        ),
        (lambda i, m: {"normals_known": np.ones((*m.shape, 3))}, "unit vectors"),
        (lambda i, m: {"rng": "seed"}, "rng"),
    ],
)
def test_nonsense_is_refused(ball, photographs, change, message):
    arguments = {"images": photographs, "mask": ball.mask, **change(photographs, ball.mask)}
    with pytest.raises(ArgumentError, match=message):
        photometric_stereo(**arguments)


def test_known_light_takes_little_more_memory_than_the_stack(rng, monkeypatch):
    monkeypatch.setattr(factorization, "CHUNK", 2**17)
    lights = rng.standard_normal((100, 3)) * 0.2 + (0, 0, 1)
    lights /= np.linalg.norm(lights, axis=1, keepdims=True)
    b = rng.uniform((-0.5, -0.5, 0.5), (0.5, 0.5, 1.5), (192, 192, 3))
    images = np.maximum(np.einsum("fi,hwi->fhw", lights, b), 0)
    done = []
    tracemalloc.start()
    photometric_stereo(
        images,
        method="known-lights",
        light=lights,
        strengths=np.ones(100),
        progress=done.append,
    )
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # The masked copy, which observations are usable, and some hundred numbers a pixel.
    assert peak < 2 * images.nbytes
    assert len(done) > 100
    assert done == sorted(done)


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
    numbers = stack.picture(nearest_blocks(np.arange(142), mask, coarse.mask, 3), -1)
    assert (numbers[:3, :6] == np.repeat([0, 1], 3)).all()
    # Neither the last row and columns nor the pixels about the hole have a whole block.
    assert numbers[12, 0] == numbers[11, 0] == 8
    assert numbers[0, 10] == numbers[0, 8] == 2
    assert numbers[3, 3] in (1, 3, 4, 6)


@pytest.mark.parametrize("known", ["directions", "coefficients"])
def test_normals_of_one_surface_have_less_noise(ball, single_lights, rng, known):
    if known == "coefficients":
        light = {"light": rng.standard_normal((12, 9)) + 8 * np.eye(9)[0]}
        images = light["light"] @ harmonic_images(ball.normals, ball.albedo, 2)
    else:
        light = {"light": single_lights, "strengths": np.ones(24)}
        images = ball.images(single_lights, np.eye(24))
    images = images + 0.02 * np.abs(images).max() * rng.standard_normal(images.shape)
    images = ball.pictures(np.maximum(images, 0))
    plain, smooth = (
        photometric_stereo(images, ball.mask, method="known-lights", smoothness=smoothness, **light)
        for smoothness in (None, 1.0)
    )
    # Two of three numbers come from one; the rim, where a spline ends, gains little.
    assert error(smooth, ball) < 0.85 * error(plain, ball)
    assert smooth.report.noise_error < plain.report.noise_error
