import numpy as np

from harmface.stereo import angular_errors, without_convexity, without_linear_map
from harmface.stereo.cells import cells_of
from harmface.stereo.integrability import integrable_rows, isometric_rows, wedge
from harmface.stereo.lorentz import METRIC, lorentz_transformation

RNG = np.random.default_rng(4)


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def test_wedge_is_the_minors():
    v, w = RNG.standard_normal((2, 5, 3))
    x, y, z = np.cross(v, w).T
    assert np.allclose(wedge(v, w), np.stack([z, -y, x], axis=1))


def test_cells_differentiate_a_plane():
    mask = RNG.random((9, 11)) < 0.9
    rows, columns = np.nonzero(mask)
    cells = cells_of(mask)
    whole = mask[:-1, :-1] & mask[:-1, 1:] & mask[1:, :-1] & mask[1:, 1:]
    field = (3.0 * columns - 2.0 * rows)[:, None]
    assert len(cells.corners) == whole.sum()
    assert np.allclose(cells.along_x(field), 3)
    assert np.allclose(cells.along_y(field), 2)
    assert len(cells.thinned(10).corners) == 10


def test_three_rows_are_found_up_to_bas_relief(hills):
    mixing = RNG.standard_normal((3, 3))
    rows = integrable_rows(mixing @ hills.normals.T, cells_of(hills.mask))
    # What is left maps b_x and b_y to themselves plus multiples of b_z.
    left = rows @ mixing
    left /= left[0, 0]
    # Differences over cells of a relief with 20 cells to its shortest wave err by a few percent.
    assert np.abs(left[2, :2]).max() < 0.05 * abs(left[2, 2])
    assert abs(left[0, 1]) < 0.05
    assert np.allclose(left[:2, :2], np.eye(2), atol=0.05)


def test_lorentz_ambiguity_is_resolved_in_closed_form(hills):
    null = hills.null_vectors / hills.albedo
    mixed = lorentz_transformation(np.array([0.3, -0.2, 0.25, 0.4, 1.0, -0.5])) @ null
    rows = isometric_rows(integrable_rows(mixed, cells_of(hills.mask)), -METRIC)
    assert np.allclose(rows @ -METRIC @ rows.T, np.eye(3), atol=1e-12)
    normals = unit((rows @ mixed).T)
    normals *= np.sign(normals[:, 2].sum())
    # Second differences of the shortest wave, 20 pixels: (2 pi / 20)^2 / 12 = 0.8 %.
    assert angular_errors(without_convexity(normals, hills.normals), hills.normals).mean() < 1.0


def test_rows_that_no_transformation_has_are_refused():
    # What lies within the cone: the third row, the first, the first two.
    assert isometric_rows(np.eye(4)[[1, 2, 0]], -METRIC) is None
    assert isometric_rows(np.eye(4)[[0, 2, 3]], -METRIC) is None
    assert (
        isometric_rows(np.array([[5.0, 1, 0, 0], [5.0, 0, 1, 0], [0, 0, 0, 1.0]]), -METRIC) is None
    )
    kept = isometric_rows(np.eye(4)[[1, 2, 3]], -METRIC)
    assert np.array_equal(kept, np.eye(4)[1:])


def test_oracle_undoes_a_linear_map(hills):
    b = hills.b @ RNG.standard_normal((3, 3))
    assert angular_errors(without_linear_map(b, hills.normals), hills.normals).max() < 1e-4
