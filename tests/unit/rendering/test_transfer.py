import numpy as np
import pytest

from data_synth.shapes import ellipsoid, half_sphere, sphere
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.reflectance import lambert_per_coefficient
from harmface.rendering import harmonic_images, transfer, visibility_coefficients
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, product, real_harmonics
from harmface.sphere.directions import stratified_directions

HALF = np.sqrt(np.pi) / 4
"""T_00 where half of the sky, weighted by the cosine, is open."""


def bowl(albedo, resolution=32):
    """A hemisphere of radius 1 about the origin that is open to +z and seen from inside."""
    mesh = mesh_of(half_sphere(resolution)).flipped().rotated(np.diag([1.0, -1.0, -1.0]))
    return Mesh(mesh.vertices, mesh.faces, mesh.normals, np.full(mesh.vertices.shape, albedo))


def areas(mesh):
    """The area each vertex stands for."""
    corners = mesh.vertices[mesh.faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return np.bincount(mesh.faces.ravel(), np.repeat(area / 6, 3), len(mesh.vertices))


def corner(d, length=8.0):
    """A point of the floor z = 0 beside a wall of height 1 in the plane x = 0, as a mesh."""
    wall = [[0, -length, 0], [0, length, 0], [0, length, 1], [0, -length, 1]]
    floor = [[d - 0.1, -0.1, 0], [d + 0.1, -0.1, 0], [d, 0.1, 0]]
    normals = [[1, 0, 0]] * 4 + [[0, 0, 1]] * 3
    faces = [[0, 1, 2], [0, 2, 3], [4, 5, 6]]
    return Mesh(
        np.array([*wall, *floor], float),
        np.array(faces),
        np.array(normals, float),
        np.full((7, 3), 0.5),
    )


def test_a_convex_mesh_has_the_coefficients_of_lambert():
    mesh = mesh_of(ellipsoid(32))
    expected = harmonic_images(mesh.normals, np.ones(len(mesh.normals)), 4)
    found = transfer(mesh, 4, samples=256)
    assert np.abs(found.coefficients - expected).max() < 1e-6
    assert found.standard_errors.max() < 1e-6
    bounced = transfer(mesh, 4, samples=256, bounces="all").coefficients
    assert np.abs(bounced - expected).max() < 1e-6


def test_a_bowl_sees_half_of_the_sky_from_everywhere():
    mesh = bowl(0.5)
    found = transfer(mesh, 4)
    error = found.coefficients[0] - HALF
    assert abs(np.average(error, weights=areas(mesh))) < 0.005 * HALF
    # Three standard deviations leave out 0.3 %; all points share the directions.
    assert np.mean(np.abs(error) > 3 * found.standard_errors[0]) < 0.02
    assert 0.5 < np.sqrt(np.mean(error**2) / np.mean(found.standard_errors[0] ** 2)) < 1.5
    assert np.sqrt(np.mean(error**2)) < 0.005 * HALF


def test_the_mean_over_a_bowl_is_that_of_its_opening():
    mesh = bowl(0.5)
    found = np.average(transfer(mesh, 4).coefficients, axis=1, weights=areas(mesh))
    zonal = real_harmonics(np.array([0.0, 0.0, 1.0]), 4) * lambert_per_coefficient(4) / 2
    np.testing.assert_allclose(found, zonal, atol=0.005 * zonal[0])


@pytest.mark.parametrize("albedo", [0.5, 1.0])
def test_bounces_in_a_bowl_conserve_energy(albedo):
    mesh = bowl(albedo)
    found = transfer(mesh, 0, bounces="all", samples=2048).coefficients
    assert np.average(found[0], weights=areas(mesh)) == pytest.approx(
        HALF / (1 - albedo / 2), rel=0.005
    )
    if albedo == 1:
        # What is not seen of the sky is seen of what is as bright: nothing is left to sample.
        assert np.abs(found / (2 * HALF) - 1).max() < 1e-5


def test_each_bounce_in_a_bowl_adds_its_term_to_degree_0_and_nothing_to_other_orders():
    mesh = bowl(0.5, 16)
    areas_of = areas(mesh)
    direct = transfer(mesh, 2, samples=1024).coefficients
    for bounces, share in ((1, 0.25), (2, 0.25 + 0.0625)):
        found = transfer(mesh, 2, bounces=bounces, samples=1024)
        added = np.average(found.coefficients - direct, axis=1, weights=areas_of)
        assert added[0] == pytest.approx(share * HALF, rel=0.01)
        assert np.abs(added[[1, 3, 4, 5, 7, 8]]).max() < 0.005 * HALF
        assert found.back_share == 0
        assert (
            found.standard_errors[0] >= transfer(mesh, 0, samples=1024).standard_errors[0]
        ).all()


@pytest.mark.parametrize("d", [0.3, 1.0, 3.0])
def test_a_wall_hides_what_its_height_says(d):
    found = transfer(corner(d), 0, samples=16384)
    # What half of an upright rectangle hides of the floor; together (1 - d / hypot) / 2 where
    # the wall has no end.
    slant = np.hypot(d, 1)
    hidden = (np.arctan(8 / d) - d / slant * np.arctan(8 / slant)) / np.pi
    assert hidden == pytest.approx((1 - d / slant) / 2, rel=0.03)
    expected = 2 * HALF * (1 - hidden)
    assert abs(found.coefficients[0, 6] - expected) < 0.005 * expected
    # The other corners of the triangle are nearer and farther.
    assert found.coefficients[0, 4] < found.coefficients[0, 6] < found.coefficients[0, 5]


def test_channels_of_albedo_bounce_apart():
    mesh = bowl(0.5, 16)
    albedo = np.stack([np.full(len(mesh.vertices), value) for value in (0.0, 0.5)])
    found = transfer(mesh, 1, bounces=2, albedo=albedo, samples=256)
    assert found.coefficients.shape == (2, 4, len(mesh.vertices)) == found.standard_errors.shape
    np.testing.assert_allclose(
        found.coefficients[0], transfer(mesh, 1, samples=256).coefficients, atol=1e-6
    )
    np.testing.assert_allclose(
        found.coefficients[1], transfer(mesh, 1, bounces=2, samples=256).coefficients
    )


@pytest.mark.parametrize("bounces", [0, 1, 2, "all"])
def test_pixels_receive_what_the_vertices_around_them_do(bounces):
    mesh = bowl(0.7, 48)
    view = gbuffer(mesh, frame_orthographic(mesh, 9))
    seen = transfer(mesh, 2, view=view, bounces=bounces, samples=2048)
    at_vertices = transfer(mesh, 2, bounces=bounces, samples=2048).coefficients
    points = view.position[view.mask]
    nearest = np.linalg.norm(points[:, None] - mesh.vertices, axis=-1).argmin(axis=1)
    found = seen.coefficients[:, view.mask]
    assert np.abs(found - at_vertices[:, nearest]).mean() < 0.02
    assert not seen.coefficients[:, ~view.mask].any()


def joined(*meshes):
    counts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + n for mesh, n in zip(meshes, counts[:-1], strict=True)]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.albedo for mesh in meshes]),
    )


