"""What counts as visible."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.pca.pixels import visible_pixels


def test_weights_vanish_where_nothing_is_seen():
    normals = np.array([[0.0, 0, 1], [0, 0, 0], [0, 0, 1], [0, 0, 1]])
    albedo = np.array([1.0, 1.0, 0.0, 0.5])
    _, same, weights = visible_pixels(normals, albedo, np.array([2.0, 2.0, 2.0, 0.0]))
    assert same is albedo
    assert np.array_equal(weights, [2.0, 0.0, 0.0, 0.0])


@pytest.mark.usefixtures("unchecked")
def test_shapes_must_match():
    normals = np.array([[0.0, 0, 1], [0, 0, 1]])
    with pytest.raises(ArgumentError, match=r"albedo must have the shape of the pixels \(2,\)"):
        visible_pixels(normals, np.ones(3), None)
    with pytest.raises(ArgumentError, match=r"weights must have the shape of the pixels \(2,\)"):
        visible_pixels(normals, None, np.ones((2, 1)))
