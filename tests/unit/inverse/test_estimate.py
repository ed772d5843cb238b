import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.inverse import LightPrior, estimate_light, singular_values
from harmface.light import EnvironmentMap
from harmface.rendering import clamped_cosines, harmonic_irradiance
from harmface.sphere import gauss_legendre, random_directions, real_harmonics

LIGHT = np.array([4.0, 0.6, 0.9, -0.5, 0.3, -0.4, 0.2, 0.5, -0.3])
SIDE = 64


def ball(side=SIDE):
    """Normals of a sphere seen from the front, zeros around it, and where it is."""
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at, -at)
    inside = x**2 + y**2 < 0.98
    normals = np.stack([x, y, np.sqrt(np.where(inside, 1 - x**2 - y**2, 0))], axis=-1)
    return np.where(inside[..., None], normals, 0), inside


def picture(light, normals, inside, albedo=1.0):
    image = np.zeros((*np.shape(light)[:-1], *inside.shape))
    image[..., inside] = harmonic_irradiance(light, normals[inside])
    return np.moveaxis(image, 0, -1) * np.atleast_3d(albedo) if light.ndim == 2 else image * albedo


@pytest.mark.parametrize("robust", [True, False])
def test_exact_pictures_give_the_light_back(rng, robust):
    normals, inside = ball()
    albedo = rng.uniform(0.2, 0.9, inside.shape)
    light = np.stack([LIGHT, 2 * LIGHT, LIGHT[::-1] + 4])
    image = picture(light, normals, inside, albedo)
    found = estimate_light(image, normals, albedo, robust=robust)
    assert np.abs(found.coefficients - light).max() < 1e-10
    assert found.residual.max() < 1e-12
    assert found.determined.all()
    assert np.abs(np.moveaxis(found.fit, 0, -1) - image).max() < 1e-10


def test_albedo_may_differ_between_channels(rng):
    normals, inside = ball()
    albedo = rng.uniform(0.2, 0.9, (*inside.shape, 3))
    image = picture(np.stack([LIGHT] * 3), normals, inside, albedo)
    found = estimate_light(image, normals, albedo)
    assert np.abs(found.coefficients - LIGHT).max() < 1e-10


def trials(count, **options):
    """Estimate from many noisy pictures, each a channel of one, as channels do not depend."""
    rng = np.random.default_rng(3)
    normals, inside = ball(40)
    albedo = rng.uniform(0.3, 0.9, inside.shape)
    image = picture(LIGHT, normals, inside, albedo)
    noisy = image[..., None] + 0.02 * rng.standard_normal((*image.shape, count))
    found = estimate_light(noisy, normals, albedo, **options)
    off = found.coefficients - LIGHT
    squares = np.einsum("ck,ck->c", off, np.linalg.solve(found.covariance, off[..., None])[..., 0])
    return squares.mean() / 9, np.mean(np.abs(off) < 1.96 * found.standard_errors)


@pytest.mark.parametrize("robust", [True, False])
@pytest.mark.parametrize("noise", [None, 0.02])
@pytest.mark.usefixtures("unchecked")
def test_the_covariance_is_that_of_the_errors(robust, noise):
    square, covered = trials(1000, robust=robust, noise=noise)
    assert abs(square - 1) < 0.05
    assert 0.93 < covered < 0.97


def test_shadows_highlights_and_clipped_pixels_have_no_vote(rng):
    normals, inside = ball()
    image = picture(LIGHT, normals, inside) + 0.01 * rng.standard_normal(inside.shape)
    image[10:30, 20:40] *= 0.3
    image[40:45, 20:30] += 5
    believed = np.ones(inside.shape, bool)
    image[50:60, 30:40], believed[50:60, 30:40] = 2.0, False
    found = estimate_light(image, normals, believed=believed)
    plain = estimate_light(image, normals, believed=believed, robust=False)
    assert np.abs(found.coefficients - LIGHT).max() < 0.1
    assert np.abs(plain.coefficients - LIGHT).max() > 1
    assert found.weights[15, 30] == found.weights[42, 25] == found.weights[55, 35] == 0
    assert found.weights[32, 32] > 0.5


def test_neighbours_that_err_alike_make_errors_larger():
    normals, inside = ball()
    wrong = 0.05 * np.kron(np.random.default_rng(0).standard_normal((16, 16)), np.ones((4, 4)))
    alone = np.random.default_rng(1).permutation(wrong.ravel()).reshape(wrong.shape)
    image = picture(LIGHT, normals, inside)
    alike, apart = (estimate_light(image + each, normals, robust=False) for each in (wrong, alone))
    assert (alike.standard_errors > 2 * apart.standard_errors).all()


