import numpy as np
import pytest

from data_synth import lightings
from harmface.errors import ArgumentError
from harmface.recognition import greedy_lights, nearest_lights, nine_points


def test_the_nine_points_are_those_published():
    assert np.allclose(nine_points(), lightings.nine_points().directions)


def test_each_direction_takes_its_nearest_light_on_the_grid():
    grid = lightings.yale64().directions
    taken = nearest_lights(grid, nine_points())
    assert np.array_equal(taken, (grid @ nine_points().T).argmax(axis=0))
    assert len(set(taken)) == 9


def test_no_light_is_taken_twice():
    available = np.array([[0.0, 0, 1], [0, 0.6, 0.8]])
    assert sorted(nearest_lights(available, np.array([[0.0, 0, 1], [0, 0, 1]]))) == [0, 1]


def test_greedy_choice_takes_new_images_near_the_harmonic_subspace():
    axes = np.eye(5)
    harmonic = axes[None, :3]
    off = 0.5 * axes[4]
    photographs = np.stack([axes[0] + off, axes[0], axes[3], axes[0] + 0.1 * axes[1], axes[1]])
    # The first is the second moved off the harmonic subspace, and the third has nothing of it;
    # with the second chosen, the fourth adds little to it and the fifth much.
    assert greedy_lights(photographs[None], harmonic, 2).tolist() == [1, 4]


def test_greedy_choice_repeats_no_light_when_none_adds_anything(rng):
    photographs = np.repeat(rng.random((2, 1, 9)), 3, axis=1)
    assert sorted(greedy_lights(photographs, rng.random((2, 2, 9)), 3)) == [0, 1, 2]


def test_greedy_choice_is_that_of_a_search_by_least_squares(rng):
    photographs, harmonic = rng.random((3, 7, 20)), rng.random((3, 4, 20))

    def distance(image, rows):
        if not len(rows):
            return np.linalg.norm(image)
        return np.sqrt(np.linalg.lstsq(rows.T, image, rcond=None)[1][0])

    chosen = []
    for _ in range(4):
        quality = [
            -1.0
            if j in chosen
            else sum(
                distance(own[j], own[chosen]) / distance(own[j], span)
                for own, span in zip(photographs, harmonic, strict=True)
            )
            for j in range(7)
        ]
        chosen.append(int(np.argmax(quality)))
    assert greedy_lights(photographs, harmonic, 4).tolist() == chosen


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: nearest_lights(np.eye(3)[:2], np.eye(3)), "a light for each of 3"),
        (lambda: nearest_lights(2 * np.eye(3), np.eye(3)), "available must be unit"),
        (lambda: nearest_lights(np.eye(3), 2 * np.eye(3)), "wanted must be unit"),
        (lambda: greedy_lights(np.ones((1, 4, 9)), np.ones((1, 2, 9)), 5), "at least 5 lights"),
        (lambda: greedy_lights(np.ones((2, 4, 9)), np.ones((1, 2, 9)), 2), "of the subjects"),
        (lambda: greedy_lights(np.full((1, 4, 9), np.nan), np.ones((1, 2, 9)), 2), "finite"),
        (lambda: greedy_lights(np.ones((1, 4, 9)), np.ones((1, 2, 9)), 0), "1 or more"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
