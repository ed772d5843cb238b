import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io.npz import write_npz
from harmface.io.probe_grids import KIND, VERSION, read_probe_grid, write_probe_grid
from harmface.light import ProbeGrid


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_grids_come_back_exactly(tmp_path, rng, dtype):
    path = tmp_path / "probes.npz"
    grid = ProbeGrid(rng.random(3), rng.random(3), rng.random((2, 3, 1, 3, 9)).astype(dtype))
    write_probe_grid(path, grid)
    found = read_probe_grid(path)
    for name in ("origin", "spacing", "coefficients"):
        np.testing.assert_array_equal(getattr(found, name), getattr(grid, name))
        assert getattr(found, name).dtype == getattr(grid, name).dtype


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"origin": np.zeros(3), "spacing": np.ones(3)}, "no array 'coefficients'"),
        (
            {"origin": np.zeros(3), "spacing": -np.ones(3), "coefficients": np.ones((1, 1, 1, 9))},
            "positive",
        ),
        (
            {"origin": np.zeros(3), "spacing": np.ones(3), "coefficients": np.ones((1, 1, 1, 8))},
            "square",
        ),
    ],
)
def test_files_that_hold_no_grid_are_refused(unchecked, tmp_path, arrays, said):
    path = tmp_path / "probes.npz"
    write_npz(path, KIND, VERSION, arrays)
    with pytest.raises(FileError, match=said):
        read_probe_grid(path)


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "other.npz"
    write_npz(path, "gallery", VERSION, {"origin": np.zeros(3)})
    with pytest.raises(FileError, match="gallery"):
        read_probe_grid(path)
