import numpy as np
import pytest

from data_synth.shapes import sphere
from harmface.errors import ArgumentError
from harmface.geometry import (
    Mesh,
    OrthographicCamera,
    PerspectiveCamera,
    frame_orthographic,
    gbuffer,
    vertex_weights,
    visible,
)
from harmface.reproduce.synthetic import mesh_of

BALL = mesh_of(sphere())


def test_a_sphere_seen_orthographically():
    camera = frame_orthographic(BALL, 64)
    view = gbuffer(BALL, camera)
    radius = BALL.bounds[1, 0]
    x, y, z = np.moveaxis(view.position[view.mask], -1, 0)
    # Chords cut at most 1 - cos(half an edge) off the radius; the mesh has edges below 3 degrees.
    assert np.abs(np.sqrt(x**2 + y**2 + z**2) / radius - 1).max() < 1e-3
    assert np.abs(view.normals[view.mask] - view.position[view.mask] / radius).max() < 2e-2
    assert np.allclose(view.depth[view.mask], camera.center[2] - z)
    assert view.mask.mean() == pytest.approx(np.pi / 4 / 1.05**2, rel=0.01)


def test_the_background_holds_zeros_and_infinite_depth():
    view = gbuffer(BALL, frame_orthographic(BALL, 32), supersampling=2)
    away = ~view.mask
    assert away.any()
    for array in (view.normals, view.albedo, view.position):
        assert not array[away].any()
    assert np.isinf(view.depth[away]).all()
    assert np.isfinite(view.depth[view.mask]).all()


@pytest.mark.parametrize("n", [2, 3])
def test_supersampling_averages_the_finer_picture(n):
    coarse = gbuffer(BALL, frame_orthographic(BALL, 30), n)
    fine = gbuffer(BALL, frame_orthographic(BALL, 30 * n))
    blocks = fine.albedo.reshape(30, n, 30, n, 3).sum(axis=(1, 3))
    hits = fine.mask.reshape(30, n, 30, n).sum(axis=(1, 3))
    assert np.array_equal(coarse.mask, hits * 2 >= n * n)
    expected = blocks[coarse.mask] / hits[coarse.mask][:, None]
    assert np.allclose(coarse.albedo[coarse.mask], expected, atol=1e-6)
    assert np.allclose(np.linalg.norm(coarse.normals[coarse.mask], axis=-1), 1)


def test_attributes_are_interpolated_linearly_over_a_triangle():
    vertices = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]])
    albedo = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = Mesh(vertices, np.array([[0, 1, 2]]), np.tile([0.0, 0, 1], (3, 1)), albedo)
    view = gbuffer(mesh, OrthographicCamera((1, 1, 3), 2.0, (8, 8)))
    x, y = view.position[view.mask][:, 0], view.position[view.mask][:, 1]
    expected = np.stack([1 - (x + y) / 2, x / 2, y / 2], axis=-1)
    assert np.allclose(view.albedo[view.mask], expected, atol=1e-6)


def test_units_and_place_do_not_matter():
    far = Mesh(BALL.vertices * 1e-3 + [1e4, 0, 0], BALL.faces, BALL.normals, BALL.albedo)
    near = gbuffer(BALL, frame_orthographic(BALL, 40))
    same = gbuffer(far, frame_orthographic(far, 40))
    # Double precision keeps 1e-12 of 1e4, which is 1e-8 / 1e-3 of the ball.
    assert (near.mask == same.mask).mean() > 0.99
    both = near.mask & same.mask
    assert np.abs(near.normals - same.normals)[both].max() < 1e-4


def test_perspective_depth_and_directions_to_the_camera():
    camera = PerspectiveCamera((0.0, 0.0, 4.0), 40.0, (32, 32))
    view = gbuffer(BALL, camera)
    points = view.position[view.mask]
    towards = camera.towards(points)
    assert np.allclose(view.depth[view.mask], 4 - points[:, 2])
    assert np.allclose(np.cross(towards, camera.position - points), 0, atol=1e-12)
    # From a finite distance less than half of a sphere is seen.
    assert (np.sum(towards * view.normals[view.mask], axis=1) > -0.05).all()


def test_a_camera_that_misses_the_mesh_is_refused():
    with pytest.raises(ArgumentError, match="framing helper"):
        gbuffer(BALL, OrthographicCamera((9, 9, 9), 1.0, (8, 8)))


def test_a_picture_larger_than_memory_is_refused():
    with pytest.raises(ArgumentError, match="smaller picture"):
        gbuffer(BALL, frame_orthographic(BALL, 100_000))


def test_opposite_normals_in_one_pixel_leave_background():
    vertices = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]])
    normals = np.array([[1.0, 0, 0], [-1, 0, 0], [1, 0, 0]])
    mesh = Mesh(vertices, np.array([[0, 1, 2]]), normals, np.ones((3, 3)))
    view = gbuffer(mesh, OrthographicCamera((1.0, 0.2, 1.0), 1e-6, (1, 1)))
    assert not view.mask.any()
    assert not view.normals.any()


def test_vertex_weights_interpolate_as_the_buffer_does():
    mesh = mesh_of(sphere(16))
    camera = frame_orthographic(mesh, 24)
    view = gbuffer(mesh, camera)
    weights = vertex_weights(mesh, camera)
    np.testing.assert_allclose(
        (weights @ mesh.vertices).reshape(view.position.shape), view.position, atol=1e-12
    )
    sums = np.asarray(weights.sum(axis=1)).reshape(view.mask.shape)
    np.testing.assert_allclose(sums, view.mask, atol=1e-6)


def test_places_of_many_samples_lie_on_the_surface():
    """Their mean lies inside a ball, in its own shadow."""
    mesh = mesh_of(sphere(16))
    camera = frame_orthographic(mesh, 24)
    view = gbuffer(mesh, camera, 4)
    places, normals = view.position[view.mask], view.normals[view.mask]
    towards = np.array([[0.0, 0, 1]])
    facing = normals[:, 2] > 0.5
    assert visible(mesh, places[facing], normals[facing], towards).all()
    # Within the pixel: every ray of it is half a pixel from its middle at most.
    centres = camera.rays(1)[0].reshape(24, 24, 3)[view.mask]
    step = np.linalg.norm(centres[1] - centres[0])
    inner = facing & (np.hypot(places[:, 0], places[:, 1]) < 0.8)
    assert np.abs(places - centres)[inner, :2].max() < step / 2
