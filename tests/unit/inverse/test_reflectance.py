"""Reflectance and light from what is reflected."""

import numpy as np
import pytest

from data_synth.shapes import sphere
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.geometry import frame_orthographic, gbuffer
from harmface.inverse import (
    consistent_light,
    estimate_reflectance,
    factorize,
    field_from_samples,
    fit_material,
    reflected_field,
)
from harmface.light import DistantLight, directional_lights
from harmface.reflectance import GGX, Lambert, Phong
from harmface.rendering import render
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, frames_facing, random_directions

LAMP = DistantLight(np.array([[np.sin(0.6), 0, np.cos(0.6)]]), np.array([3.0]))


def symmetric(material, degree):
    """Return coefficients of a material times the outgoing cosine."""
    from harmface.reflectance.material import transfer_coefficients

    class Reciprocal(type(material)):
        def evaluate(self, incoming, outgoing):
            return super().evaluate(incoming, outgoing) * outgoing[..., 2]

    fields = [getattr(material, name) for name in material.__dataclass_fields__]
    return transfer_coefficients(Reciprocal(*fields), degree, degree, 48)


def orders_that_exist(degree):
    row, column, q = np.indices((degree + 1,) * 3)
    return (q <= np.minimum(row, column))[degrees(degree)]


def some_light(degree, rng):
    light = rng.standard_normal((degree + 1) ** 2) / (1 + degrees(degree))
    light[0] = 3
    return light / np.linalg.norm(light)


def test_division_gives_back_the_material_and_its_errors_cover(rng):
    rho, light = Phong(20).coefficients(4, 4), some_light(4, rng)
    field = reflected_field(light, rho)
    exact = estimate_reflectance(field, light)
    np.testing.assert_allclose(exact.rho, rho, atol=1e-12)
    inside = []
    for _ in range(30):
        noisy = field + 0.01 * rng.standard_normal(field.shape)
        found = estimate_reflectance(noisy, light, noise=0.01)
        inside.append(np.abs(found.rho - rho) < 1.96 * found.standard_errors)
    # 30 times 125 coefficients: five standard deviations of their share.
    assert np.mean(inside) == pytest.approx(0.95, abs=0.018)


def test_a_lamp_determines_what_soft_light_does_not():
    rho = Phong(20).coefficients(4, 4)
    lamp = directional_lights(LAMP, 4)
    soft = np.zeros(25)
    soft[:9] = lamp[:9]
    told = [
        estimate_reflectance(reflected_field(each, rho), each, noise=0.01) for each in (lamp, soft)
    ]
    assert told[0].determined.all()
    np.testing.assert_array_equal(told[1].determined, [True] * 3 + [False] * 2)
    assert np.isinf(told[1].standard_errors[3:]).all()
    # A lamp has (2l + 1) / (4 pi) of its power squared in each degree: high ones tell the more.
    expected = 0.01 * np.sqrt(4 * np.pi / (2 * np.arange(5) + 1)) / 3
    np.testing.assert_allclose(told[0].standard_errors[:, 0, 0], expected)


def test_samples_from_many_sides_give_the_field(rng):
    light, rho = some_light(2, rng), Lambert().coefficients(2, 2)
    normals, towards = random_directions(400, 0), random_directions(400, 1)
    frames = frames_facing(normals, random_directions(400, 2))
    local = np.einsum("pij,pi->pj", frames, towards)
    from harmface.sphere import mixed_functions

    field = reflected_field(light, rho)
    radiance = np.einsum("kpq,kpqn->n", field, mixed_functions(frames, local, 2, 2))
    found = field_from_samples(radiance, frames, local, 2, 2)
    np.testing.assert_allclose(found, field, atol=1e-10)
    with pytest.raises(ArgumentError, match="20 samples determine 20 of 48"):
        field_from_samples(radiance[:20], frames[:20], local[:20], 2, 2)


def test_a_field_is_factorised_exactly(rng):
    rho, light = symmetric(GGX(0.4), 5), some_light(5, rng)
    found = factorize(reflected_field(light, rho))
    assert found.determined.all()
    assert found.second.max() < 1e-12
    np.testing.assert_allclose(found.light, light, atol=1e-8)
    np.testing.assert_allclose(found.rho, rho, atol=1e-8 * np.abs(rho).max())


def test_two_lights_do_not_factorise(rng):
    one, two = (reflected_field(some_light(3, rng), symmetric(m, 3)) for m in (Phong(5), GGX(0.5)))
    assert factorize(one + two).second.max() > 1e-3


