import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.stats import kstest

from harmface.errors import ArgumentError
from harmface.sphere import fibonacci_directions, random_directions, real_harmonics


@pytest.mark.parametrize("count", [1, 2, 1000])
def test_directions_are_unit_vectors(count):
    for directions in (fibonacci_directions(count), random_directions(count, 1)):
        assert directions.shape == (count, 3)
        np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1, rtol=1e-15)


def test_fibonacci_directions_keep_their_distance():
    count = 1000
    directions = fibonacci_directions(count)
    nearest = cKDTree(directions).query(directions, k=2)[0][:, 1]
    # A hexagonal grid of this density has this spacing. With the golden angle no two points come
    # closer than 0.81 of it; with the angle from the root of 6 instead of 5, 0.73.
    hexagonal = np.sqrt(8 * np.pi / (np.sqrt(3) * count))
    assert 0.8 * hexagonal < nearest.min()
    assert nearest.max() < hexagonal


def test_the_mean_over_fibonacci_directions_approaches_that_over_the_sphere():
    count = 1000
    means = real_harmonics(fibonacci_directions(count), 6).mean(axis=-1)
    # Random directions would leave 1 / sqrt(4 pi count), about 0.009.
    assert np.abs(means[1:]).max() < 1 / count


def test_random_directions_are_uniform():
    directions = random_directions(5000, 7)
    for component in directions.T:
        assert kstest(component, "uniform", args=(-1, 2)).pvalue > 0.01


def test_the_same_seed_gives_the_same_bytes():
    assert random_directions(9, 3).tobytes() == random_directions(9, 3).tobytes()
    assert random_directions(9, 3).tobytes() != random_directions(9, 4).tobytes()
    generator = np.random.default_rng(3)
    assert random_directions(9, generator).tobytes() == random_directions(9, 3).tobytes()
    assert random_directions(9, generator).tobytes() != random_directions(9, 3).tobytes()


def test_refuses_no_directions_and_no_seed():
    with pytest.raises(ArgumentError, match="count must be 1 or more"):
        fibonacci_directions(0)
    with pytest.raises(ArgumentError, match="count must be 1 or more"):
        random_directions(0, 1)
    with pytest.raises(ArgumentError, match="seed of 0 or more"):
        random_directions(1, -1)