def test_odd_degrees_and_unseen_combinations_are_unobserved_and_never_zero():
    normals, inside = ball()
    image = picture(LIGHT, normals, inside)
    found = estimate_light(image, normals, degree=3)
    assert np.array_equal(found.determined, np.arange(16) < 9)
    assert np.isnan(found.coefficients[9:]).all()
    assert np.isinf(found.standard_errors[9:]).all()
    assert "unobserved" in str(found)
    same = np.broadcast_to([0.0, 0.0, 1.0], (*inside.shape, 3))
    flat = estimate_light(np.full(inside.shape, 2.0), same)
    assert not flat.determined[[0, 2, 6]].any()
    assert np.allclose(flat.irradiance(np.array([0.0, 0.0, 1.0])), 2.0)


def test_a_vague_coefficient_is_one_that_any_light_could_have(rng):
    normals, inside = ball()
    image = picture(LIGHT, normals, inside)
    sure = estimate_light(image + 1e-3 * rng.standard_normal(image.shape), normals)
    unsure = estimate_light(image + 30 * rng.standard_normal(image.shape), normals)
    assert not sure.vague.any()
    assert unsure.vague[6]


def test_cast_shadows_may_be_given_as_irradiance_under_each_harmonic(rng):
    normals, inside = ball()
    basis = np.zeros((16, *inside.shape))
    basis[:, inside] = rng.uniform(-1, 1, (16, inside.sum()))
    light = np.concatenate([LIGHT, rng.standard_normal(7)])
    image = np.tensordot(light, basis, axes=1)
    found = estimate_light(image, normals, degree=3, visibility=basis)
    assert np.abs(found.coefficients - light).max() < 1e-10
    low = found.up_to(2)
    assert np.array_equal(low.least_norm, found.least_norm[:9])
    assert np.allclose(low.covariance, found.covariance[:9, :9], rtol=1e-6)


def test_a_prior_fills_what_is_not_told_and_leaves_what_is():
    normals, inside = ball()
    image = picture(LIGHT, normals, inside)
    prior = LightPrior(np.eye(1, 16)[0], np.diag([0.0] + 15 * [0.05]))
    found = estimate_light(image, normals, degree=3, prior=prior)
    assert found.determined.all()
    assert np.abs(found.coefficients[:9] - LIGHT).max() < 1e-6
    assert np.allclose(found.coefficients[9:], 0, atol=1e-9)
    assert np.allclose(found.standard_errors[9:], np.sqrt(0.05) * LIGHT[0], rtol=1e-2)


def test_a_prior_by_degree_is_the_wiener_filter():
    """Where every normal counts the same, gain is `A^2 v / (A^2 v + s^2)` in each degree."""
    rule = gauss_legendre(12)
    some = np.random.default_rng(0).choice(
        len(rule.weights), 4000, p=rule.weights / rule.weights.sum()
    )
    normals = rule.directions[some]
    noise, power = 3.0, 0.04
    image = harmonic_irradiance(LIGHT, normals)
    prior = LightPrior(np.eye(1, 9)[0], np.diag([0.0] + 8 * [power]))
    found = estimate_light(image, normals, prior=prior, noise=noise, robust=False)
    told = 4000 / (4 * np.pi) * (np.pi / 4) ** 2 / noise**2
    gain = told / (told + 1 / (power * LIGHT[0] ** 2))
    assert gain < 0.95
    assert np.allclose(found.coefficients[4:], gain * LIGHT[4:], atol=0.04)


def test_priors_are_learned_from_maps(rng):
    sky = np.linspace(2, 0.1, 16)[:, None] * np.ones((16, 32))
    maps = [EnvironmentMap.from_image(sky * rng.uniform(0.9, 1.1, sky.shape)) for _ in range(8)]
    prior = LightPrior.learn(maps, 2)
    assert prior.mean[0] == pytest.approx(1)
    assert prior.mean[1] > 0.3
    turned = LightPrior.learn(maps, 2, rotations=True)
    assert np.array_equal(turned.mean, np.eye(1, 9)[0])
    assert np.allclose(np.diag(turned.covariance)[1:4], turned.covariance[1, 1])
    assert turned.covariance[1, 1] > 3 * prior.covariance[1, 1]


