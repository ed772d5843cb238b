import numpy as np
import pytest

from harmface.conventions import MAP_FRAMES, map_frame, z_up_to_y_up
from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, transformed
from harmface.sphere import random_directions, synthesize


def looks(layout, frame, *fractions):
    """Return where a pixel looks, in our axes, according to a frame."""
    form = LAYOUTS[layout]
    position = (np.array([float(fraction)]) for fraction in fractions)
    return map_frame(layout, frame) @ form.directions_at(*position, height=1)[0]


@pytest.mark.parametrize(
    ("layout", "frame", "position", "direction"),
    [
        # three.js: u = atan(z, x) / 2 pi + 1/2, from the left; v = asin(y) / pi + 1/2, upwards.
        ("latlong", "three.js", (0.5, 1.0), (1, 0, 0)),
        ("latlong", "three.js", (0.5, 1.5), (0, 0, 1)),
        ("latlong", "three.js", (0.5, 0.5), (0, 0, -1)),
        ("latlong", "three.js", (0.0, 0.5), (0, 1, 0)),
        ("latlong", "y-up", (0.5, 1.0), (0, 0, -1)),
        ("latlong", "y-up", (0.5, 1.5), (1, 0, 0)),
        ("latlong", "openexr", (0.5, 1.0), (0, 0, 1)),
        # z-up: centre +x, left quarter +y, which lies at our -z.
        ("latlong", "z-up", (0.5, 1.0), (1, 0, 0)),
        ("latlong", "z-up", (0.5, 0.5), (0, 0, -1)),
        ("latlong", "z-up", (0.0, 0.5), (0, 1, 0)),
        ("angular", "figure-3", (0.5, 0.5), (0, 0, 1)),
        ("angular", "figure-3", (0.5, 0.75), (1, 0, 0)),
        # Debevec: centre -z, the right half of the disc looks to +x, the top to +y.
        ("angular", "debevec", (0.5, 0.5), (0, 0, -1)),
        ("angular", "debevec", (0.5, 0.75), (1, 0, 0)),
        ("angular", "debevec", (0.25, 0.5), (0, 1, 0)),
        ("mirror-ball", "debevec", (0.5, 0.5), (0, 0, -1)),
    ],
)
def test_landmarks_of_every_frame(layout, frame, position, direction):
    np.testing.assert_allclose(looks(layout, frame, *position), direction, atol=1e-15)


@pytest.mark.parametrize(("layout", "frame"), MAP_FRAMES)
def test_frames_are_orthogonal_and_the_first_is_ours(layout, frame):
    matrix = map_frame(layout, frame)
    np.testing.assert_array_equal(matrix @ matrix.T, np.eye(3))
    np.testing.assert_array_equal(map_frame(layout), np.eye(3))


@pytest.mark.parametrize(
    ("layout", "frame"), [("latlong", "debevec"), ("cube", "z-up"), ("octahedral", "openexr")]
)
def test_frames_of_other_layouts_are_refused(layout, frame):
    with pytest.raises(ArgumentError, match="frame"):
        map_frame(layout, frame)


MATRICES = {
    "identity": np.eye(3),
    "mirror": np.diag([1.0, 1.0, -1.0]),
    "inversion": -np.eye(3),
    "z-up": z_up_to_y_up(),
    "tilted mirror": np.array([[0.8, 0.6, 0.0], [0.6, -0.8, 0.0], [0.0, 0.0, 1.0]]),
}


@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
def test_transformed_light_shows_in_the_moved_direction(matrix, rng):
    coefficients = rng.standard_normal((2, 25))
    directions = random_directions(40, rng)
    moved = synthesize(transformed(coefficients, matrix), directions @ matrix.T)
    np.testing.assert_allclose(moved, synthesize(coefficients, directions), atol=1e-12)


def test_matrices_must_be_orthogonal():
    with pytest.raises(ArgumentError, match="matrix"):
        transformed(np.ones(4), 2 * np.eye(3))
