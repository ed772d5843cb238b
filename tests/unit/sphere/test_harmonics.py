import numpy as np
import pytest
from scipy.special import sph_harm_y

from harmface.conventions import angles_from_directions, degrees, orders
from harmface.errors import ArgumentError
from harmface.sphere import complex_harmonics, random_directions, real_harmonics
from harmface.sphere.harmonics import THREADS, block_size

MAX_DEGREE = 64


def hard_directions() -> np.ndarray:
    """Return directions everywhere, on the axes, and close to the poles and to the equator."""
    anywhere = random_directions(20, 1)
    near = [anywhere[:8] * squeeze for squeeze in ([1e-9, 1e-5, 1], [1e-3, 1e-3, 1], [1, 1, 1e-8])]
    points = np.concatenate([anywhere, *near, np.eye(3), -np.eye(3), [[0.6, 0.8, 0.0]]])
    return points / np.linalg.norm(points, axis=-1, keepdims=True)


def scipy_complex(directions: np.ndarray) -> np.ndarray:
    polar, azimuth = angles_from_directions(directions)
    degree, order = degrees(MAX_DEGREE)[:, np.newaxis], orders(MAX_DEGREE)[:, np.newaxis]
    # scipy overflows on the way to some values near the poles that then come out right.
    with np.errstate(all="ignore"):
        return sph_harm_y(degree, order, polar, azimuth)


def scipy_real(directions: np.ndarray) -> np.ndarray:
    order = orders(MAX_DEGREE)[:, np.newaxis]
    # R_lm = sqrt 2 (-1)^m Re Y_lm and R_l,-m = sqrt 2 (-1)^m Im Y_lm for m > 0.
    values = scipy_complex(directions)
    values = values[(degrees(MAX_DEGREE) ** 2 + degrees(MAX_DEGREE)) + abs(orders(MAX_DEGREE))]
    parts = np.where(order < 0, values.imag, values.real)
    return parts * np.where(order == 0, 1, np.sqrt(2) * (-1.0) ** order)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("harmonics", "oracle"), [(real_harmonics, scipy_real), (complex_harmonics, scipy_complex)]
)
def test_agrees_with_scipy_at_every_degree(harmonics, oracle, dtype):
    rounded = hard_directions().astype(dtype)
    exact = rounded.astype(np.float64)
    exact /= np.linalg.norm(exact, axis=-1, keepdims=True)
    error = np.abs(harmonics(rounded, MAX_DEGREE) - oracle(exact)).max(axis=-1)
    assert (error <= 64 * np.finfo(dtype).eps * (2 * degrees(MAX_DEGREE) + 1)).all()


@pytest.mark.parametrize("max_degree", [0, 1, 2, 3, 7])
def test_a_lower_degree_is_the_head_of_a_higher_one(max_degree):
    directions = random_directions(9, 2)
    head = real_harmonics(directions, 8)[: (max_degree + 1) ** 2]
    np.testing.assert_array_equal(real_harmonics(directions, max_degree), head)


@pytest.mark.parametrize("shape", [(), (0,), (5,), (2, 3), (2, 0, 3)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_harmonics_come_first_and_pixels_keep_their_shape(shape, dtype):
    directions = np.broadcast_to(np.array([0.0, 0.6, 0.8], dtype), (*shape, 3))
    result = real_harmonics(directions, 4)
    assert result.shape == (25, *shape)
    assert result.dtype == dtype


@pytest.mark.parametrize(("max_degree", "threads"), [(2, 1), (9, 1), (9, THREADS)])
def test_blocks_and_threads_meet_without_a_seam(max_degree, threads):
    directions = random_directions(threads * block_size(max_degree) + 3, 3).astype(np.float32)
    pieces = [real_harmonics(piece, max_degree) for piece in np.array_split(directions, 9)]
    whole = real_harmonics(directions, max_degree)
    np.testing.assert_array_equal(whole, np.concatenate(pieces, axis=1))


def test_directions_in_any_memory_layout():
    directions = random_directions(8, 4)
    wide = np.full((8, 6), np.nan)
    wide[:, ::2] = directions
    np.testing.assert_array_equal(real_harmonics(wide[:, ::2], 5), real_harmonics(directions, 5))


@pytest.mark.parametrize(("dtype", "greatest"), [(np.float32, 150), (np.float64, 1000)])
def test_the_greatest_degree_neither_overflows_nor_is_exceeded(dtype, greatest):
    directions = hard_directions()[[0, 21, 29, -7, -5]].astype(dtype)
    values = real_harmonics(directions, greatest)[greatest**2 :].astype(np.float64)
    # The addition theorem; the recurrence's error grows as the square of the degree.
    total = (values**2).sum(axis=0) * 4 * np.pi / (2 * greatest + 1)
    np.testing.assert_allclose(total, 1, atol=4 * greatest**2 * np.finfo(dtype).eps)
    with pytest.raises(ArgumentError, match=f"at most {greatest}"):
        real_harmonics(directions, greatest + 1)


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.0, 1.001])
@pytest.mark.parametrize("place", [0, -1])
def test_refuses_directions_that_are_not_unit(value, place):
    count = block_size(1) + 2
    directions = random_directions(count, 5)
    directions[place] = [0, 0, value]
    with pytest.raises(ArgumentError, match=f"directions must be unit .* 1 of {count}"):
        real_harmonics(directions, 1)


def test_counts_all_directions_that_are_not_unit():
    directions = random_directions(THREADS * block_size(9), 5).astype(np.float32)
    directions[[0, 1, -1]] *= 2
    with pytest.raises(ArgumentError, match="got 3 of"):
        real_harmonics(directions, 9)


def test_refuses_a_negative_degree():
    with pytest.raises(ArgumentError, match="max_degree must be 0 or more"):
        real_harmonics(random_directions(1, 0), -1)


def test_refuses_directions_without_three_components(unchecked):
    with pytest.raises(ArgumentError, match=r"directions must have shape \(..., 3\)"):
        real_harmonics(np.ones((4, 2)), 1)


@pytest.mark.parametrize("max_degree", [2, 100])
def test_directions_that_are_nearly_unit_are_brought_to_unit_length(max_degree):
    directions = random_directions(50, 6)
    stretch = 1 + 4e-5 * np.random.default_rng(0).uniform(-1, 1, (50, 1))
    exact = real_harmonics(directions, max_degree)
    found = real_harmonics(directions * stretch, max_degree)
    # A direction rounded otherwise changes a harmonic of degree l by up to l times its greatest
    # size; sqrt(l) is room for the recurrence.
    tolerance = 8 * np.finfo(float).eps * max_degree**1.5 * np.abs(exact).max()
    assert np.abs(found - exact).max() < tolerance
