import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError
from harmface.scale import first_pass, recognition, recognize


def together(rankings):
    rankings = list(rankings)
    return [np.concatenate([getattr(e, n) for e in rankings]) for n in ("subjects", "distances")]


def test_a_first_pass_that_leaves_all_directions_misses_nobody(stores, at, monkeypatch):
    monkeypatch.setattr(recognition, "PROBES", 7)
    monkeypatch.setattr(recognition, "LISTED", 2)
    monkeypatch.setattr(recognition, "BLOCK_BYTES", 2**14)
    whole = together(recognize(*stores, 4, at))
    found = together(recognize(*stores, 4, at, first_pass=10))
    assert [each.tobytes() for each in found] == [each.tobytes() for each in whole]
    # It is made once; the second time it is only read.
    small = first_pass.reduced(stores[0])
    stamps = {path: path.stat().st_mtime_ns for path in (small.path / "images" / "c").iterdir()}
    again = together(recognize(*stores, 4, at, first_pass=10))
    assert again[0].tobytes() == whole[0].tobytes()
    assert stamps == {path: path.stat().st_mtime_ns for path in stamps}


def test_fewer_directions_leave_who_is_much_nearer(stores, monkeypatch):
    monkeypatch.setattr(first_pass, "DIMENSION", 40)
    subjects, distances = together(recognize(*stores, 2, first_pass=10))
    assert np.array_equal(subjects[:, 0], 2 * np.arange(30))
    whole = together(recognize(*stores, 2))
    # What is left is compared in full.
    assert np.array_equal(distances[:, 0], whole[1][:, 0])
    assert first_pass.reduced(stores[0]).shape == (70, 3, 40)


def test_the_directions_keep_most_of_the_subspaces(stores, monkeypatch):
    monkeypatch.setattr(first_pass, "DIMENSION", 5)
    found = first_pass.directions_of(first_pass.reduced(stores[0]).path)
    assert np.allclose(found @ found.T, np.eye(5), atol=1e-6)
    rows = stores[0].read(0, 70).reshape(-1, 64)
    best = np.linalg.svd(rows)[1][:5]
    assert np.isclose(np.linalg.norm(rows @ found.T), np.linalg.norm(best), rtol=1e-5)


def test_too_small_and_damaged_first_passes_are_refused(stores):
    with pytest.raises(ArgumentError, match="at least top, 4, got 3"):
        list(recognize(*stores, 4, first_pass=3))
    small = first_pass.reduced(stores[0])
    file = small.path / first_pass.DIRECTIONS
    data = bytearray(file.read_bytes())
    data[500] ^= 1
    file.write_bytes(data)
    with pytest.raises(FileError, match=r"directions\.npz: is damaged"):
        list(recognize(*stores, 4, first_pass=10))
