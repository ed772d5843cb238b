import functools
import operator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from harmface.errors import ArgumentError
from harmface.light import (
    DiscLight,
    PointLight,
    PolygonLight,
    SphereLight,
    cone,
    directional_lights,
)
from harmface.sphere import gauss_legendre, real_harmonics, rotate
from tests.unit.light.rooms import walls

ONE = np.array(1.0)
ORIGIN = np.zeros((1, 3))
DOWN = np.array([0.0, 0.0, -1.0])
SQUARE = np.array([[-0.5, -0.5, 1], [-0.5, 0.5, 1], [0.5, 0.5, 1], [0.5, -0.5, 1]])
ARROW = np.array([[0.6, 0.0, 1.2], [-0.5, -0.5, 1.0], [0.0, 0.0, 1.1], [-0.5, 0.5, 1.0]])
ARROW[:, 2] = 1.2 + 0.3 * ARROW[:, 0]
LIGHTS = {
    "square": PolygonLight(SQUARE, ONE),
    "arrow": PolygonLight(ARROW, ONE),
    "disc": DiscLight(np.array([0.3, 0.2, 1.0]), np.array([0.0, 0.6, -0.8]), 0.5, ONE),
    "sphere": SphereLight(np.array([0.3, 0.2, 1.0]), 0.4, ONE),
    "point": PointLight(np.array([0.3, 0.2, 1.0]), ONE),
}
ZONAL = [0, 2, 6, 12, 20]


def test_the_unit_square_over_the_origin():
    found = LIGHTS["square"].probes(ORIGIN, 2)
    coefficients, gradients = found.coefficients[0], found.gradients[0]
    assert coefficients[0] * np.sqrt(4 * np.pi) == pytest.approx(0.8054317, abs=1e-7)
    np.testing.assert_allclose(coefficients[[0, 2, 6]], [0.227208, 0.367563, 0.412026], atol=1e-6)
    np.testing.assert_allclose(gradients[[0, 2, 6], 2], [0.368527, 0.554639, 0.521899], atol=1e-6)
    np.testing.assert_allclose(gradients[[3, 7], 0], [-0.277319, -0.539202], atol=1e-6)
    # Towards the other side nothing shines.
    behind = LIGHTS["square"].probes(np.array([[0.0, 0.0, 2.0]]), 2)
    assert not behind.coefficients.any() and not behind.gradients.any()


def test_a_closed_room_is_the_same_everywhere():
    places = np.array([[-0.4, -0.6, 0.2], [0.8, 0.0, -0.98]])
    total = functools.reduce(operator.add, [wall.probes(places, 4) for wall in walls(ONE)])
    np.testing.assert_allclose(total.coefficients[:, 0], 3.5449077, atol=1e-7)
    assert np.abs(total.coefficients[:, 1:]).max() < 1e-13
    assert np.abs(total.gradients).max() < 1e-12


@pytest.mark.parametrize(
    ("distance", "values", "slopes"),
    [
        (
            2.0,
            [0.237464, 0.383748, 0.429043, 0.403002, 0.323787],
            [-0.255832, -0.383748, -0.357536, -0.219819, -0.017988],
        ),
        (4.0, [0.056283, 0.095937, 0.119921, 0.135097, 0.143294], None),
    ],
)
def test_spheres_at_two_distances(distance, values, slopes):
    light = SphereLight(np.array([0.0, 0.0, distance]), 1.0, ONE)
    found = light.probes(ORIGIN, 4)
    np.testing.assert_allclose(found.coefficients[0, ZONAL], values, atol=1e-6)
    if slopes:  # by the distance, which falls as the point rises
        np.testing.assert_allclose(-found.gradients[0, ZONAL, 2], slopes, atol=1e-6)


