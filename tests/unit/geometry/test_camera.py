import numpy as np
import pytest

from data_synth.shapes import sphere
from harmface.errors import ArgumentError
from harmface.geometry import (
    OrthographicCamera,
    PerspectiveCamera,
    frame_orthographic,
    frame_perspective,
    gbuffer,
)
from harmface.geometry.camera import pixel_grid
from harmface.reproduce.synthetic import mesh_of


def test_row_zero_is_at_the_top_and_centres_are_at_half_integers():
    x, y = pixel_grid((2, 3), 1)
    assert np.array_equal(x, [-1, 0, 1, -1, 0, 1])
    assert np.array_equal(y, [0.5, 0.5, 0.5, -0.5, -0.5, -0.5])


def test_samples_of_a_pixel_follow_one_another_around_its_centre():
    x, y = pixel_grid((3, 4), 2)
    coarse_x, coarse_y = pixel_grid((3, 4), 1)
    assert np.allclose(x.reshape(-1, 4).mean(axis=1), coarse_x)
    assert np.allclose(y.reshape(-1, 4).mean(axis=1), coarse_y)
    assert np.allclose(np.ptp(x.reshape(-1, 4), axis=1), 0.5)


def test_perspective_rays_span_the_field_of_view():
    _, directions = PerspectiveCamera((0, 0, 5), 60.0, (201, 101)).rays()
    top, bottom = directions[50], directions[200 * 101 + 50]
    # From the centre of the first row to that of the last: half a pixel less at either end.
    expected = 2 * np.degrees(np.arctan(np.tan(np.radians(30)) * 200 / 201))
    assert np.degrees(np.arccos(top @ bottom)) == pytest.approx(expected, abs=1e-9)
    assert top[1] > 0 > bottom[1]


@pytest.mark.parametrize("frame", [frame_orthographic, frame_perspective])
@pytest.mark.parametrize("shape", [(40, 40), (40, 90), (90, 40)])
def test_framing_shows_the_whole_mesh_centred(frame, shape):
    view = gbuffer(mesh_of(sphere()), frame(mesh_of(sphere()), shape))
    assert not view.mask[[0, -1]].any()
    assert not view.mask[:, [0, -1]].any()
    assert np.array_equal(view.mask, view.mask[::-1, ::-1])


def test_the_height_of_a_head_fills_the_documented_share():
    camera = frame_orthographic(mesh_of(sphere()), 105)
    rows = np.flatnonzero(gbuffer(mesh_of(sphere()), camera).mask.any(axis=1))
    assert len(rows) == 100


@pytest.mark.parametrize(
    "make",
    [
        lambda: OrthographicCamera((0, 0, 1), 0.0, (4, 4)),
        lambda: OrthographicCamera((0, 0, 1), np.inf, (4, 4)),
        lambda: OrthographicCamera((0, 0, 1), 1.0, (0, 4)),
        lambda: PerspectiveCamera((0, 0, 1), 180.0, (4, 4)),
        lambda: PerspectiveCamera((0, 0, 1), 0.0, (4, 4)),
    ],
)
def test_nonsense_is_refused(make):
    with pytest.raises(ArgumentError):
        make()


def test_orthographic_rays_start_on_the_plane_of_the_centre():
    camera = OrthographicCamera((1.0, 2.0, 5.0), 8.0, (4, 6))
    origins, directions = camera.rays()
    assert np.array_equal(origins[0], [1 - 2 * 2.5, 2 + 2 * 1.5, 5])
    assert np.array_equal(origins[-1], [1 + 2 * 2.5, 2 - 2 * 1.5, 5])
    assert np.array_equal(directions, np.tile([0.0, 0, -1], (24, 1)))
    points = np.array([[0.0, 0, 0], [3, 1, -7]])
    assert np.array_equal(camera.pixel_sizes(points), [2, 2])
    assert np.array_equal(camera.towards(points), [[0, 0, 1]] * 2)


def test_perspective_pixels_grow_with_the_distance_along_the_axis():
    camera = PerspectiveCamera((0.0, 0.0, 10.0), 90.0, (20, 30))
    points = np.array([[0.0, 0, 0], [4, 3, 0], [0, 0, -10]])
    # At 90 degrees the picture is twice as high as it is far.
    assert camera.pixel_sizes(points) == pytest.approx([1, 1, 2])
    assert camera.towards(points)[1] == pytest.approx(np.array([-4, -3, 10]) / np.sqrt(125))
    _, directions = camera.rays()
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1)
    # Pixels are square: the middle of the leftmost column is 14.5 pixels of 1/10 off the axis.
    left = directions.reshape(20, 30, 3)[9:11, 0].mean(axis=0)
    assert left[0] / left[2] == pytest.approx(1.45, rel=1e-3)
