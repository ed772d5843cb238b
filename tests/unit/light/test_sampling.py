import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, EnvironmentMap, project, resample, sample
from harmface.sphere import fibonacci_directions, rotate

EPS = np.finfo(float).eps
EVERYWHERE = fibonacci_directions(1500)


def smooth(layout, height):
    """Return a map of a function linear in direction, black around a disc."""
    form = LAYOUTS[layout]
    directions = form.directions(height)
    values = np.stack([2 + directions @ [0.3, 0.5, 0.7], 1 - directions[..., 1]])
    return EnvironmentMap(np.where(form.solid_angles(height) > 0, values, 0), form)


@pytest.mark.parametrize("height", [1, 2, 7])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_constant_maps_are_constant_everywhere(layout, height):
    form = LAYOUTS[layout]
    environment = EnvironmentMap(np.full((2, *form.shape(height)), 3.0), form)
    np.testing.assert_allclose(sample(environment, EVERYWHERE), 3, rtol=4 * EPS)


@pytest.mark.parametrize(("layout", "widest"), [("latlong", 1), ("cube", 2), ("angular", 5)])
def test_lookups_follow_a_smooth_function_across_all_edges(layout, widest):
    height = 64
    expected = np.stack([2 + EVERYWHERE @ [0.3, 0.5, 0.7], 1 - EVERYWHERE[..., 1]])
    # Second order in a pixel inside, first order across edges, where the angular map is coarse.
    error = np.abs(sample(smooth(layout, height), EVERYWHERE) - expected)
    assert error.max() < widest * np.pi / height / 4
    assert error.mean() < (np.pi / height) ** 2


@pytest.mark.parametrize("layout", LAYOUTS)
def test_pixel_centres_give_the_pixels(layout):
    form = LAYOUTS[layout]
    radiance = np.random.default_rng(0).random(form.shape(9))
    environment = EnvironmentMap(radiance, form)
    centred = 2 * (np.indices(form.shape(9))[-2:] + 0.5) / 9 - 1
    inside = np.hypot(*centred) < 1 if layout in ("angular", "mirror-ball") else ...
    found = sample(environment, environment.directions[inside])
    np.testing.assert_allclose(found, radiance[inside], atol=1e-13)


@pytest.mark.parametrize("target", LAYOUTS)
@pytest.mark.parametrize("source", ["latlong", "cube", "angular"])
def test_layouts_agree_on_the_light(source, target):
    environment = smooth(source, 64)
    drawn = resample(environment, target, 48)
    assert drawn.pixels == LAYOUTS[target].shape(48)
    expected = project(environment, 2)
    difference = np.linalg.norm(project(drawn, 2) - expected) / np.linalg.norm(expected)
    assert difference < 0.005


@pytest.mark.parametrize("target", LAYOUTS)
def test_shrinking_does_not_alias(target):
    """A fine checkerboard seen from afar is grey; picked pixels would be black or white."""
    rows, columns = np.indices((128, 256))
    board = EnvironmentMap(((rows + columns) % 2).astype(float), LAYOUTS["latlong"])
    small = resample(board, target, 8)
    shows = small.solid_angles > 0.5 * small.solid_angles.max()
    # What remains is the imbalance of a pixel of some 8 x 8 of the board.
    assert np.abs(small.radiance[shows] - 0.5).max() < 0.1


def test_rotation_is_taken_up_by_the_pixels():
    environment = smooth("latlong", 48)
    tilt = np.array([[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]])
    drawn = resample(environment.rotated(tilt), "latlong", 48)
    np.testing.assert_array_equal(drawn.frame, np.eye(3))
    expected = rotate(project(environment, 2), tilt)
    np.testing.assert_allclose(project(drawn, 2), expected, atol=2e-3)


def test_precision_is_kept():
    environment = EnvironmentMap(np.ones((4, 8), np.float32), LAYOUTS["latlong"])
    assert sample(environment, EVERYWHERE).dtype == np.float32
    assert resample(environment, "cube", 2).radiance.dtype == np.float32


def test_directions_and_heights_are_checked():
    environment = EnvironmentMap(np.ones((4, 8)), LAYOUTS["latlong"])
    with pytest.raises(ArgumentError, match="directions"):
        sample(environment, 2 * EVERYWHERE)
    with pytest.raises(ArgumentError, match="height"):
        resample(environment, "cube", 0)
    with pytest.raises(ArgumentError, match="layout"):
        resample(environment, "octahedral", 4)
