"""Tables of measured normals and directions."""

import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_measured_directions, read_measured_normals


def test_measured_normals_are_where_the_table_says(tmp_path):
    path = tmp_path / "normals.txt"
    path.write_text("# column row x y z\n3 0 0 0 2\n0 1 3 0 4\n")
    normals = read_measured_normals(path, (2, 4))
    assert normals.shape == (2, 4, 3)
    assert np.array_equal(np.argwhere(normals.any(axis=2)), [[0, 3], [1, 0]])
    assert normals[0, 3] == pytest.approx((0, 0, 1))
    assert normals[1, 0] == pytest.approx((0.6, 0, 0.8))


def test_measured_directions_are_of_the_photographs_numbered(tmp_path):
    path = tmp_path / "lamps.npy"
    np.save(path, np.array([[3, 0, 0, 5.0], [1, 0, -3, 4]]))
    directions = read_measured_directions(path, 3)
    assert np.allclose(directions, [[0, -0.6, 0.8], [0, 0, 0], [0, 0, 1]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("4 0 0 0 1", "pixels outside photographs of 4 x 2"),
        ("0 2 0 0 1", "pixels outside photographs of 4 x 2"),
        ("0 -1 0 0 1", "lines of column row x y z"),
        ("0.5 0 0 0 1", "lines of column row x y z"),
        ("0 1e30 0 0 1", "lines of column row x y z"),
        ("0 0 0 0 0", "a vector that is not zero"),
        ("0 0 0 1", "lines of column row x y z"),
        ("0 0 0 0 1\n0 0 0 1 1", "measures the same twice"),
        ("0 0 a b c", "not a table of numbers"),
    ],
)
def test_tables_of_normals_that_are_none_are_refused(tmp_path, text, message):
    path = tmp_path / "normals.txt"
    path.write_text(text + "\n")
    with pytest.raises(FileError, match=message):
        read_measured_normals(path, (2, 4))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 0 0 1", "photographs from 1 to 3"),
        ("4 0 0 1", "photographs from 1 to 3"),
        ("1 0 0", "lines of number x y z"),
    ],
)
def test_tables_of_directions_that_are_none_are_refused(tmp_path, text, message):
    path = tmp_path / "lamps.txt"
    path.write_text(text + "\n")
    with pytest.raises(FileError, match=message):
        read_measured_directions(path, 3)
