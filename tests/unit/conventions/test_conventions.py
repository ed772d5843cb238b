import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface import conventions
from harmface.errors import ArgumentError
from harmface.sphere import random_directions


def test_flat_indices_count_up_through_degrees_and_orders():
    pairs = [(degree, order) for degree in range(6) for order in range(-degree, degree + 1)]
    indices = [conventions.flat_index(*pair) for pair in pairs]
    assert indices == list(range(36))
    assert [conventions.degree_order(index) for index in indices] == pairs
    assert list(zip(conventions.degrees(5), conventions.orders(5), strict=True)) == pairs


@pytest.mark.parametrize("max_degree", range(5))
def test_count_and_degree_are_inverse(max_degree):
    count = conventions.harmonic_count(max_degree)
    assert count == len(conventions.degrees(max_degree))
    assert conventions.max_degree_of(count) == max_degree


@pytest.mark.parametrize("count", [0, -1, -4, 2, 8])
def test_refuses_a_count_that_is_not_a_square(count):
    with pytest.raises(ArgumentError, match="must be a square"):
        conventions.max_degree_of(count)


@pytest.mark.parametrize("order", [-3, 3])
def test_refuses_an_order_beyond_the_degree(order):
    with pytest.raises(ArgumentError, match=r"order must lie in \[-2, 2\]"):
        conventions.flat_index(2, order)


def test_refuses_negative_degrees_and_indices():
    with pytest.raises(ArgumentError, match="index must be 0 or more"):
        conventions.degree_order(-1)
    for function in (conventions.harmonic_count, conventions.degrees, conventions.orders):
        with pytest.raises(ArgumentError, match="max_degree must be 0 or more"):
            function(-1)


def test_angles_are_from_z_and_from_x_towards_y():
    right, up, forward = np.eye(3)
    for polar, azimuth, expected in [
        (np.pi / 2, 0.0, right),
        (np.pi / 2, np.pi / 2, up),
        (0.0, 1.0, forward),
        (np.pi, 1.0, -forward),
    ]:
        direction = conventions.directions_from_angles(polar, azimuth)
        np.testing.assert_allclose(direction, expected, atol=1e-15)


def test_angles_and_directions_are_inverse():
    directions = random_directions(50, 1)
    near_z = directions[directions[:, 2] > 0] * [1e-7, 1e-7, 1]
    near_z /= np.linalg.norm(near_z, axis=-1, keepdims=True)
    for points, tolerance in [(directions, {"atol": 1e-15}), (near_z, {"rtol": 1e-15})]:
        back = conventions.directions_from_angles(*conventions.angles_from_directions(points))
        np.testing.assert_allclose(back, points, **tolerance)


@pytest.mark.parametrize(
    ("azimuth", "elevation"), [(0, 0), (30, 0), (0, 40), (-110, 65), (45, -20)]
)
def test_a_light_is_raised_and_then_turned(azimuth, elevation):
    # From the viewing axis: up about -x, then to the right about +y.
    placed = Rotation.from_euler("YX", [azimuth, -elevation], degrees=True).apply([0, 0, 1])
    direction = conventions.light_direction(float(azimuth), float(elevation))
    np.testing.assert_allclose(direction, placed, atol=1e-15)


def test_luminance_of_white_is_1_and_green_weighs_most():
    assert conventions.luminance(np.ones((1, 3))) == pytest.approx(1)
    red, green, blue = conventions.luminance(np.eye(3))
    assert blue < red < green


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_srgb_there_and_back(dtype):
    encoded = np.linspace(0, 1, 1001, dtype=dtype)
    linear = conventions.srgb_to_linear(encoded)
    assert linear.dtype == dtype
    # The published constants join the two pieces of the curve within 1e-7.
    atol = 1e-7 + 16 * np.finfo(dtype).eps
    np.testing.assert_allclose(conventions.linear_to_srgb(linear), encoded, atol=atol)
    assert (np.diff(linear) > 0).all()


def test_srgb_at_known_values():
    # Middle grey of 18 % is code 118 of 255; code 188 is half the light.
    codes = np.round(255 * conventions.linear_to_srgb(np.array([0.0, 0.18, 0.5, 1.0])))
    np.testing.assert_array_equal(codes, [0, 118, 188, 255])