def test_non_negative_light_is_a_sum_of_lamps():
    normals, _ = ball()
    lamp = clamped_cosines(normals, np.array([[0.6, 0.0, 0.8]]))[0]
    found = estimate_light(lamp, normals, non_negative=True, robust=False)
    bound = np.sqrt([1, 3, 3, 3]) * found.least_norm[0] * (1 + 1e-6)
    assert (np.abs(found.least_norm[:4]) <= bound).all()
    assert np.linalg.norm(found.least_norm[1:4]) <= np.sqrt(3) * found.least_norm[0] * (1 + 1e-6)


def test_a_lamp_of_a_matte_ball_is_found_with_its_own_shadow():
    normals, _ = ball()
    lamp = np.array([0.48, 0.36, 0.8])
    found = estimate_light(clamped_cosines(normals, lamp[None])[0], normals)
    assert np.degrees(np.arccos(found.direction @ lamp)) < 3
    assert found.ambient_share < 0.2


def test_singular_values_are_those_of_the_theory():
    rule = gauss_legendre(10)
    values = singular_values(rule.directions, 2, rule.weights)
    expected = [0.886227] + 3 * [0.590818] + 5 * [0.221557]
    assert np.allclose(values, expected, atol=1e-6)
    normals, inside = ball(256)
    four = singular_values(normals[inside], 1)
    assert np.allclose(four, [1.1283, 0.5116, 0.5116, 0.1894], atol=0.015)


def test_one_light_for_pixels_without_a_picture(rng):
    normals = random_directions(500, rng)
    found = estimate_light(harmonic_irradiance(LIGHT, normals), normals)
    assert np.abs(found.coefficients - LIGHT).max() < 1e-10
    assert np.allclose(found.direction, LIGHT[[3, 1, 2]] / np.linalg.norm(LIGHT[1:4]), atol=0.01)


def test_large_pictures_agree_with_small_ones(rng):
    normals, inside = ball(400)
    image = picture(LIGHT, normals, inside) + 0.05 * rng.standard_normal(inside.shape)
    found = estimate_light(image, normals)
    off = (found.coefficients - LIGHT) / found.standard_errors
    assert np.abs(off).max() < 4
    exact = estimate_light(picture(LIGHT, normals, inside), normals)
    assert np.abs(exact.coefficients - LIGHT).max() < 1e-10


NORMALS, INSIDE = ball(12)
IMAGE = picture(LIGHT, NORMALS, INSIDE)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"image": IMAGE[:5]}, "size of the normals"),
        ({"image": IMAGE * np.nan}, "finite"),
        ({"image": (255 * IMAGE).astype(np.uint8)}, "divide codes"),
        ({"image": 0 * IMAGE}, "black everywhere"),
        ({"normals": 2 * NORMALS}, "unit vectors"),
        ({"albedo": -1.0}, "negative"),
        ({"albedo": np.ones((3, 3))}, "size of the normals"),
        ({"mask": np.zeros(INSIDE.shape, bool)}, "some of the surface"),
        ({"believed": np.zeros(INSIDE.shape, bool)}, "at least 9 pixels"),
        ({"believed": np.zeros(INSIDE.shape)}, "true or false"),
        ({"noise": 0.0}, "noise must be positive"),
        ({"degree": 11}, "at least 144 pixels"),
        ({"visibility": np.ones((4, *INSIDE.shape))}, "an image for each harmonic"),
        ({"degree": 3, "prior": LightPrior(np.eye(1, 9)[0], np.eye(9))}, "reach degree 3"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(changes, message):
    given = {"image": IMAGE, "normals": NORMALS, **changes}
    with pytest.raises(ArgumentError, match=message):
        estimate_light(given.pop("image"), given.pop("normals"), **given)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: LightPrior(np.ones(8), np.eye(8)), "square"),
        (lambda: LightPrior(np.ones(9), np.eye(4)), "shape"),
        (lambda: LightPrior(-np.ones(9), np.eye(9)), "positive"),
        (lambda: LightPrior.learn([EnvironmentMap.from_image(np.ones((8, 16)))], 2), "at least 2"),
        (lambda: LightPrior.learn(2 * [EnvironmentMap.from_image(np.zeros((8, 16)))], 2), "dark"),
        (lambda: singular_values(real_harmonics(NORMALS[INSIDE], 0)[..., None], 2), "shape"),
        (lambda: singular_values(NORMALS[INSIDE], 2, np.ones(3)), "weights must be one"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_of_priors_and_weights_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
