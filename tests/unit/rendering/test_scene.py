import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import DiscLight, PointLight, PolygonLight, SphereLight
from harmface.rendering import Scene, Surface, probes, ray_cast_probes, sampled_light
from tests.unit.light.rooms import walls

SQUARE = np.array([[-0.5, -0.5, 1], [-0.5, 0.5, 1], [0.5, 0.5, 1], [0.5, -0.5, 1]])
RED, BLUE = np.array([1.0, 0.0]), np.array([0.0, 1.0])
DOWN = np.array([0.0, 0.0, -1.0])
POINTS = np.array([[0.0, 0.0, 0.0], [0.1, 0.05, 0.02], [-0.2, 0.3, -0.1]])


def window(z=1.237, shift=(0.07, 0.04)):
    """A square whose edges fall between the rays of the cube maps."""
    return PolygonLight(np.add(SQUARE, (*shift, z - 1)), RED)


LAMPS = {
    "polygon": window(),
    "disc": DiscLight(np.array([0.3, 0.2, 1.0]), np.array([0.0, 0.6, -0.8]), 0.4, RED),
    "sphere": SphereLight(np.array([0.3, 0.2, 1.0]), 0.4, RED),
}


def relative(found, truth):
    return np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2))


@pytest.mark.parametrize("name", LAMPS)
def test_cube_maps_see_what_the_closed_forms_say(name):
    scene = Scene((LAMPS[name],))
    exact = probes(scene, POINTS, 3)
    errors = []
    for size in (16, 64):
        cast = ray_cast_probes(scene, POINTS, 3, size)
        errors.append(
            [
                relative(cast.coefficients, exact.coefficients),
                relative(cast.gradients, exact.gradients),
            ]
        )
    # A lamp is some 30 pixels wide, and the outermost decide the gradient.
    assert (np.array(errors[1]) < 0.05).all()
    assert (np.array(errors[1]) < 0.5 * np.array(errors[0])).all()


@pytest.mark.parametrize("name", LAMPS)
def test_the_reference_sees_the_same(name):
    scene = Scene((LAMPS[name],))
    found = sampled_light(scene, POINTS, 3, 1024)
    assert relative(found, probes(scene, POINTS, 3).coefficients) < 2e-3


def test_a_room_of_one_radiance_is_the_same_everywhere():
    found = ray_cast_probes(Scene(tuple(walls(RED))), POINTS, 2)
    np.testing.assert_allclose(found.coefficients[:, 0, 0], np.sqrt(4 * np.pi), rtol=1e-3)
    # What the grid of rays leaves of an exact 0, against 3.5 for the light itself.
    assert np.abs(found.gradients).max() < 0.1


def test_what_hides_a_lamp_is_in_the_light_but_not_in_its_gradient():
    blocker = DiscLight(np.array([0.3, 0.2, 0.8]), DOWN, 0.3, BLUE)
    scene = Scene((window(), blocker))
    truth = sampled_light(scene, POINTS, 3, 4096)
    found = probes(scene, POINTS, 3, 128)
    assert relative(found.coefficients, truth) < 0.02
    open_sky = probes(Scene((window(),)), POINTS, 3).coefficients
    assert relative(found.coefficients[:, 0], open_sky[:, 0]) > 0.1


def test_dark_surfaces_stand_in_the_way_and_the_back_of_a_lamp_is_dark():
    mesh = LAMPS["disc"]
    wall = Surface(SQUARE * [3, 3, 0.5], np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2))
    for turned in (wall, Surface(wall.vertices, wall.faces[:, ::-1], wall.radiance)):
        scene = Scene((mesh,), (turned,))
        assert not probes(scene, POINTS[:2], 2).coefficients.any()
        assert not sampled_light(scene, POINTS[:2], 2).any()
    behind = np.array([[0.3, -1.5, 3.0]])
    assert not ray_cast_probes(Scene((mesh,)), behind, 2).coefficients.any()


def test_point_lights_are_hidden_or_not():
    lamp = PointLight(np.array([0.0, 0.0, 1.0]), RED)
    alone = probes(Scene((lamp,)), POINTS, 2)
    np.testing.assert_allclose(alone.coefficients, lamp.probes(POINTS, 2).coefficients)
    np.testing.assert_allclose(sampled_light(Scene((lamp,)), POINTS, 2), alone.coefficients)
    assert not ray_cast_probes(Scene((lamp,)), POINTS, 2).coefficients.any()
    near = Surface(SQUARE * [0.1, 0.1, 0.5], np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2))
    far = Surface(SQUARE * [0.1, 0.1, 1.5], np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2))
    hidden = probes(Scene((lamp,), (near,)), POINTS, 2)
    assert not hidden.coefficients[0].any() and not hidden.gradients[0].any()
    np.testing.assert_allclose(hidden.coefficients[2], alone.coefficients[2])
    np.testing.assert_allclose(
        probes(Scene((lamp,), (far,)), POINTS, 2).coefficients, alone.coefficients
    )


def test_nonsense_is_refused():
    for match, call in {
        "not dark": lambda: Scene(()),
        "same number of channels": lambda: Scene(
            (LAMPS["disc"], SphereLight(np.zeros(3), 1.0, np.ones(3)))
        ),
        "same number of channels, got": lambda: Scene(
            (SphereLight(np.zeros(3), 1.0, np.array(1.0)),)
        ),
        "outside the sphere": lambda: probes(
            Scene((LAMPS["sphere"], LAMPS["polygon"])), np.array([[0.3, 0.2, 0.9]]), 2
        ),
        "size must be 1": lambda: ray_cast_probes(Scene((LAMPS["disc"],)), POINTS, 2, 0),
        "samples must be 1": lambda: sampled_light(Scene((LAMPS["disc"],)), POINTS, 2, 0),
        "points must be finite": lambda: probes(Scene((LAMPS["disc"],)), POINTS * np.nan, 2),
    }.items():
        with pytest.raises(ArgumentError, match=match):
            call()


def test_a_surface_seen_edge_on_does_not_blow_the_gradient_up():
    # A wall along one column of pixels of the +z face, which its rays meet at 1e-4 radians.
    tilt = 1 / 32
    low, high = np.array([tilt - 1e-4, 0, 1]), np.array([0.0, 1, 0])
    wall = np.array([0.5 * low - high, 2 * low - high, 2 * low + high, 0.5 * low + high])
    lamp = PolygonLight(wall, RED)
    if lamp.area_vector[0] > 0:
        lamp = PolygonLight(wall[::-1], RED)
    point = 1e-4 * lamp.area_vector[None] / np.linalg.norm(lamp.area_vector)
    found = ray_cast_probes(Scene((lamp,)), point, 2, 32)
    assert found.coefficients.any()
    # Some twenty pixels of 0.004 steradians: with 1 / 1e-4 it would be more than a hundred.
    assert np.abs(found.gradients).max() < 5