def test_error_bars_of_a_factorisation_cover(rng):
    rho, light = symmetric(GGX(0.4), 4), some_light(4, rng)
    field, exists = reflected_field(light, rho), orders_that_exist(4)
    noise = 0.01 * np.sqrt(np.mean(field[exists] ** 2))
    inside = []
    for seed in range(20):
        noisy = field + noise * exists * rng.standard_normal(field.shape)
        found = factorize(noisy, noise=noise, rng=seed)
        assert found.determined.all()
        inside += list(np.abs(found.light - light) < 1.96 * found.light_errors)
        known = found.rho_errors > 0
        inside += list((np.abs(found.rho - rho) < 1.96 * found.rho_errors)[known])
    assert 0.92 < np.mean(inside) < 0.98


def test_degrees_that_nothing_ties_are_named(rng):
    # Lambert's odd degrees above 1 reflect nothing: their light is not determined.
    found = factorize(reflected_field(some_light(3, rng), symmetric(Lambert(), 3)))
    np.testing.assert_array_equal(found.determined, [True, True, True, False])
    assert np.isinf(found.light_errors[9:]).all()
    assert not found.light[9:].any()


def test_photographs_of_one_light_are_consistent_and_others_not(rng):
    objects = [Phong(8).radial(3)[degrees(3)], Phong(40).radial(3)[degrees(3)]]
    lights = [some_light(3, rng) for _ in range(3)]
    errors = np.full((2, 16), 1e-3)

    def photograph(*lit):
        exact = np.stack([r * light for r, light in zip(objects, lit, strict=True)])
        return exact + errors * rng.standard_normal(exact.shape)

    levels = []
    for _ in range(200):
        first, second = photograph(lights[0], lights[0]), photograph(lights[1], lights[1])
        levels.append(consistent_light(first, second, errors, errors).p_value)
    # At the level of 5 % some 5 % are doubted: 200 trials, three standard deviations.
    assert np.mean(np.array(levels) < 0.05) < 0.1
    pasted = photograph(lights[1], lights[2])
    assert consistent_light(first, pasted, errors, errors).p_value < 1e-6


@pytest.mark.parametrize(
    ("make", "value", "bounds"), [(Phong, 35.0, (1, 500)), (GGX, 0.27, (0.05, 1))]
)
def test_a_lobe_is_fitted_to_a_rendering_of_a_sphere(make, value, bounds, rng):
    mesh = mesh_of(sphere())
    view = gbuffer(mesh, frame_orthographic(mesh, 20))
    inner = view.normals[..., 2] > 0.2
    normals = view.normals[inner]
    towards = np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
    directions = fibonacci_directions(120)
    soft = DistantLight(directions, np.exp(2 * directions[:, 1]) * 4 * np.pi / 120)
    widths = []
    for light in (LAMP, soft):
        ground = render(view, light, albedo=np.full(view.mask.shape, 0.4))
        coat = render(view, light, albedo=np.full(view.mask.shape, 0.3), material=make(value))
        image = (ground + coat)[inner] / np.pi
        image = image + 0.01 * image.mean() * rng.standard_normal(image.shape)
        fit = fit_material(make, bounds, normals, towards, image, light)
        low, high = fit.interval
        assert low < fit.value < high
        # An interval at 95 % may miss: it is widened to 99.99 %, as the likelihood's width.
        wide = fit_material(
            make, bounds, normals, towards, image, light, confidence=0.9999
        ).interval
        assert wide[0] < value < wide[1]
        widths.append(np.log(high / low))
        if light is LAMP:
            assert fit.value == pytest.approx(value, rel=0.05)
            assert fit.diffuse == pytest.approx(0.4, rel=0.05)
            assert fit.specular == pytest.approx(0.3, rel=0.05)
    assert widths[1] > 3 * widths[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: estimate_reflectance(np.ones((4, 2, 2)), np.zeros(4)), "must not be dark"),
        (lambda: estimate_reflectance(np.ones((9, 2, 2)), np.ones(4)), "field must have shape"),
        (lambda: factorize(np.ones((4, 2, 3))), "degrees l and p alike"),
        (lambda: factorize(np.ones((1, 1, 1))), "degree 1 or more"),
        (lambda: factorize(np.zeros((4, 2, 2))), "field must not be dark"),
        (
            lambda: consistent_light(*[np.ones((2, 4))] * 3, np.zeros((2, 4))),
            "standard errors above 0",
        ),
        (lambda: consistent_light(*[np.ones((2, 4))] * 4), "lost in noise"),
        (
            lambda: fit_material(Phong, (0, 1), *[np.eye(3)] * 2, np.ones(3), LAMP),
            "bounds must be",
        ),
        (
            lambda: fit_material(Phong, (1, 9), *[np.eye(3)] * 2, np.ones(3), LAMP),
            "3 lit pixels",
        ),
    ],
)
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
