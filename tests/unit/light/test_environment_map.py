import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, EnvironmentMap, project, sample
from harmface.sphere import random_directions, rotate

EPS = np.finfo(float).eps
QUARTER_ABOUT_Y = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


def noise(layout, height, channels=(3,), seed=0):
    rng = np.random.default_rng(seed)
    return EnvironmentMap(rng.random((*channels, *LAYOUTS[layout].shape(height))), LAYOUTS[layout])


def test_images_have_channels_last_and_radiance_first():
    image = np.random.default_rng(0).random((4, 8, 3))
    environment = EnvironmentMap.from_image(image)
    assert environment.radiance.shape == (3, 4, 8)
    assert np.shares_memory(environment.radiance, image)
    np.testing.assert_array_equal(environment.as_image(), image)
    assert (environment.height, environment.pixels, environment.channels) == (4, (4, 8), (3,))
    grey = EnvironmentMap.from_image(image[..., 0])
    assert (grey.channels, grey.as_image().shape) == ((), (4, 8))
    cube = EnvironmentMap.from_image(np.ones((6, 2, 2, 3)), "cube")
    assert (cube.radiance.shape, cube.height) == ((3, 6, 2, 2), 2)


@pytest.mark.parametrize("shape", [(0, 0, 3), (4, 8, 0), (0, 8)])
def test_maps_without_pixels_are_refused(unchecked, shape):
    with pytest.raises(ArgumentError, match=r"radiance must hold some pixels"):
        EnvironmentMap.from_image(np.ones(shape))


@pytest.mark.parametrize("layout", LAYOUTS)
def test_total_is_the_integral_of_radiance(layout):
    form = LAYOUTS[layout]
    environment = EnvironmentMap(
        np.full((2, *form.shape(9)), [[[1.0]], [[3.0]]])
        if form.axes == 2
        else np.ones((2, *form.shape(9))),
        form,
    )
    expected = [4 * np.pi, 12 * np.pi] if form.axes == 2 else [4 * np.pi] * 2
    np.testing.assert_allclose(environment.total(), expected, rtol=16 * EPS)


def test_turned_maps_show_elsewhere_what_they_showed():
    environment = noise("latlong", 8)
    turned = environment.rotated(QUARTER_ABOUT_Y)
    directions = random_directions(50, rng=0)
    np.testing.assert_allclose(
        sample(turned, directions @ QUARTER_ABOUT_Y.T), sample(environment, directions), atol=1e-12
    )
    np.testing.assert_allclose(
        project(turned, 3), rotate(project(environment, 3), QUARTER_ABOUT_Y), atol=1e-12
    )


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_pixel_becomes_a_light(layout):
    environment = noise(layout, 7)
    light = environment.as_distant_light()
    np.testing.assert_allclose(light.total(), environment.total(), rtol=64 * EPS)
    shows = environment.solid_angles > 0
    assert light.directions.shape == (shows.sum(), 3)
    np.testing.assert_array_equal(light.directions, environment.directions[shows])


@pytest.mark.parametrize("n_directions", [6, 100, 1000])
def test_gathered_lights_keep_power_and_nearly_the_first_moment(n_directions):
    environment = noise("latlong", 32)
    every, few = environment.as_distant_light(), environment.as_distant_light(n_directions)
    assert len(few.directions) <= n_directions < len(every.directions)
    np.testing.assert_allclose(few.total(), every.total(), rtol=256 * EPS)
    moment = every.irradiances @ every.directions - few.irradiances @ few.directions
    # Centroids on the sphere are longer than in the cell by about radius**2 / 2 of the cell.
    cell = 4 * np.pi / n_directions
    assert np.abs(moment).max() < cell * every.total().max() / 2


def test_gathered_lights_leave_a_small_lamp_in_its_place():
    radiance = np.zeros((1, 64, 128))
    radiance[0, 11, 40] = 5.0
    environment = EnvironmentMap(radiance, LAYOUTS["latlong"])
    light = environment.as_distant_light(24)
    lit = light.irradiances[0] > 0
    assert lit.sum() == 1
    np.testing.assert_allclose(light.directions[lit][0], environment.directions[11, 40], atol=1e-12)


@pytest.mark.parametrize("value", [-1e-3, np.nan, np.inf])
def test_radiance_must_be_finite_and_not_negative(value):
    image = np.ones((4, 8))
    image[2, 3] = value
    with pytest.raises(ArgumentError, match="radiance"):
        EnvironmentMap.from_image(image)


@pytest.mark.parametrize("frame", [np.eye(3) * 2, np.ones((3, 3)), np.full((3, 3), np.nan)])
def test_frame_must_be_orthogonal(frame):
    with pytest.raises(ArgumentError, match="frame"):
        EnvironmentMap(np.ones((2, 4)), LAYOUTS["latlong"], frame)


def test_images_of_other_shapes_are_refused():
    with pytest.raises(ArgumentError, match="2 pixel axes"):
        EnvironmentMap.from_image(np.ones((1, 1, 4, 8)))
    with pytest.raises(ArgumentError, match="twice as wide"):
        EnvironmentMap.from_image(np.ones((8, 8, 3)))
    with pytest.raises(ArgumentError, match="one axis of channels"):
        EnvironmentMap(np.ones((2, 3, 4, 8)), LAYOUTS["latlong"]).as_image()


def test_too_few_directions_are_refused():
    with pytest.raises(ArgumentError, match="n_directions must be 6 or more"):
        noise("latlong", 4).as_distant_light(5)
