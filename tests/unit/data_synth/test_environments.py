"""Environments: maps and rules against each other, skies against the CIE's formulas."""

import math

import numpy as np
import pytest
from scipy.special import sph_harm_y

from data_synth.environments import (
    ENVIRONMENTS,
    Environment,
    clear_sky,
    latlong_directions,
    overcast_sky,
    quadrature,
    random_field,
    rasterise,
)
from data_synth.environments.rules import sphere_rule
from data_synth.environments.sky import GROUND_ALBEDO, LUMINANCE, SUN_RADIUS


def harmonics(directions: np.ndarray, max_degree: int) -> dict[tuple[int, int], np.ndarray]:
    """Complex harmonics of orders m >= 0, enough for real functions."""
    polar = np.arccos(np.clip(directions[:, 2], -1, 1))
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    return {
        (degree, order): sph_harm_y(degree, order, polar, azimuth)
        for degree in range(max_degree + 1)
        for order in range(degree + 1)
    }


def project(directions: np.ndarray, weights: np.ndarray, radiance: np.ndarray) -> np.ndarray:
    """Nine real numbers for each channel, those of m > 0 scaled to keep the norm."""
    rows = []
    for (_, order), harmonic in harmonics(directions, 2).items():
        rows.append(harmonic.real if order == 0 else np.sqrt(2) * harmonic.real)
        if order:
            rows.append(np.sqrt(2) * harmonic.imag)
    return (np.array(rows) * weights) @ radiance


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def pixel_solid_angles(height: int) -> np.ndarray:
    rows = np.pi / height * -np.diff(np.cos(np.pi * np.arange(height + 1) / height))
    return np.repeat(rows, 2 * height)


