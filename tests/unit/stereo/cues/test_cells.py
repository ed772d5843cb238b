import numpy as np

from harmface.stereo.cues.cells import cells_of


def test_cells_differentiate_a_plane(rng):
    mask = rng.random((9, 11)) < 0.9
    rows, columns = np.nonzero(mask)
    cells = cells_of(mask)
    whole = mask[:-1, :-1] & mask[:-1, 1:] & mask[1:, :-1] & mask[1:, 1:]
    field = (3.0 * columns - 2.0 * rows)[:, None]
    assert len(cells.corners) == whole.sum()
    assert np.allclose(cells.along_x(field), 3)
    assert np.allclose(cells.along_y(field), 2)
    middles = np.stack(np.nonzero(whole), axis=1) + 0.5
    assert np.allclose(cells.middle(field)[:, 0], middles @ (-2.0, 3.0))


def test_cells_are_thinned_evenly():
    cells = cells_of(np.ones((21, 21), bool))
    thinned = cells.thinned(10).corners
    assert np.array_equal(thinned[[0, -1]], cells.corners[[0, -1]])
    steps = np.diff(thinned[:, 0])
    assert len(thinned) == 10
    # 399 cells in 9 steps, each row of 20 cells leaving out a pixel.
    assert steps.min() > 40
    assert cells.thinned(400) is cells
