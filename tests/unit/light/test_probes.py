import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.io import read_probe_grid, write_probe_grid
from harmface.light import ProbeGrid, Probes, SphereLight, farthest_points

LAMP = SphereLight(np.array([0.5, 1.0, 2.0]), 0.3, np.array([1.0, 0.5]))


def grid(count, *, gradients=True):
    axes = np.linspace(-0.5, 0.5, count)
    points = np.stack(np.meshgrid(axes, axes, axes, indexing="ij"), -1)
    found = LAMP.probes(points.reshape(-1, 3), 2)
    shape = (count,) * 3
    return ProbeGrid(
        np.full(3, -0.5),
        np.full(3, 1 / (count - 1)),
        found.coefficients.reshape(*shape, 2, 9),
        found.gradients.reshape(*shape, 2, 9, 3) if gradients else None,
    )


def test_one_probe_is_carried_by_its_gradient(rng):
    found = LAMP.probes(np.zeros((1, 3)), 2)
    points = rng.standard_normal((5, 3))
    expected = found.coefficients[0] + np.einsum("cki,ni->nck", found.gradients[0], points)
    np.testing.assert_allclose(found.at(points), expected, atol=1e-14)
    np.testing.assert_allclose(
        found.at(points, gradient=False), np.stack([found.coefficients[0]] * 5)
    )


def test_the_error_falls_with_the_square_of_the_distance():
    found = LAMP.probes(np.zeros((1, 3)), 2)
    direction = np.array([[0.6, 0.0, 0.8]])
    errors = [
        np.abs(found.at(s * direction) - LAMP.probes(s * direction, 2).coefficients).max()
        for s in (0.1, 0.05)
    ]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2)


def test_several_probes_are_weighted_by_inverse_distance(rng):
    places = np.array([[0.0, 0, 0], [1, 0, 0], [0, 3, 0]])
    found = LAMP.probes(places, 1)
    point = np.array([[0.5, 0.2, 0.1]])
    weights = np.linalg.norm(point - places, axis=1) ** -3.0
    each = found.coefficients + np.einsum("pcki,pi->pck", found.gradients, point - places)
    expected = np.tensordot(weights / weights.sum(), each, axes=1)
    np.testing.assert_allclose(found.at(point, exponent=3.0)[0], expected)
    np.testing.assert_allclose(found.at(places), found.coefficients, atol=1e-14)
    assert np.isfinite(found.at(places + 1e-200, exponent=50.0)).all()


def test_a_grid_with_gradients_has_both_at_its_probes(rng):
    both = grid(3)
    inner = np.zeros((1, 3))
    np.testing.assert_allclose(both.at(inner), LAMP.probes(inner, 2).coefficients, atol=1e-14)
    step = 1e-5
    slopes = [
        (both.at(inner + step * a) - both.at(inner - step * a)) / (2 * step) for a in np.eye(3)
    ]
    np.testing.assert_allclose(np.stack(slopes, -1), LAMP.probes(inner, 2).gradients, atol=1e-4)


def test_gradients_make_a_grid_better_by_far(rng):
    points = rng.uniform(-0.5, 0.5, (200, 3))
    truth = LAMP.probes(points, 2).coefficients
    plain, better = (np.abs(grid(3, gradients=g).at(points) - truth).max() for g in (False, True))
    assert better < 0.2 * plain
    # Halving the spacing divides the error of values alone by 4, of both by nearly 8 or more.
    assert np.abs(grid(5).at(points) - truth).max() < better / 4


def test_grids_are_written_with_their_gradients(tmp_path):
    write_probe_grid(tmp_path / "g.npz", grid(2))
    assert np.array_equal(read_probe_grid(tmp_path / "g.npz").gradients, grid(2).gradients)
    write_probe_grid(tmp_path / "g.npz", grid(2, gradients=False))
    assert read_probe_grid(tmp_path / "g.npz").gradients is None


def test_farthest_points_spread(rng):
    points = rng.uniform(-1, 1, (500, 3))
    chosen = farthest_points(points, 9)
    np.testing.assert_allclose(chosen[0], points.mean(axis=0))
    gaps = np.linalg.norm(chosen[:, None] - chosen, axis=-1)[np.triu_indices(9, 1)]
    covered = np.linalg.norm(points[:, None] - chosen, axis=-1).min(axis=1).max()
    assert gaps.min() >= covered


def test_thinned_probes_are_those_that_err_least_everywhere(rng):
    found = LAMP.probes(rng.uniform(-1, 1, (12, 3)), 2)

    def error(which):
        some = Probes(found.positions[which], found.coefficients[which], found.gradients[which])
        return np.square(some.at(found.positions) - found.coefficients).sum()

    first, pair = (found.thinned(count).positions for count in (1, 2))
    best = min(range(12), key=lambda i: error([i]))
    assert np.array_equal(first, found.positions[[best]])
    assert np.array_equal(pair[:1], first)
    next_best = min((i for i in range(12) if i != best), key=lambda i: error([best, i]))
    assert np.array_equal(pair[1], found.positions[next_best])
    everywhere = found.thinned(12)
    np.testing.assert_allclose(everywhere.at(found.positions), found.coefficients, rtol=1e-12)


def test_nonsense_is_refused(unchecked):
    one = LAMP.probes(np.zeros((1, 3)), 1)
    for match, call in {
        "must agree": lambda: Probes(np.zeros((2, 3)), one.coefficients, one.gradients),
        "square": lambda: Probes(np.zeros((1, 3)), np.ones((1, 5)), np.ones((1, 5, 3))),
        "exponent must be above 0": lambda: one.at(np.zeros((1, 3)), exponent=0.0),
        "positions of light that is added": lambda: one + LAMP.probes(np.ones((1, 3)), 1),
        "gradients must have shape": lambda: ProbeGrid(
            np.zeros(3), np.ones(3), np.ones((2, 2, 2, 4)), np.ones((2, 2, 2, 4))
        ),
        "count must be at most the 1 probes": lambda: one.thinned(2),
        "count must be 1": lambda: farthest_points(np.zeros((2, 3)), 0),
    }.items():
        with pytest.raises(ArgumentError, match=match):
            call()