def test_inner_sides_stop_light_and_are_black():
    floor = np.array([[-0.1, -0.1, 0.1], [0.1, -0.1, 0.1], [0.0, 0.1, 0.1]])
    up = np.tile([0.0, 0.0, 1.0], (3, 1))
    patch = Mesh(floor, np.array([[0, 1, 2]]), up, np.ones((3, 3)))
    dome = mesh_of(half_sphere(16))
    found = transfer(joined(patch, dome), 0, bounces=2, samples=256)
    assert found.back_share == 1
    assert (np.abs(found.coefficients[0, :3]) < 3 * found.standard_errors[0, :3]).all()
    dark = transfer(joined(patch, dome), 0, samples=256).coefficients[0, :3]
    np.testing.assert_allclose(found.coefficients[0, :3], dark, atol=1e-6)
    found = transfer(joined(patch, dome.flipped()), 0, bounces=2, samples=256)
    assert found.back_share == 0


def test_parts_are_kept_and_used_again():
    mesh = bowl(0.5, 16)
    kept = {}

    def keep(make, parts):
        for name, points in parts.items():
            kept[name] = make(points)
            yield kept[name]

    first = transfer(mesh, 2, bounces=1, samples=4096, keep=keep)
    assert len(kept) > 1
    again = transfer(mesh, 2, bounces=1, samples=4096, keep=lambda _, parts: map(kept.get, parts))
    assert np.array_equal(first.coefficients, again.coefficients)


def test_blocks_do_not_change_the_result(monkeypatch):
    mesh = bowl(0.5, 16)
    whole = transfer(mesh, 2, bounces=1, samples=512).coefficients
    monkeypatch.setattr("harmface.rendering.precomputed_transfer.PAIRS", 512 * 10)
    np.testing.assert_allclose(
        transfer(mesh, 2, bounces=1, samples=512).coefficients, whole, atol=1e-6
    )


def test_visibility_times_a_clamped_cosine_is_the_transfer():
    mesh = bowl(0.5, 16)
    found = visibility_coefficients(mesh, 12, samples=1024)
    # Integrated over all directions it is the solid angle that is open.
    solid_angle = found[0] * np.sqrt(4 * np.pi)
    assert (solid_angle < 2 * np.pi + 1e-6).all()
    some = slice(None, None, 200)
    cosines = real_harmonics(mesh.normals[some], 12) * lambert_per_coefficient(12)[:, None]
    products = product(cosines.T, found[:, some].T, 2)
    expected = transfer(mesh, 2, samples=1024).coefficients[:, some]
    # What degree 12 leaves out of both, with the noise of 1024 directions.
    assert np.abs(products.T - expected).max() < 0.03


def test_stratified_directions_are_uniform_and_apart():
    pairs = stratified_directions(700, 3)
    assert np.allclose(np.linalg.norm(pairs, axis=-1), 1)
    # Independent directions would miss by 1 / sqrt(1400) times as much.
    assert np.abs(real_harmonics(pairs.reshape(-1, 3), 3).mean(axis=1)[1:]).max() < 0.01
    nearest = np.sort(pairs[:, 0] @ fibonacci_directions(50).T, axis=0)[-1]
    assert nearest.min() > 0.95


def test_nonsense_is_refused():
    mesh = bowl(0.5, 16)
    for match, given in {
        "max_degree must be 0": {"max_degree": -1},
        "bounces must be 0": {"max_degree": 1, "bounces": -1},
        "samples must be even": {"max_degree": 1, "samples": 101},
        "albedo must have a value for each": {"max_degree": 1, "albedo": np.ones(3)},
        "albedo must be at most 1": {
            "max_degree": 1,
            "bounces": 1,
            "albedo": np.full(len(mesh.vertices), 1.5),
        },
    }.items():
        with pytest.raises(ArgumentError, match=match):
            transfer(mesh, **given)


def test_light_in_a_white_room_with_a_tiny_window_takes_too_long_to_die_out():
    ball = mesh_of(sphere(16)).flipped()
    room = Mesh(ball.vertices, ball.faces[1:], ball.normals, np.ones(ball.vertices.shape))
    with pytest.raises(ArgumentError, match="do not die out"):
        transfer(room, 0, bounces="all", samples=512)
