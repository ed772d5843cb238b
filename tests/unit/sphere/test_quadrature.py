import numpy as np
import pytest

from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.sphere import Quadrature, gauss_legendre, lebedev, real_harmonics
from harmface.sphere.quadrature import LEBEDEV_ORDERS


@pytest.mark.parametrize("degree", [0, 1, 2, 5, 6, 13, 32, 64, 65])
@pytest.mark.parametrize("rule", [gauss_legendre, lebedev])
def test_integrates_every_harmonic_up_to_its_degree(rule, degree):
    quadrature = rule(degree)
    assert quadrature.degree >= degree
    integrals = real_harmonics(quadrature.directions, quadrature.degree) @ quadrature.weights
    expected = np.zeros_like(integrals)
    expected[0] = np.sqrt(4 * np.pi)
    # As accurate as the harmonics, times the area of the sphere.
    tolerance = 4 * np.pi * 64 * np.finfo(float).eps * (2 * degrees(quadrature.degree) + 1)
    assert (np.abs(integrals - expected) <= tolerance).all()


@pytest.mark.parametrize("degree", [4, 5, 8])
def test_gauss_legendre_is_no_better_than_it_says(degree):
    quadrature = gauss_legendre(degree)
    beyond = real_harmonics(quadrature.directions, degree + 2) @ quadrature.weights
    assert np.abs(beyond[(degree + 1) ** 2 :]).max() > 1e-3


@pytest.mark.parametrize("degree", [0, 4, 12, 13, 24, 26, 27, 40, 131])
def test_lebedev_weights_are_positive(degree):
    assert lebedev(degree).weights.min() > 0


@pytest.mark.parametrize("order", LEBEDEV_ORDERS)
def test_every_listed_order_is_a_rule_of_that_degree(order):
    rule = lebedev(order)
    assert rule.degree == order
    # Exact at its degree: the integral of z**n is 4 pi / (n + 1) for even n.
    even = order - order % 2
    moment = rule.directions[:, 2] ** even @ rule.weights
    assert moment == pytest.approx(4 * np.pi / (even + 1), rel=1e-12)
    if order < LEBEDEV_ORDERS[-1]:
        following = LEBEDEV_ORDERS[LEBEDEV_ORDERS.index(order) + 1]
        assert lebedev(order + 1).degree == following


def test_lebedev_takes_fewer_directions():
    assert lebedev(65).weights.size < 0.7 * gauss_legendre(65).weights.size


@pytest.mark.parametrize("rule", [gauss_legendre, lebedev])
def test_shared_rules_cannot_be_written_to(rule):
    with pytest.raises(ValueError, match="read-only"):
        rule(3).weights[0] = 1


def test_refuses_degrees_that_no_rule_has():
    with pytest.raises(ArgumentError, match="at most 131"):
        lebedev(132)
    for rule in (lebedev, gauss_legendre):
        with pytest.raises(ArgumentError, match="degree must be 0 or more"):
            rule(-1)


@pytest.mark.parametrize(
    ("directions", "weights", "message"),
    [
        (np.eye(3), np.ones(2), "weights of shape"),
        (np.eye(3)[np.newaxis], np.ones(1), "directions of shape"),
        (2 * np.eye(3), np.ones(3), "unit vectors"),
        (np.eye(3), np.full(3, np.nan), "weights must be finite"),
        (np.eye(3)[0], np.ones(()), "directions of shape"),
    ],
)
def test_refuses_what_is_not_a_quadrature(directions, weights, message, unchecked):
    with pytest.raises(ArgumentError, match=message):
        Quadrature(directions, weights, 2)