@pytest.mark.parametrize("name", LIGHTS)
def test_gradients_are_differences(name, rng):
    light, points, step = LIGHTS[name], 0.15 * rng.standard_normal((20, 3)), 1e-4
    moved = [
        light.probes(points + step * axis, 4).coefficients
        - light.probes(points - step * axis, 4).coefficients
        for axis in np.eye(3)
    ]
    expected = np.stack(moved, axis=-1) / (2 * step)
    # Differences leave out the third derivative, of the order of 10 times the step squared.
    np.testing.assert_allclose(light.probes(points, 4).gradients, expected, atol=1e-6)


def by_area(light, points, max_degree, splits=40):
    """Coefficients by summing over small pieces of the surface, nothing of its outline used."""
    vertices, faces = light.triangles()
    corner, one, two = np.moveaxis(vertices[faces], 1, 0)
    one, two = one - corner, two - corner
    i, j = np.meshgrid(np.arange(splits), np.arange(splits), indexing="ij")
    lower = np.stack([i + 1 / 3, j + 1 / 3], -1)[i + j < splits]
    upper = np.stack([i + 2 / 3, j + 2 / 3], -1)[i + j < splits - 1]
    uv = np.concatenate([lower, upper]) / splits
    where = corner[:, None] + uv[:, :1] * one[:, None] + uv[:, 1:] * two[:, None]
    areas = np.cross(one, two)[:, None] / 2 / len(uv)
    found = []
    for point in points:
        offsets = where - point
        distance = np.linalg.norm(offsets, axis=-1)
        facing = np.maximum(
            -np.einsum("fni,fni->fn", offsets, np.broadcast_to(areas, offsets.shape)), 0
        )
        weights = facing / distance**3
        basis = real_harmonics(offsets / distance[..., None], max_degree)
        found.append(np.einsum("kfn,fn->k", basis, weights))
    return np.array(found)


@pytest.mark.parametrize("name", ["square", "arrow", "disc", "sphere"])
def test_coefficients_are_sums_over_the_surface(name, rng):
    light, points = LIGHTS[name], 0.2 * rng.standard_normal((3, 3))
    splits = 40 if name in ("square", "arrow") else 4
    expected = by_area(light, points, 4, splits)
    # A rim of 128 sides has 4e-4 less area; the ball's facets lie off it by as much.
    tolerance = 2e-4 if splits == 40 else 1.5e-3
    np.testing.assert_allclose(light.probes(points, 4).coefficients, expected, atol=tolerance)


@given(st.floats(0.05, 20), st.floats(0.05, 20))
def test_a_disc_seen_along_its_axis_is_a_cone(distance, radius):
    light = DiscLight(np.array([0.0, 0.0, distance]), DOWN, radius, ONE)
    expected = cone(-DOWN, np.arctan2(radius, distance), 1.0, 6)
    np.testing.assert_allclose(light.probes(ORIGIN, 6).coefficients[0], expected, atol=1e-12)


@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(LIGHTS)))
def test_turning_the_scene_turns_the_coefficients(seed, name):
    rotation = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    light = LIGHTS[name]
    turned = {
        PolygonLight: lambda: PolygonLight(light.vertices @ rotation.T, ONE),
        DiscLight: lambda: DiscLight(
            rotation @ light.center, rotation @ light.normal, light.radius, ONE
        ),
        SphereLight: lambda: SphereLight(rotation @ light.center, light.radius, ONE),
        PointLight: lambda: PointLight(rotation @ light.position, ONE),
    }[type(light)]()
    points = np.array([[0.1, -0.2, 0.05]])
    before, after = light.probes(points, 4), turned.probes(points @ rotation.T, 4)
    np.testing.assert_allclose(
        after.coefficients, rotate(before.coefficients, rotation), atol=1e-11
    )
    slopes = rotate(np.moveaxis(before.gradients, -1, 0), rotation)
    np.testing.assert_allclose(
        np.moveaxis(after.gradients, -1, 0), np.tensordot(rotation, slopes, axes=1), atol=1e-10
    )


