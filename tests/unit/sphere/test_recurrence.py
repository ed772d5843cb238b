import numpy as np
import pytest
from scipy.special import sph_harm_y

from harmface.conventions import angles_from_directions, degrees, orders
from harmface.sphere import random_directions
from harmface.sphere.recurrence import Recurrence, constants_to


def filled(directions, max_degree):
    out = np.full(((max_degree + 1) ** 2, len(directions)), np.nan, directions.dtype)
    Recurrence(np.ascontiguousarray(directions.T), max_degree).fill(out)
    return out


def by_scipy(directions, max_degree):
    polar, azimuth = angles_from_directions(directions)
    found = []
    for degree, order in zip(degrees(max_degree), orders(max_degree), strict=True):
        value = (-1.0) ** order * sph_harm_y(degree, abs(order), polar, azimuth)
        real = value.real if order >= 0 else value.imag
        found.append(real * (np.sqrt(2) if order else 1))
    return np.array(found)


@pytest.mark.parametrize("max_degree", [3, 4, 7, 20, 60])
def test_every_row_from_degree_three_is_the_harmonic(max_degree):
    directions = random_directions(50, 3)
    found = filled(directions, max_degree)
    tolerance = 64 * np.finfo(float).eps * (2 * degrees(max_degree) + 1)
    error = np.abs(found - by_scipy(directions, max_degree)).max(axis=1)
    assert (error[9:] <= tolerance[9:]).all()


def test_lower_degrees_are_left_to_the_closed_forms():
    assert np.isnan(filled(random_directions(5, 0), 5)[:9]).all()
    assert np.isnan(filled(random_directions(5, 0), 2)).all()


def test_poles_and_axes_are_points_like_any_other():
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    np.testing.assert_allclose(filled(axes, 12)[9:], by_scipy(axes, 12)[9:], atol=1e-13)


def test_a_block_is_worked_on_in_place():
    xyz = np.ascontiguousarray(random_directions(6, 1).T)
    recurrence = Recurrence(xyz, 5)
    first, second = np.empty((2, 36, 6))
    recurrence.fill(first)
    xyz[:] = random_directions(6, 2).T
    recurrence.fill(second)
    np.testing.assert_array_equal(second[9:], filled(np.ascontiguousarray(xyz.T), 5)[9:])
    assert np.abs(first - second)[9:].max() > 0.1


def test_constants_have_the_precision_asked_for():
    for dtype in (np.float32, np.float64):
        constants = constants_to(4, np.dtype(dtype))
        assert [each.degree for each in constants] == [2, 3, 4]
        assert {each.a.dtype for each in constants} == {np.dtype(dtype)}
        assert [each.b.shape for each in constants] == [(1, 1), (2, 1), (3, 1)]
