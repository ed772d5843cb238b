import numpy as np
import pytest
from scipy.integrate import quad

from data_synth.shapes import half_sphere, sphere
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, frame_orthographic, frame_perspective, gbuffer
from harmface.light import DistantLight
from harmface.reflectance import Phong
from harmface.rendering import box_average, clamped_cosines, irradiance, reflected, render
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions, gauss_legendre, random_directions

BALL = mesh_of(sphere())
VIEW = gbuffer(BALL, frame_orthographic(BALL, 32))
UP = np.array([[0.0, 0, 1]])


def test_light_from_everywhere_gives_pi(rng):
    rule = gauss_legendre(200)
    light = DistantLight(rule.directions, rule.weights)
    # The clamped cosine has a kink, so the rule's error falls as its degree squared.
    assert np.allclose(irradiance(random_directions(20, rng), light), np.pi, rtol=1e-4)


def test_a_sky_with_a_gradient_agrees_with_adaptive_quadrature():
    rule = gauss_legendre(300)
    light = DistantLight(rule.directions, rule.weights * (1 + rule.directions[:, 2]))
    normal = np.array([[0.0, 0, 1]])
    expected = 2 * np.pi * quad(lambda u: (1 + u) * u, 0, 1)[0]
    assert irradiance(normal, light)[0] == pytest.approx(expected, rel=1e-4)


def test_channels_and_images_lead(rng):
    light = DistantLight(random_directions(5, rng), rng.random((2, 3, 5)))
    result = irradiance(random_directions(12, rng).reshape(3, 4, 3), light)
    assert result.shape == (2, 3, 3, 4)
    images = render(VIEW, light, albedo=np.ones((3, 32, 32)))
    assert images.shape == (2, 3, 32, 32)


def test_shadowed_directions_count_for_nothing(rng):
    normals = random_directions(7, rng)
    light = DistantLight(random_directions(9, rng), rng.random(9))
    open_sky = rng.random((9, 7)) < 0.5
    expected = np.einsum(
        "j,jn,jn->n", light.irradiances, clamped_cosines(normals, light.directions), open_sky
    )
    assert np.allclose(irradiance(normals, light, open_sky), expected)


def test_chunks_do_not_change_the_sum(rng, monkeypatch):
    light = DistantLight(random_directions(50, rng), rng.random((2, 50)))
    whole = render(VIEW, light, caster=BALL)
    monkeypatch.setattr("harmface.rendering.reference.CHUNK", 1000)
    assert np.allclose(render(VIEW, light, caster=BALL), whole, rtol=1e-12)


def test_a_pillar_shadows_the_ground_behind_it():
    # A box of height 1 on a floor in the plane z = 0, lit from the right.
    low = np.array([[x, y, 0.0] for x, y in ((-4, -4), (4, -4), (4, 4), (-4, 4))])
    wall = np.array([[0.0, -1, 0], [0, 1, 0], [0, 1, 1], [0, -1, 1]])
    vertices = np.concatenate([low, wall])
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    mesh = Mesh(vertices, faces, np.tile(UP, (8, 1)), np.ones((8, 3)))
    view = gbuffer(mesh, frame_orthographic(mesh, 64))
    light = DistantLight(np.array([[np.sqrt(0.5), 0, np.sqrt(0.5)]]), np.ones(1))
    dark = render(view, light, caster=mesh) == 0
    assert not (render(view, light) == 0)[view.mask].any()
    x, y = view.position[..., 0], view.position[..., 1]
    behind = (x < -0.1) & (x > -0.9) & (np.abs(y) < 0.9) & view.mask
    beyond = ((x < -1.1) | (x > 0.1) | (np.abs(y) > 1.1)) & view.mask
    assert dark[behind].all()
    assert not dark[beyond].any()


def test_a_phong_lobe_reflects_its_share_seen_from_straight_above():
    # By reciprocity, light from everywhere seen along the normal comes back as the share that
    # light along the normal sends out: int (e+2)/(2 pi) cos^(e+1) = share, in radiosity pi share.
    rule = gauss_legendre(200)
    light = DistantLight(rule.directions, rule.weights)
    middle = (16, 16)
    shiny = render(VIEW, light, albedo=np.ones((32, 32)), material=Phong(20.0, 0.3))[middle]
    # The pixel beside the middle sees its normal a little aslant.
    assert shiny == pytest.approx(0.3 * np.pi, rel=0.02)


def test_a_highlight_sits_where_the_mirror_direction_meets_the_light():
    light = DistantLight(np.array([[np.sin(1), 0, np.cos(1)]]), np.ones(1))
    dull = render(VIEW, light, albedo=np.ones((32, 32)), material=Phong(400.0))
    peak = np.unravel_index(dull.argmax(), dull.shape)
    half_way = np.array([np.sin(0.5), 0, np.cos(0.5)])
    # A pixel of the ball spans 1/15 of its radius.
    assert np.linalg.norm(VIEW.normals[peak] - half_way) < 0.08