def custom(radiance) -> Environment:
    return Environment("custom", radiance, sphere_rule, 8)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_radiance_is_finite_and_non_negative_in_every_direction(name: str) -> None:
    environment = ENVIRONMENTS[name]()
    assert environment.name == name
    directions = np.random.default_rng(1).standard_normal((50, 40, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    directions[0, :6] = [*np.eye(3), *-np.eye(3)]
    radiance = environment.radiance(directions)
    assert radiance.shape == (50, 40, 3)
    assert np.isfinite(radiance).all()
    assert (radiance >= 0).all()
    np.testing.assert_allclose(environment.radiance(directions[0, 0]), radiance[0, 0], rtol=1e-12)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_a_map_of_512_x_256_has_the_coefficients_of_the_rule(name: str) -> None:
    environment = ENVIRONMENTS[name]()
    directions, solid_angles = quadrature(environment)
    # A panel of three nodes and distance cubed below: the solid angle itself is integrated.
    assert abs(solid_angles.sum() / (4 * np.pi) - 1) < 1e-6
    assert (solid_angles > 0).all()
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, atol=1e-14)
    by_rule = project(directions, solid_angles, environment.radiance(directions))

    finer = environment.rule(environment.nodes + 1)
    assert relative(by_rule, project(*finer, environment.radiance(finer[0]))) < 1e-5

    image = rasterise(environment, 256)
    assert image.shape == (256, 512, 3)
    assert image.min() >= 0
    centres = latlong_directions(256).reshape(-1, 3)
    by_map = project(centres, pixel_solid_angles(256), image.reshape(-1, 3))
    assert relative(by_map, by_rule) < 1e-4


def test_quadrature_refines() -> None:
    environment = overcast_sky()
    coarse, fine = quadrature(environment), quadrature(environment, 2)
    assert len(fine[1]) == 4 * len(coarse[1])


def test_latlong_layout_is_that_of_openexr() -> None:
    directions = latlong_directions(64)
    # Pixel centres lie half a pixel from the axes: an angle of pi / 128 in row and column.
    near = np.cos(np.pi / 128) ** 2 - 1e-12
    assert directions[31, 63] @ [0, 0, 1] > near
    assert directions[31, 31] @ [1, 0, 0] > near
    assert directions[31, 95] @ [-1, 0, 0] > near
    assert directions[31, 0] @ [0, 0, -1] > near
    assert directions[0, 5] @ [0, 1, 0] > near
    assert (np.diff(directions[:, 0, 1]) < 0).all()


def test_a_map_shows_the_world_where_its_pixels_look() -> None:
    lobe = np.array([2.0, -1.0, 3.0]) / np.sqrt(14)
    image = rasterise(custom(lambda d: np.exp(20 * (d @ lobe - 1))[..., None] * np.ones(3)), 32)
    brightest = np.unravel_index(image[..., 0].argmax(), (32, 64))
    assert latlong_directions(32)[brightest] @ lobe > np.cos(np.pi / 32)


def test_pixels_are_averages_over_their_solid_angle() -> None:
    image = rasterise(custom(lambda d: d[..., 1:2] ** 2 * np.ones(3)), 16)
    z = np.cos(np.pi * np.arange(17) / 16)
    exact = np.diff(z**3) / (3 * np.diff(z))
    # Five points in each of 16 rows: second order in a step of 1 / 80 of the pixel, pi / 16.
    np.testing.assert_allclose(image[:, 7, 1], exact, atol=(np.pi / 16 / 80) ** 2)


@pytest.mark.parametrize("height", [8, 46])
def test_a_map_keeps_the_flux_of_what_is_smaller_than_a_pixel(height: int) -> None:
    sun, sky = rasterise(clear_sky(), height), rasterise(clear_sky(disc=False), height)
    difference = np.where(latlong_directions(height)[..., 1:2] > 0, sun - sky, 0.0)
    flux = pixel_solid_angles(height) @ difference.reshape(-1, 3)
    directions, weights = quadrature(clear_sky())
    extra = clear_sky().radiance(directions) - clear_sky(disc=False).radiance(directions)
    exact = (weights * (directions[:, 1] > 0)) @ extra
    np.testing.assert_allclose(flux, exact, rtol=1e-3)


def test_a_dark_world_has_a_black_map() -> None:
    np.testing.assert_array_equal(rasterise(custom(np.zeros_like), 4), np.zeros((4, 8, 3)))


def test_overcast_sky_is_three_times_as_bright_at_the_zenith() -> None:
    sky = overcast_sky(zenith=2.0)
    altitudes = np.radians([90.0, 30.0, 1e-6])
    directions = np.stack([np.cos(altitudes), np.sin(altitudes), np.zeros(3)], axis=1)
    np.testing.assert_allclose(sky.radiance(directions) @ LUMINANCE, [2.0, 4 / 3, 2 / 3], rtol=1e-7)


def test_overcast_ground_is_lit_by_seven_ninths_of_pi() -> None:
    sky = overcast_sky()
    directions, weights = quadrature(sky)
    light = sky.radiance(directions)
    irradiance = (weights * np.maximum(directions[:, 1], 0)) @ light
    np.testing.assert_allclose(irradiance @ LUMINANCE, 7 * np.pi / 9, rtol=1e-8)
    ground = sky.radiance(np.array([0.0, -1.0, 0.0]))
    np.testing.assert_allclose(np.pi * ground / irradiance, GROUND_ALBEDO, rtol=1e-8)


@pytest.mark.parametrize("azimuth", [0.0, 75.0, 180.0])
@pytest.mark.parametrize("altitude", [5.0, 40.0, 90.0])
def test_clear_sky_luminance_is_the_formula_of_the_cie(azimuth: float, altitude: float) -> None:
    sun = (20.0, 35.0)
    sky = clear_sky(sun, disc=False, zenith=3.0)

    def unit(azimuth: float, altitude: float) -> list[float]:
        a, h = math.radians(azimuth), math.radians(altitude)
        return [math.sin(a) * math.cos(h), math.sin(h), math.cos(a) * math.cos(h)]

    def scatter(chi: float) -> float:
        return 1 + 10 * (math.exp(-3 * chi) - math.exp(-1.5 * math.pi)) + 0.45 * math.cos(chi) ** 2

    direction, sunward = unit(azimuth, altitude), unit(*sun)
    chi = math.acos(sum(a * b for a, b in zip(direction, sunward, strict=True)))
    sun_zenith = math.radians(90 - sun[1])
    gradation = (1 - math.exp(-0.32 / direction[1])) / (1 - math.exp(-0.32))
    expected = 3.0 * gradation * scatter(chi) / scatter(sun_zenith)
    found = sky.radiance(np.array(direction)) @ LUMINANCE
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize("sun", [(0.0, 90.0), (-35.0, 40.0), (120.0, 8.0)])
def test_the_disc_lights_the_ground_by_its_share(sun: tuple[float, float]) -> None:
    with_disc, without = clear_sky(sun, sun_share=5.0), clear_sky(sun, disc=False)
    directions, weights = quadrature(with_disc)
    lit = weights * np.maximum(directions[:, 1], 0)
    sky = lit @ without.radiance(directions) @ LUMINANCE
    total = lit @ with_disc.radiance(directions) @ LUMINANCE
    ground = with_disc.radiance(np.array([0.0, -1.0, 0.0]))
    irradiance = lit @ with_disc.radiance(directions)
    np.testing.assert_allclose(np.pi * ground / irradiance, GROUND_ALBEDO, rtol=2e-5)
    # The share is set for the disc's centre; over its radius of 4.7 mrad the cosine is level
    # but for a part in 1e5.
    np.testing.assert_allclose(total - sky, 5.0 * sky, rtol=2e-5)


def test_the_disc_is_half_a_degree_wide() -> None:
    # Between 0.524 degrees in July and 0.542 in January.
    assert 0.524 < np.degrees(2 * SUN_RADIUS) < 0.542
    sky = clear_sky((0.0, 90.0))
    angles = SUN_RADIUS * np.array([0.0, 0.7, 1.0, 1.3])
    directions = np.stack([np.sin(angles), np.cos(angles), np.zeros(4)], axis=1)
    luminance = sky.radiance(directions) @ LUMINANCE
    np.testing.assert_allclose(luminance[:3] / luminance[0], [1.0, 1.0, 0.5], rtol=1e-3)
    assert luminance[3] < 1e-3 * luminance[0]


def test_random_field_has_a_spectrum_of_one_over_l_squared() -> None:
    seeds, max_degree, contrast = 60, 8, 0.8
    directions, weights = sphere_rule(max_degree + 1)
    rows = harmonics(directions, max_degree)
    power = np.zeros(max_degree + 1)
    for seed in range(seeds):
        field = random_field(seed, max_degree=max_degree, contrast=contrast, tint=0.0)
        log = np.log(field.radiance(directions)[:, 0])
        for (degree, order), harmonic in rows.items():
            share = (2 - (order == 0)) / (2 * degree + 1) / seeds
            power[degree] += share * abs((harmonic * weights) @ log) ** 2
    degree = np.arange(1, max_degree + 1)
    expected = 1 / degree**2
    expected *= 4 * np.pi * contrast**2 / ((2 * degree + 1) * expected).sum()
    # Mean square of seeds x (2 l + 1) nearly normal coefficients.
    error = np.sqrt(2 / (seeds * (2 * degree + 1)))
    assert (np.abs(power[1:] / expected - 1) < 4 * error).all()
    assert power[0] < 1e-20


def test_random_field_follows_its_seed_and_is_grey_without_tint() -> None:
    directions = latlong_directions(8)
    once, again = random_field(3), random_field(np.random.default_rng(3))
    assert once.radiance(directions).tobytes() == again.radiance(directions).tobytes()
    assert not np.array_equal(once.radiance(directions), random_field(4).radiance(directions))
    grey = random_field(3, tint=0.0).radiance(directions)
    np.testing.assert_array_equal(grey, grey[..., :1] * np.ones(3))
    assert np.ptp(once.radiance(directions), axis=-1).max() > 0.1


@pytest.mark.parametrize(
    ("call", "complaint"),
    [
        (lambda: quadrature(overcast_sky(), 0), "refinement must be"),
        (lambda: rasterise(overcast_sky(), 3), "height must be"),
        (lambda: latlong_directions(0), "height must be"),
        (lambda: overcast_sky(zenith=0.0), "zenith must be"),
        (lambda: clear_sky(zenith=np.inf), "zenith must be"),
        (lambda: clear_sky((0.0, 0.0)), "sun must be"),
        (lambda: clear_sky((0.0, 91.0)), "sun must be"),
        (lambda: clear_sky((np.nan, 40.0)), "sun must be"),
        (lambda: clear_sky(sun_share=0.0), "sun_share must be"),
        (lambda: random_field(max_degree=0), "max_degree must be"),
        (lambda: random_field(contrast=0.0), "contrast must be"),
        (lambda: random_field(contrast=2.1), "contrast must be"),
        (lambda: random_field(tint=-0.1), "tint must be"),
    ],
)
def test_environments_refuse_nonsense(call, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        call()
