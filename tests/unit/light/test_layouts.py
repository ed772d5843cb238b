import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import LAYOUTS, layout_named
from harmface.light.layouts import FACES, RH01Probe
from harmface.light.layouts.cube import FACE_ROTATIONS
from harmface.sphere import random_directions

EPS = np.finfo(float).eps
NAMES = list(LAYOUTS)


def looks(name, *position, height=1):
    """Return the direction at a position given in fractions of the map's height."""
    *face, row, column = (np.array([float(value)]) for value in position)
    return LAYOUTS[name].directions_at(*face, row * height, column * height, height=height)[0]


@pytest.mark.parametrize(
    ("name", "position", "direction"),
    [
        ("latlong", (0.5, 1.0), (0, 0, 1)),
        ("latlong", (0.5, 0.5), (1, 0, 0)),
        ("latlong", (0.5, 1.5), (-1, 0, 0)),
        ("latlong", (0.5, 0.0), (0, 0, -1)),
        ("latlong", (0.5, 2.0), (0, 0, -1)),
        ("latlong", (0.0, 0.3), (0, 1, 0)),
        ("latlong", (1.0, 0.3), (0, -1, 0)),
        ("latlong", (0.25, 1.0), (0, np.sqrt(0.5), np.sqrt(0.5))),
        ("angular", (0.5, 0.5), (0, 0, 1)),
        ("angular", (0.5, 0.75), (1, 0, 0)),
        ("angular", (0.25, 0.5), (0, 1, 0)),
        ("angular", (0.5, 1.0), (0, 0, -1)),
        ("angular", (1.0, 0.5), (0, 0, -1)),
        ("mirror-ball", (0.5, 0.5), (0, 0, 1)),
        ("mirror-ball", (0.5, 0.5 + np.sqrt(0.125)), (1, 0, 0)),
        ("mirror-ball", (0.5 - np.sqrt(0.125), 0.5), (0, 1, 0)),
        ("mirror-ball", (0.5, 0.0), (0, 0, -1)),
        ("mirror-ball", (0.0, 0.0), (0, 0, -1)),
    ],
)
def test_landmarks(name, position, direction):
    np.testing.assert_allclose(looks(name, *position, height=8), direction, atol=4 * EPS)


# What OpenEXR's CubeMap::direction and CubeMap::pixelPosition say of each face: the axes that
# grow to the right and upwards.
OPENEXR_FACES = {
    "+x": ("+z", "+y"),
    "-x": ("-z", "+y"),
    "+y": ("+x", "+z"),
    "-y": ("+x", "-z"),
    "+z": ("-x", "+y"),
    "-z": ("+x", "+y"),
}


@pytest.mark.parametrize("face", FACES)
def test_cube_faces_are_turned_as_openexr_turns_them(face):
    def axis(name):
        return np.eye(3)["xyz".index(name[1])] * (1 if name[0] == "+" else -1)

    right, up = OPENEXR_FACES[face]
    number = FACES.index(face)
    np.testing.assert_allclose(looks("cube", number, 0.5, 0.5), axis(face), atol=EPS)
    towards = (axis(face) + axis(right)) / np.sqrt(2)
    np.testing.assert_allclose(looks("cube", number, 0.5, 1.0), towards, atol=EPS)
    towards = (axis(face) + axis(up)) / np.sqrt(2)
    np.testing.assert_allclose(looks("cube", number, 0.0, 0.5), towards, atol=EPS)
    turned = FACE_ROTATIONS[number] @ looks("cube", FACES.index("-z"), 0.2, 0.9)
    np.testing.assert_allclose(turned, looks("cube", number, 0.2, 0.9), atol=2 * EPS)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("height", [1, 2, 3, 16, 61])
def test_solid_angles_sum_to_the_sphere(name, height):
    solid_angles = LAYOUTS[name].solid_angles(height)
    assert solid_angles.shape == LAYOUTS[name].shape(height)
    assert solid_angles.min() >= 0
    assert solid_angles.sum() == pytest.approx(4 * np.pi, rel=8 * EPS)


@pytest.mark.parametrize("height", [1, 2, 3, 40])
def test_the_probe_of_rh01_is_the_angular_map_half_a_pixel_off(height):
    probe, angular = RH01Probe(), LAYOUTS["angular"]
    position = (np.arange(0.5, height), np.full(height, 0.5 * height))
    np.testing.assert_array_equal(
        probe.directions_at(*position, height=height),
        angular.directions_at(*(axis - 0.5 for axis in position), height=height),
    )
    directions = random_directions(100, rng=1)
    back = probe.directions_at(*probe.positions_of(directions, height), height=height)
    np.testing.assert_allclose(back, directions, atol=16 * EPS)
    solid_angles = probe.solid_angles(height)
    assert solid_angles.sum() == pytest.approx(4 * np.pi, rel=8 * EPS)
    np.testing.assert_allclose(solid_angles, solid_angles.T, atol=1e-15)
    edges = np.array(probe.pixels_near(np.array([-1.0, height + 1]), np.zeros(2), height=height))
    assert edges.min() >= 0
    assert edges.max() < height


@pytest.mark.parametrize("name", NAMES)
def test_solid_angles_are_those_of_random_directions(name):
    """Uniform directions fall into a pixel as often as its share of the sphere says."""
    layout, height, count = LAYOUTS[name], 4, 400_000
    directions = random_directions(count, rng=5)
    index = tuple(axis.astype(int) for axis in layout.positions_of(directions, height))
    seen = np.zeros(layout.shape(height))
    np.add.at(seen, index, 1)
    expected = count * layout.solid_angles(height) / (4 * np.pi)
    # Counts are binomial: five standard deviations.
    assert (np.abs(seen - expected) <= 5 * np.sqrt(expected) + 1e-9).all()


