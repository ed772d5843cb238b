import numpy as np
import pytest
from numpy.polynomial.legendre import legval
from scipy.optimize import minimize_scalar

from harmface.errors import ArgumentError
from harmface.light import hann_window, lanczos_window, non_negative_window, windowed
from harmface.reflectance import lambert_coefficients

COSINES = np.cos(np.linspace(0, np.pi, 4001))


def kernel(transfer, window):
    degree = np.arange(len(transfer))
    return legval(COSINES, (2 * degree + 1) / (4 * np.pi) * transfer * window)


@pytest.mark.parametrize("max_degree", [1, 2, 4, 9, 20])
@pytest.mark.parametrize("transfer", [lambert_coefficients, lambda n: np.ones(n + 1)])
def test_non_negative_window_leaves_no_kernel_below_zero(transfer, max_degree):
    transfer = transfer(max_degree)
    assert kernel(transfer, np.ones(len(transfer))).min() < -1e-3
    found = kernel(transfer, non_negative_window(transfer))
    assert found.min() > -1e-14 * found.max()
    # Nor does it fade more than needed: somewhere the kernel touches zero.
    assert found.min() < 1e-5 * found.max()


@pytest.mark.parametrize("seed", range(12))
def test_random_signed_transfers_come_to_touch_zero_and_no_more(seed):
    rng = np.random.default_rng(seed)
    transfer = np.concatenate([[1.0], rng.uniform(-1, 1, rng.integers(1, 8))])
    plain = kernel(transfer, np.ones(len(transfer)))
    window = non_negative_window(transfer)
    found = kernel(transfer, window)
    assert window[0] == 1
    assert found.min() > -1e-13 * found.max()
    if plain.min() < 0:
        assert found.min() < 1e-5 * found.max()
    else:
        np.testing.assert_array_equal(window, 1)


def test_no_other_window_changes_the_kernel_less():
    """Of windows that leave no kernel below zero, some 2000 at random, none is milder."""
    rng = np.random.default_rng(0)
    transfer = np.array([1.0, -0.7, 0.5, 0.4])
    weights = (2 * np.arange(4) + 1) * transfer**2  # of a degree in the mean square
    found = non_negative_window(transfer)
    least = weights @ (1 - found) ** 2
    others = np.column_stack([np.ones(2000), found[1:] + rng.normal(0, 0.2, (2000, 3))])
    allowed = [each for each in others if kernel(transfer, each).min() >= 0]
    assert len(allowed) > 50
    assert min(weights @ (1 - each) ** 2 for each in allowed) >= least * (1 - 1e-6)


def test_non_negative_window_of_degree_two_is_the_closed_form():
    """The nearest kernel is a (t - t0)**2 of mean 1/4: one number to search for."""

    def weights(root):
        scale = 0.25 / (1 / 3 + root**2)
        return np.array([-4 * scale * root, 32 * scale / 15])

    def distance(root):
        # Squared change of each degree's part of Lambert's kernel, 1/2 P_1 and 5/16 P_2.
        first, second = 1 - weights(root)
        return (first / 2) ** 2 * 2 / 3 + (second * 5 / 16) ** 2 * 2 / 5

    root = minimize_scalar(distance, bounds=(-1, 0), method="bounded", options={"xatol": 1e-10}).x
    found = non_negative_window(lambert_coefficients(2))
    # A least distance is flat about its minimum: 1e-10 of it is the root of that in the weights.
    np.testing.assert_allclose(found, [1, *weights(root)], atol=5e-5)


def test_kernels_that_are_not_negative_are_left_alone():
    np.testing.assert_array_equal(non_negative_window(np.array([3.0])), [1])
    np.testing.assert_array_equal(non_negative_window(np.array([3.0, 0.5])), [1, 1])


def test_degrees_that_are_not_transferred_keep_their_weight():
    window = non_negative_window(lambert_coefficients(5))
    np.testing.assert_array_equal(window[[0, 3, 5]], 1)
    assert (window[[1, 2, 4]] < 1).all()


def test_soft_windows():
    np.testing.assert_allclose(hann_window(2), [1, 0.75, 0.25])
    np.testing.assert_allclose(hann_window(3, width=2.0), [1, 0.5, 0, 0], atol=1e-16)
    third = np.pi / 3
    np.testing.assert_allclose(
        lanczos_window(2), [1, np.sin(third) / third, np.sin(2 * third) / (2 * third)]
    )
    np.testing.assert_array_equal(lanczos_window(3, width=1.5)[2:], 0)


def test_windows_weight_each_degree():
    found = windowed(np.ones((2, 9), np.float32), np.array([1.0, 0.5, 0.25]))
    np.testing.assert_array_equal(found, [[1, *[0.5] * 3, *[0.25] * 5]] * 2)
    assert found.dtype == np.float32


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: hann_window(2, width=0.0), "width"),
        (lambda: lanczos_window(2, width=np.nan), "width"),
        (lambda: lanczos_window(-1), "max_degree"),
        (lambda: non_negative_window(np.array([0.0, 1.0])), "first positive"),
        (lambda: non_negative_window(np.array([])), "first positive"),
        (lambda: non_negative_window(np.ones((2, 2))), "first positive"),
        (lambda: non_negative_window(np.array([1.0, np.nan])), "finite"),
        (lambda: windowed(np.ones(9), np.ones(2)), "3 weights"),
        (lambda: windowed(np.ones(8), np.ones(3)), "square"),
    ],
)
def test_windows_that_make_no_sense_are_refused(unchecked, call, said):
    with pytest.raises(ArgumentError, match=said):
        call()