@pytest.mark.parametrize("name", LIGHTS)
def test_far_away_all_are_distant_lights(name):
    light = LIGHTS[name]
    far = np.array([0.0, 0.0, -200.0])
    expected = directional_lights(light.as_distant_light(far), 3)
    np.testing.assert_allclose(
        light.probes(far[None], 3).coefficients[0], expected, atol=1e-4 * expected[0]
    )


def test_the_light_vector_is_the_integral_of_radiance_times_direction():
    rule = gauss_legendre(60)
    angle = np.arcsin(0.5)
    seen = rule.directions[:, 2] > np.cos(angle)
    expected = (rule.weights * seen) @ rule.directions
    light = SphereLight(np.array([0.0, 0.0, 2.0]), 1.0, np.array([1.0, 3.0])).as_distant_light(
        np.zeros(3)
    )
    assert light.irradiances[:, 0] == pytest.approx([np.pi / 4, 3 * np.pi / 4])
    assert abs(expected[2] - np.pi / 4) < 0.1


def test_channels_lead(rng):
    light = PolygonLight(SQUARE, np.array([1.0, 2.0, 0.0]))
    found = light.probes(0.1 * rng.standard_normal((4, 3)), 2)
    assert found.coefficients.shape == (4, 3, 9) and found.gradients.shape == (4, 3, 9, 3)
    np.testing.assert_allclose(found.coefficients[:, 1], 2 * found.coefficients[:, 0])
    assert not found.coefficients[:, 2].any()


def test_an_edge_seen_end_on_counts_for_nothing():
    light = PolygonLight(np.array([[0, 0, 1.0], [0, 0, 2], [0, 1, 2], [0, 1, 1]]), ONE)
    sign = np.sign(light.area_vector[0])
    near = light.probes(np.array([[sign * 0.3, 0, 0], [sign * 0.3, 1e-13, 0]]), 3)
    assert np.isfinite(near.gradients).all()
    np.testing.assert_allclose(near.coefficients[0], near.coefficients[1], atol=1e-9)
    above = PolygonLight(np.array([[0, 0, 1.0], [0, 0, 2], [1, 1, 2], [1, 1, 1]]), ONE)
    front = above.area_vector / np.linalg.norm(above.area_vector)
    found = above.probes((np.array([0, 0, -3.0]) + 0.5 * front)[None], 3)
    assert np.isfinite(found.coefficients).all()


def test_nonsense_is_refused(unchecked):
    for match, call in {
        "in one plane, got": lambda: PolygonLight(SQUARE + np.diag([0, 0, 0.1, 0])[:, :3], ONE),
        "span an area": lambda: PolygonLight(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), ONE),
        "three or more": lambda: PolygonLight(SQUARE[:2], ONE),
        "radiance must not be negative": lambda: PolygonLight(SQUARE, np.array(-1.0)),
        "intensity must not be negative": lambda: PointLight(np.zeros(3), np.array(-1.0)),
        "radius must be above 0": lambda: SphereLight(np.zeros(3), 0.0, ONE),
        "normal must be unit": lambda: DiscLight(np.zeros(3), np.array([0, 0, 2.0]), 1.0, ONE),
        "center must have shape": lambda: SphereLight(np.zeros(2), 1.0, ONE),
        "plane of the polygon": lambda: LIGHTS["square"].probes(np.array([[5.0, 0, 1]]), 2),
        "plane of the disc": lambda: DiscLight(np.zeros(3), DOWN, 1.0, ONE).probes(
            np.array([[5.0, 0, 0]]), 2
        ),
        "outside the sphere": lambda: LIGHTS["sphere"].probes(np.array([[0.3, 0.2, 0.7]]), 2),
        "where the point light is": lambda: LIGHTS["point"].probes(np.array([[0.3, 0.2, 1.0]]), 2),
        "receives nothing": lambda: LIGHTS["square"].as_distant_light(np.array([0, 0, 3.0])),
    }.items():
        with pytest.raises(ArgumentError, match=match):
            call()
