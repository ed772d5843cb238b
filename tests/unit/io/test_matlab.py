import struct

import numpy as np
import pytest
from scipy.io import savemat

from harmface.errors import FileError
from harmface.io.matlab import read_matlab


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("dtype", ["f8", "f4", "u1", "i2", "u4"])
@pytest.mark.parametrize("shape", [(4, 5, 3), (1, 1), (2, 3)])
def test_arrays_of_numbers_are_read_past_other_variables(tmp_path, rng, compressed, dtype, shape):
    values = (100 * rng.random(shape)).astype(dtype)
    others = {"before": {"a": [1, "text"]}, "N": values, "after": np.array([[1, "x"]], object)}
    savemat(tmp_path / "a.mat", others, do_compression=compressed)
    np.testing.assert_array_equal(read_matlab(tmp_path / "a.mat", "N", 60), values)


def test_what_is_no_array_of_numbers_is_refused(tmp_path):
    path = tmp_path / "a.mat"
    for value, said in (
        ("text", "no real numbers"),
        ({"a": 1}, "no real numbers"),
        (np.array([[1j]]), "no real numbers"),
        (np.ones((3, 4, 6)), "71 values at most"),
    ):
        savemat(path, {"N": value})
        with pytest.raises(FileError, match=said):
            read_matlab(path, "N", 71)
    with pytest.raises(FileError, match="holds no MATLAB array M"):
        read_matlab(path, "M", 72)
    for start in (b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM", bytes(128)):
        path.write_bytes(start + bytes(400))
        with pytest.raises(FileError, match="save it with -v7"):
            read_matlab(path, "N", 72)


def test_cells_in_cells_without_end_are_passed_over(tmp_path):
    """A million cells, each in the one before, end an interpreter that looks into them."""

    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)

    start = element(6, struct.pack("<II", 1, 0)) + element(5, struct.pack("<ii", 1, 1))
    depth, inner = 1_000_000, start + element(1, b"")
    deep = b"".join(
        struct.pack("<II", 14, (depth - n) * (8 + len(inner))) + inner for n in range(depth)
    )
    cell = start + element(1, b"N") + deep
    savemat(tmp_path / "b.mat", {"M": np.eye(3)})
    header, rest = (tmp_path / "b.mat").read_bytes()[:128], (tmp_path / "b.mat").read_bytes()[128:]
    (tmp_path / "a.mat").write_bytes(header + struct.pack("<II", 14, len(cell)) + cell + rest)
    with pytest.raises(FileError, match="no real numbers"):
        read_matlab(tmp_path / "a.mat", "N", 9)
    np.testing.assert_array_equal(read_matlab(tmp_path / "a.mat", "M", 9), np.eye(3))


def test_broken_bytes_raise_file_errors_only(tmp_path, rng):
    path = tmp_path / "a.mat"
    savemat(path, {"N": rng.random((3, 4, 3))})
    whole = path.read_bytes()
    refused = 0
    for _ in range(500):
        broken = bytearray(whole)
        for place in rng.integers(124, 200, size=3):
            broken[place] = rng.integers(256)
        path.write_bytes(broken[: rng.integers(1, 2 * len(whole))])
        try:
            read_matlab(path, "N", 36)
        except FileError:
            refused += 1
    assert 250 < refused < 500
