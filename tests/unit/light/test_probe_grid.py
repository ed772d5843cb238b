import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.light import ProbeGrid, ScatteredProbes


def field(points):
    """Return coefficients (3, 4) that are linear in the place."""
    slopes = np.arange(36.0).reshape(3, 3, 4) / 7
    return 1 + np.tensordot(points, slopes, axes=1)


def grid(shape=(3, 2, 4)):
    origin, spacing = np.array([1.0, -2.0, 0.5]), np.array([0.5, 2.0, 1.0])
    places = origin + spacing * np.moveaxis(np.indices(shape), 0, -1)
    return ProbeGrid(origin, spacing, field(places)), places


def test_probes_have_their_own_light():
    probes, places = grid()
    np.testing.assert_allclose(probes.at(places), probes.coefficients, atol=1e-14)


def test_between_probes_light_is_trilinear(rng):
    probes, places = grid()
    low, high = places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)
    points = rng.uniform(low, high, (20, 5, 3))
    assert probes.at(points).shape == (20, 5, 3, 4)
    np.testing.assert_allclose(probes.at(points), field(points), atol=1e-12)


def test_in_the_middle_of_eight_probes_is_their_mean(rng):
    probes = ProbeGrid(np.zeros(3), np.ones(3), rng.random((2, 2, 2, 9)))
    expected = probes.coefficients.mean(axis=(0, 1, 2))
    np.testing.assert_allclose(probes.at(np.full(3, 0.5)), expected, atol=1e-15)


def test_outside_a_grid_is_the_light_of_its_surface():
    probes, places = grid()
    beyond = places[-1, 0, 2] + [9.0, -9.0, 0.25]
    np.testing.assert_allclose(
        probes.at(beyond), field(places[-1, 0, 2] + [0, 0, 0.25]), atol=1e-12
    )


def test_a_single_probe_lights_everything(rng):
    probes = ProbeGrid(np.zeros(3), np.ones(3), rng.random((1, 1, 1, 9)))
    found = probes.at(rng.standard_normal((5, 3)))
    np.testing.assert_array_equal(found, np.tile(probes.coefficients[0, 0, 0], (5, 1)))


def test_scattered_probes_are_linear_inside_and_nearest_outside(rng):
    places = rng.random((30, 3))
    probes = ScatteredProbes(places, field(places))
    inside = places[:4].mean(axis=0) * 0.5 + places[4:8].mean(axis=0) * 0.5
    np.testing.assert_allclose(probes.at(inside), field(inside), atol=1e-12)
    np.testing.assert_allclose(probes.at(places), field(places), atol=1e-12)
    outside = np.array([[5.0, 5.0, 5.0], inside])
    nearest = np.linalg.norm(places - outside[0], axis=1).argmin()
    np.testing.assert_allclose(probes.at(outside)[0], probes.coefficients[nearest])
    np.testing.assert_allclose(probes.at(outside)[1], field(inside), atol=1e-12)


@pytest.mark.parametrize(
    ("origin", "spacing", "shape", "said"),
    [
        (np.zeros(2), np.ones(3), (1, 1, 1, 9), "shape"),
        (np.zeros(3), np.array([1.0, 0.0, 1.0]), (1, 1, 1, 9), "positive"),
        (np.full(3, np.nan), np.ones(3), (1, 1, 1, 9), "finite"),
        (np.zeros(3), np.ones(3), (1, 1, 1, 8), "square"),
        (np.zeros(3), np.ones(3), (1, 1, 9), "coefficients"),
        (np.zeros(3), np.ones(3), (0, 1, 1, 9), "coefficients"),
    ],
)
def test_grids_that_make_no_sense_are_refused(unchecked, origin, spacing, shape, said):
    with pytest.raises(ArgumentError, match=said):
        ProbeGrid(origin, spacing, np.ones(shape))


@pytest.mark.parametrize(
    ("positions", "count", "said"),
    [
        (np.zeros((3, 3)), (4, 9), "agree"),
        (np.eye(4, 3), (4, 8), "square"),
        (np.eye(3), (3, 9), "not all in one plane"),
        (np.eye(3)[[0, 1, 2, 0, 1, 2]], (6, 9), "not all in one plane"),
        (np.full((4, 3), np.inf), (4, 9), "finite"),
    ],
)
def test_probes_that_span_no_volume_are_refused(unchecked, positions, count, said):
    with pytest.raises(ArgumentError, match=said):
        ScatteredProbes(positions, np.ones(count))


def test_points_must_be_places():
    with pytest.raises(ArgumentError, match="finite"):
        grid()[0].at(np.array([0.0, np.nan, 0.0]))
    with pytest.raises(ArgumentError, match="finite"):
        ScatteredProbes(np.eye(4, 3), np.ones((4, 9))).at(np.array([0.0, np.inf, 0.0]))
