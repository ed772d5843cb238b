import numpy as np
import pytest

from harmface.stereo.cues import structure_field
from harmface.stereo.cues.field import CELLS, RIM_WIDTH, SMOOTHING, smooth
from harmface.stereo.stack import index_of


def test_a_mean_over_neighbours_keeps_what_is_constant_up_to_the_rim(egg):
    values = np.full((len(egg.normals), 2), 3.0)
    assert np.allclose(smooth(values, egg.mask), 3.0, rtol=1e-12)
    around = smooth(egg.normals, egg.mask)
    assert np.abs(around - egg.normals).max() > 1e-3


def test_derivatives_of_a_plane_are_its_slopes():
    mask = np.ones((30, 40), bool)
    rows, columns = np.nonzero(mask)
    plane = np.stack([2.0 * columns - 3.0 * rows, 1.0 * rows], axis=1)
    seen = structure_field(plane, mask, np.ones(1200), np.ones(1200))
    assert len(seen.middle) == CELLS
    # The window ends at four deviations, so within them of the border it is not symmetric.
    cells = np.stack(np.nonzero(np.ones((29, 39), bool)), axis=1)
    cells = cells[np.linspace(0, len(cells) - 1, CELLS).astype(int)]
    away = ((cells > 5) & (cells < (23, 33))).all(axis=1)
    assert away.sum() > 100
    assert np.allclose(seen.along_x[away], (2, 0), atol=1e-9)
    assert np.allclose(seen.along_y[away], (3, -1), atol=1e-9)


def test_noise_of_derivatives_is_that_of_draws(rng):
    mask = np.ones((120, 120), bool)
    draws = 0.3 * rng.standard_normal((mask.sum(), 8))
    seen = structure_field(draws, mask, np.ones(len(draws)), np.full(len(draws), 0.3))
    each = np.concatenate([seen.along_x[seen.inner], seen.along_y[seen.inner]])
    # Some 1500 derivatives that do not hang together know a deviation to 2 %; a difference over a
    # cell averages those of a window of 1.5 pixels by 1 - 1 / (12 * 1.5^2) * 3 / 2 or so.
    assert each.std() == pytest.approx(seen.noise.mean(), rel=0.15)
    assert np.allclose(seen.noise, 0.3 / np.sqrt(8 * np.pi) / SMOOTHING**2)


def test_inner_cells_keep_away_from_the_outline_but_not_from_the_picture():
    mask = np.ones((12, 12), bool)
    mask[:, 6:] = False
    seen = structure_field(np.ones((72, 1)), mask, np.ones(72), np.ones(72))
    columns = np.tile(np.arange(5), 11)
    assert np.array_equal(seen.inner, columns + 1 < 6 - RIM_WIDTH)


def test_pixels_are_numbered_within_the_mask():
    mask = np.array([[True, False], [True, True]])
    assert index_of(mask).tolist() == [[0, -1], [1, 2]]
