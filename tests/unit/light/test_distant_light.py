import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import DistantLight

AXES = np.eye(3)


def test_lights_join_and_grey_joins_as_white():
    red = DistantLight(AXES[:1], np.array([[1.0], [0.0], [0.0]]))
    grey = DistantLight(AXES[1:], np.array([2.0, 3.0]))
    both = red + grey
    np.testing.assert_array_equal(both.directions, AXES)
    np.testing.assert_array_equal(both.irradiances, [[1, 2, 3], [0, 2, 3], [0, 2, 3]])
    np.testing.assert_array_equal(both.total(), [6, 5, 5])


def test_rotated_lights_stand_at_the_rotated_directions():
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    light = DistantLight(AXES[:1], np.array([1.0])).rotated(quarter)
    np.testing.assert_array_equal(light.directions, AXES[1:2])


def test_dark_cells_keep_a_direction():
    light = DistantLight(AXES, np.zeros(3)).gathered(6)
    np.testing.assert_allclose(np.linalg.norm(light.directions, axis=1), 1)
    assert light.total() == 0


@pytest.mark.parametrize(
    ("directions", "irradiances", "said"),
    [
        (2 * AXES, np.ones(3), "unit"),
        (AXES, -np.ones(3), "negative"),
        (AXES, np.full(3, np.nan), "finite"),
        (AXES, np.ones(2), "agree"),
        (AXES[0], np.ones(3), "agree"),
    ],
)
def test_lights_that_make_no_sense_are_refused(unchecked, directions, irradiances, said):
    with pytest.raises(ArgumentError, match=said):
        DistantLight(directions, irradiances)