@pytest.mark.parametrize("name", NAMES)
def test_solid_angles_of_small_pixels_are_area_times_jacobian(name):
    """Away from edges the solid angle tends to |d_row x d_column| of the direction."""
    layout, height = LAYOUTS[name], 64
    solid_angles = layout.solid_angles(height)
    face = (np.array([3.0]),) if name == "cube" else ()
    row, column, step = np.array([20.5]), np.array([27.5]), 1e-3
    by_row, by_column = (
        (
            layout.directions_at(*face, row + down, column + across, height=height)
            - layout.directions_at(*face, row - down, column - across, height=height)
        )
        / (2 * step)
        for down, across in ((step, 0), (0, step))
    )
    jacobian = np.linalg.norm(np.cross(by_row, by_column))
    index = (*(3,) * len(face), 20, 27)
    # The mean over a pixel differs from the centre by second derivatives, (pi / 64)**2 of it.
    assert solid_angles[index] == pytest.approx(jacobian, rel=(np.pi / height) ** 2)


@pytest.mark.parametrize("name", NAMES)
def test_some_rows_are_those_rows_of_all(name):
    layout, rows = LAYOUTS[name], slice(3, 7)
    for method in (layout.directions, layout.solid_angles):
        trailing = (slice(None),) * (method(10).ndim - layout.axes)
        expected = method(10)[(..., rows, slice(None), *trailing)]
        np.testing.assert_allclose(method(10, rows), expected, rtol=1e-12, atol=1e-17)


@pytest.mark.parametrize("name", NAMES)
def test_positions_invert_directions(name):
    layout, height = LAYOUTS[name], 30
    directions = random_directions(500, rng=1)
    back = layout.directions_at(*layout.positions_of(directions, height), height=height)
    # Near the rim of a mirror ball sqrt(1 - r**2) loses half the digits of r.
    atol = 1e-7 if name == "mirror-ball" else 16 * EPS
    np.testing.assert_allclose(back, directions, atol=atol)
    assert np.abs(np.linalg.norm(back, axis=-1) - 1).max() < 4 * EPS


@pytest.mark.parametrize("name", ["latlong", "angular", "cube"])
def test_pixels_beyond_an_edge_look_about_where_the_edge_would(name):
    layout, height = LAYOUTS[name], 32
    *first, rows, columns = layout.shape(height)
    faces = [np.arange(count, dtype=float).reshape(-1, 1, 1) for count in first]
    down, across = np.arange(-1, rows + 1)[:, None] + 0.5, np.arange(-1, columns + 1) + 0.5
    found = layout.directions(height)[layout.pixels_near(*faces, down, across, height=height)]
    meant = layout.directions_at(*faces, down, across, height=height)
    distance = np.linalg.norm(found - meant, axis=-1)
    if name == "angular":
        # Further out nothing is looked up; the nearest pixel inside is two and a half away.
        radius = np.hypot(2 * down / height - 1, 2 * across / height - 1)
        assert distance[radius < 1 + 2 / height].max() < 5 * np.pi / height
    else:
        assert distance.max() < 1.5 * np.pi / height


@pytest.mark.parametrize("name", NAMES)
def test_pixels_inside_are_their_own_nearest(name):
    layout, height = LAYOUTS[name], 16
    index = np.indices(layout.shape(height))
    position = [index[0].astype(float), *(index[1:] + 0.5)] if name == "cube" else index + 0.5
    near = layout.pixels_near(*position, height=height)
    centred = 2 * (index[-2:] + 0.5) / height - 1
    inside = np.hypot(*centred) < 1 if name in ("angular", "mirror-ball") else ...
    for axis, expected in zip(near, index, strict=True):
        np.testing.assert_array_equal(axis[inside], expected[inside])


@pytest.mark.parametrize(
    ("name", "shape", "said"),
    [
        ("latlong", (4, 4), "twice as wide"),
        ("latlong", (0, 0), "twice as wide"),
        ("latlong", (6, 4, 4), "twice as wide"),
        ("angular", (4, 8), "square"),
        ("mirror-ball", (4, 8), "square"),
        ("angular", (0, 0), "square"),
        ("cube", (6, 4, 5), "six square faces"),
        ("cube", (5, 4, 4), "six square faces"),
        ("cube", (24, 4), "six square faces"),
        ("cube", (6, 0, 0), "six square faces"),
    ],
)
def test_shapes_that_fit_no_map_are_refused(name, shape, said):
    with pytest.raises(ArgumentError, match=said):
        LAYOUTS[name].height_of(shape)


@pytest.mark.parametrize("name", NAMES)
def test_height_is_read_from_the_shape(name):
    assert LAYOUTS[name].height_of(LAYOUTS[name].shape(12)) == 12
    assert layout_named(name) is LAYOUTS[name] is layout_named(LAYOUTS[name])


def test_unknown_layout_is_refused():
    with pytest.raises(ArgumentError, match="latlong, angular, mirror-ball, cube"):
        layout_named("octahedral")


def test_height_must_be_positive():
    with pytest.raises(ArgumentError, match="height"):
        LAYOUTS["latlong"].directions(0)
