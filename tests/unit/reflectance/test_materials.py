"""Materials against quadrature, published values and the laws that any reflectance obeys."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import eval_legendre

from harmface.errors import ArgumentError
from harmface.reflectance import (
    GGX,
    Beckmann,
    Blinn,
    Lambert,
    Mirror,
    Mixture,
    OrenNayar,
    Phong,
    Tabulated,
    TorranceSparrow,
    lambert_coefficients,
    lobe_degree,
    material_named,
)
from harmface.reflectance.material import transfer_coefficients
from harmface.sphere import gauss_legendre, random_directions, real_harmonics

MATERIALS = [
    Lambert(0.7),
    OrenNayar(0.5),
    Phong(20),
    Blinn(30),
    GGX(0.3),
    GGX(0.6, 0.05),
    Beckmann(0.3),
    TorranceSparrow(0.3),
]
NAMES = [str(each) for each in MATERIALS]


@pytest.mark.parametrize(
    ("exponent", "published"),
    [
        (5, [0.857143, 0.625, 0.380952, 0.1875, 0.069264, 0.015625]),
        (20, [0.954545, 0.869565, 0.755682, 0.626087, 0.4941, 0.371014]),
        (100, [0.990196, 0.970874, 0.94259, 0.906149, 0.862559, 0.812993]),
    ],
)
def test_phong_factors_are_the_published_ones(exponent, published):
    np.testing.assert_allclose(Phong(exponent).radial(6)[1:], published, atol=5e-7)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 7.5, 300.0])
def test_phong_factors_are_the_integrals(exponent):
    found = Phong(exponent, 0.5).radial(9)
    for degree, value in enumerate(found):
        integral = quad(lambda c, n=degree: c**exponent * eval_legendre(n, c), 0, 1)[0]
        assert value == pytest.approx(0.5 * (exponent + 1) * integral, abs=1e-12)


def test_exponent_1_is_lambert():
    np.testing.assert_allclose(Phong(1).radial(8), lambert_coefficients(8) / np.pi, atol=1e-15)
    np.testing.assert_allclose(Lambert(0.5).radial(8), Phong(1, 0.5).radial(8), atol=1e-15)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 20.0, 1000.0])
def test_blinn_reflects_its_share_along_the_normal(exponent):
    np.testing.assert_allclose(Blinn(exponent, 0.4).radial(0), [0.4], rtol=1e-9)


@pytest.mark.parametrize("material", [GGX(0.2), Beckmann(0.2), TorranceSparrow(0.5)], ids=str)
def test_distributions_are_normalised_by_the_cosine(material):
    flat = quad(lambda c: 2 * np.pi * c * material.distribution(np.array([c]))[0], 0, 1, limit=200)[
        0
    ]
    assert flat == pytest.approx(1, abs=1e-7)


def test_the_lobe_is_the_integral_over_the_sphere():
    # The quadrature of the base class against one over directions.
    # Over the whole sphere the horizon's kink costs accuracy.
    rule = gauss_legendre(1200)
    up = np.array([0.0, 0.0, 1.0])
    cosine = np.maximum(rule.directions[:, 2], 0)
    for material in (OrenNayar(0.4), GGX(0.5, 0.1)):
        values = material.evaluate(rule.directions, up) * cosine * rule.weights
        expected = [values @ eval_legendre(n, rule.directions[:, 2]) for n in range(6)]
        np.testing.assert_allclose(material.radial(5), expected, atol=2e-5)


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_reflectance_is_reciprocal_and_not_negative(material):
    incoming, outgoing = random_directions(2000, 0), random_directions(2000, 1)
    there, back = material.evaluate(incoming, outgoing), material.evaluate(outgoing, incoming)
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-15)
    assert there.min() >= 0
    below = (incoming[:, 2] < 0) | (outgoing[:, 2] < 0)
    assert not there[below].any()
    assert there[~below].any()


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_no_more_is_reflected_than_came(material):
    rule = gauss_legendre(240)
    cosine = np.maximum(rule.directions[:, 2], 0)
    for angle in (0, 0.5, 1.0, 1.4):
        view = np.array([np.sin(angle), 0, np.cos(angle)])
        total = material.evaluate(rule.directions, view) * cosine @ rule.weights
        # Blinn's lobe is normalised along the normal only, and gains aslant.
        assert 0 < total <= (1.35 if isinstance(material, Blinn) else 1.0005)


def test_turning_both_directions_changes_nothing():
    incoming, outgoing = random_directions(500, 0), random_directions(500, 1)
    cosine, sine = np.cos(1.1), np.sin(1.1)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])
    for material in [*MATERIALS, table_of(GGX(0.5))]:
        np.testing.assert_allclose(
            material.evaluate(incoming @ turn.T, outgoing @ turn.T),
            material.evaluate(incoming, outgoing),
            rtol=1e-8,
            atol=1e-12,
        )


@pytest.mark.parametrize("material", [OrenNayar(0.5), Phong(20), GGX(0.5), Blinn(30)], ids=str)
def test_coefficients_are_the_integrals_over_both_directions(material):
    # Brute force over pairs of directions, without the azimuth's Fourier sum.
    found = material.coefficients(3, 4)
    count = 200
    nodes, weights = np.polynomial.legendre.leggauss(40)
    angle, measure = (nodes + 1) * np.pi / 4, weights * np.pi / 4
    azimuth = 2 * np.pi / count * (np.arange(count) + 0.5)
    sine = np.sin(angle)[:, None]
    grid = np.stack(
        np.broadcast_arrays(sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(angle)[:, None]),
        -1,
    )
    weight = (measure[:, None] * sine * np.ones(count) * 2 * np.pi / count).ravel()
    flat = grid.reshape(-1, 3)
    # One azimuth of the viewer is enough: with q = 0 and 2 the product tells the same.
    views = grid[:, 0]
    values = material.evaluate(flat, views[:, None]) * flat[:, 2] * weight
    incoming, outgoing = real_harmonics(flat, 3), real_harmonics(views, 4)
    out = measure * np.sin(angle) * 2 * np.pi
    half = azimuth[0]
    for l, p, q in ((0, 0, 0), (1, 2, 1), (2, 2, 2), (3, 4, 1), (2, 1, 0)):  # noqa: E741
        # Only the part cos(q phi) of the viewer's azimuth is left by the integral over it.
        wave = values @ incoming[l * (l + 1) + q]
        profile = outgoing[p * (p + 1) + q] / np.cos(q * half)
        other = values @ incoming[l * (l + 1) - q]
        turned = wave * np.cos(q * half) + (other * np.sin(q * half) if q else 0)
        brute = (turned * profile * out).sum() * (0.5 if q else 1.0)
        assert found[l, p, q] == pytest.approx(brute, abs=3e-3 * np.abs(found).max())


@pytest.mark.parametrize("material", [Lambert(), OrenNayar(0.5), Phong(20), GGX(0.5)], ids=str)
def test_times_the_outgoing_cosine_coefficients_are_reciprocal(material):
    class Symmetric(type(material)):
        def evaluate(self, incoming, outgoing):
            return super().evaluate(incoming, outgoing) * outgoing[..., 2]

    names = material.__dataclass_fields__
    found = transfer_coefficients(Symmetric(*(getattr(material, each) for each in names)), 5, 5, 64)
    np.testing.assert_allclose(found, found.swapaxes(0, 1), atol=1e-10)
    plain = transfer_coefficients(material, 5, 5, 64)
    assert np.abs(plain - plain.swapaxes(0, 1)).max() > 1e-3


def test_lambert_coefficients_have_order_0_only():
    found = Lambert().coefficients(4, 4)
    assert np.abs(found[..., 1:]).max() < 1e-12
    assert found[0, 0, 0] == pytest.approx(0.5)


def test_a_mixture_is_the_sum_of_its_parts():
    skin = Mixture((Lambert(), GGX(0.4)), (np.array([0.6, 0.4, 0.3]), 0.05))
    incoming, outgoing = random_directions(50, 0), random_directions(50, 1)
    one, two = Lambert().evaluate(incoming, outgoing), GGX(0.4).evaluate(incoming, outgoing)
    found = skin.evaluate(incoming, outgoing)
    np.testing.assert_allclose(found[1], 0.4 * one + 0.05 * two)
    rho = skin.coefficients(2, 2)
    assert rho.shape == (3, 3, 3, 3)
    expected = 0.3 * Lambert().coefficients(2, 2) + 0.05 * GGX(0.4).coefficients(2, 2)
    np.testing.assert_allclose(rho[2], expected, atol=2e-3 * np.abs(expected).max())


def table_of(material, shape=(90, 90, 180)):
    """Tabulate a material at the middles of the bins."""
    half = ((np.arange(shape[0]) + 0.5) / shape[0]) ** 2 * np.pi / 2
    apart = (np.arange(shape[1]) + 0.5) / shape[1] * np.pi / 2
    azimuth = (np.arange(shape[2]) + 0.5) / shape[2] * np.pi
    h, d, a = np.meshgrid(half, apart, azimuth, indexing="ij")
    local = np.stack([np.sin(d) * np.cos(a), np.sin(d) * np.sin(a), np.cos(d)], -1)

    def world(v):
        x = np.cos(h) * v[..., 0] + np.sin(h) * v[..., 2]
        return np.stack([x, v[..., 1], np.cos(h) * v[..., 2] - np.sin(h) * v[..., 0]], -1)

    incoming, outgoing = world(local), world(local * [-1, -1, 1])
    measured = (incoming[..., 2] > 0) & (outgoing[..., 2] > 0)
    return Tabulated(material.evaluate(incoming, outgoing), measured)


def test_a_table_gives_back_what_it_was_made_of():
    material = GGX(0.5, 0.5)
    table = table_of(material)
    assert table.missing > 0
    incoming, outgoing = random_directions(20000, 0), random_directions(20000, 1)
    steep = (incoming[:, 2] > 0.15) & (outgoing[:, 2] > 0.15)
    expected = material.evaluate(incoming[steep], outgoing[steep])
    found = table.evaluate(incoming[steep], outgoing[steep])
    assert np.abs(found / expected - 1).max() < 0.05
    assert np.abs(found / expected - 1).mean() < 0.002


def test_degrees_for_an_accuracy_hold_it():
    material = Phong(50)
    degree = lobe_degree(material, 0.01, most=99)
    factors = material.radial(200)
    assert np.abs(factors[degree + 1 :]).max() <= 0.01 < np.abs(factors[degree:]).max()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Lambert(1.5), "albedo must lie in"),
        (lambda: OrenNayar(-0.1), "roughness must be 0 or more"),
        (lambda: Phong(float("inf")), "exponent must lie in"),
        (lambda: Blinn(-1), "exponent must lie in"),
        (lambda: GGX(-0.1), "roughness must lie in"),
        (lambda: GGX(float("nan")), "roughness must lie in"),
        (lambda: Beckmann(0.3, 2.0), "reflectance must lie in"),
        (lambda: Mirror(-1), "share must lie in"),
        (lambda: Mirror().evaluate(np.eye(3), np.eye(3)), "mirror has no reflectance"),
        (lambda: Mixture((), ()), "a scale for each"),
        (lambda: Mixture((Lambert(),), (-1.0,)), "scales must not be negative"),
        (lambda: Phong(1e5).coefficients(4, 4), "do not settle"),
        (lambda: lobe_degree(Phong(5000), 0.01, most=20), "beyond degree 20"),
        (lambda: lobe_degree(Phong(5), 1.0, most=20), "accuracy must lie"),
        (lambda: material_named("gold"), "there is no material 'gold'"),
        (lambda: material_named("ggx"), "needs a number"),
        (lambda: material_named("phong:many"), "needs a number"),
        (lambda: Tabulated(np.ones((2, 2, 2)), np.zeros((2, 2, 2), bool)), "some measurement"),
        (lambda: Tabulated(-np.ones((2, 2, 2)), np.ones((2, 2, 2), bool)), "must not be negative"),
    ],
)
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
