import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_merl
from harmface.io.merl import SHAPE, SIZE

HEADER = np.array(SHAPE, "<i4").tobytes()


def written(path, values, header=HEADER):
    path.write_bytes(header + np.asarray(values, "<f8").tobytes())
    return path


def constant(value=1500.0):
    return np.full((3, *SHAPE), value)


def test_channels_are_scaled_and_markers_masked_and_counted(tmp_path):
    values = constant()
    values[:, 80:] = -1
    values[1, 0, 0, 0] = -1
    found = read_merl(written(tmp_path / "white.binary", values))
    assert found.missing == 10 * 90 * 180 + 1
    up = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]])
    seen = found.evaluate(up, up * [-1, 1, 1])
    np.testing.assert_allclose(seen, [[1, 1], [1.15, 1.15], [1.66, 1.66]])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda values: (values[:, :-1], HEADER), f"a MERL table of 90 x 90 x 180.*{SIZE}"),
        (lambda values: (values, np.array([90, 180, 90], "<i4").tobytes()), "says .*in its header"),
        (lambda values: (values * np.nan, HEADER), "NaN or infinity in 4374000 of"),
        (lambda values: (values * 0 - 1, HEADER), "holds no measurement"),
    ],
)
def test_other_files_are_refused(change, message, tmp_path):
    values, header = change(constant())
    with pytest.raises(FileError, match=message):
        read_merl(written(tmp_path / "bad.binary", values, header))