def test_a_highlight_follows_a_camera_that_is_near():
    camera = frame_perspective(BALL, 33, 90.0)
    view = gbuffer(BALL, camera)
    light = DistantLight(np.array([[np.sin(1), 0, np.cos(1)]]), np.ones(1))
    image = render(view, light, albedo=np.ones((33, 33)), material=Phong(400.0))
    peak = np.unravel_index(image.argmax(), image.shape)
    to_camera = camera.towards(view.position[peak][None])[0]
    half_way = to_camera + light.directions[0]
    half_way /= np.linalg.norm(half_way)
    assert np.linalg.norm(view.normals[peak] - half_way) < 0.1


@pytest.mark.parametrize(
    "arguments", [(5.0, -0.1), (5.0, 1.1), (-1.0, 0.5), (np.nan, 0.5), (1e9, 0.5)]
)
def test_impossible_lobes_are_refused(arguments):
    with pytest.raises(ArgumentError):
        Phong(*arguments)


def test_albedo_of_another_size_is_refused():
    light = DistantLight(UP, np.ones(1))
    with pytest.raises(ArgumentError, match="view's size"):
        render(VIEW, light, albedo=np.ones((8, 8)))


def test_box_average_takes_means_of_blocks():
    image = np.arange(16.0).reshape(4, 4)
    assert np.array_equal(box_average(image, 2), [[2.5, 4.5], [10.5, 12.5]])
    with pytest.raises(ArgumentError, match="blocks of 3"):
        box_average(image, 3)


def test_the_sum_over_directions_converges_to_the_integral(rng):
    normals = random_directions(30, rng)
    errors = []
    for count in (500, 8000):
        light = DistantLight(fibonacci_directions(count), np.full(count, 4 * np.pi / count))
        errors.append(np.abs(irradiance(normals, light) - np.pi).max())
    # Sixteen times the directions of a near-uniform set: an error at least eight times smaller.
    assert errors[1] < errors[0] / 8


def test_a_bowl_reflects_half_of_what_it_receives_to_itself():
    mesh = mesh_of(half_sphere(32)).flipped().rotated(np.diag([1.0, -1.0, -1.0]))
    mesh = Mesh(mesh.vertices, mesh.faces, mesh.normals, np.full(mesh.vertices.shape, 0.5))
    view = gbuffer(mesh, frame_orthographic(mesh, 9))
    sky = fibonacci_directions(600)
    light = DistantLight(sky, np.full((2, 600), 4 * np.pi / 600) * np.array([[1.0], [2.0]]))
    for bounces, share in ((0, 0), (1, 0.25), (2, 0.25 + 0.0625)):
        found = reflected(mesh, view, light, bounces)
        assert found.shape == (2, 9, 9)
        # A white sky gives pi / 2 in the bowl.
        assert found[0][view.mask].mean() == pytest.approx(share * np.pi / 2, rel=0.02)
        np.testing.assert_allclose(found[1], 2 * found[0])
        assert not found[:, ~view.mask].any()


def test_a_convex_mesh_reflects_nothing_to_itself():
    light = DistantLight(UP, np.ones((1, 1)))
    assert not reflected(BALL, VIEW, light, 2, rays=32).any()


def test_inner_sides_reflect_nothing():
    # A dome seen from outside over a patch of floor that looks up into it.
    dome = mesh_of(half_sphere(16))
    floor = np.array([[-0.5, -0.5, 0.1], [0.5, -0.5, 0.1], [0.0, 0.5, 0.1]])
    inside = Mesh(
        np.concatenate([dome.vertices, floor]),
        np.concatenate([dome.faces, [np.arange(3) + len(dome.vertices)]]),
        np.concatenate([dome.normals, UP.repeat(3, axis=0)]),
        np.full((len(dome.vertices) + 3, 3), 0.5),
    )
    patch = Mesh(floor, np.array([[0, 1, 2]]), UP.repeat(3, axis=0), np.full((3, 3), 0.5))
    view = gbuffer(patch, frame_orthographic(patch, 8))
    assert not reflected(inside, view, DistantLight(UP, np.ones((1, 1))), 1, rays=64).any()


def test_reflections_want_whole_numbers():
    light = DistantLight(UP, np.ones((1, 1)))
    with pytest.raises(ArgumentError, match="bounces must be 0"):
        reflected(BALL, VIEW, light, -1)
    with pytest.raises(ArgumentError, match="rays must be 1"):
        reflected(BALL, VIEW, light, 1, rays=0)
