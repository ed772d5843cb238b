from dataclasses import replace

import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError
from harmface.recognition import score_block
from harmface.scale import recognition, recognize


def test_the_answers_are_those_of_the_gallery_in_memory(stores, at, monkeypatch):
    gallery, probes = stores
    whole = score_block(gallery.read(0, 70), probes.read(0, 30), 4)
    # A cluster's processes have the constants as they are, but are sent blocks as they are cut.
    monkeypatch.setattr(recognition, "BLOCK_BYTES", 1)
    monkeypatch.setattr(recognition, "PROBES", 7)
    found = list(recognize(gallery, probes, 4, at))
    assert [len(each.subjects) for each in found] == [7, 7, 7, 7, 2]
    for name in ("subjects", "distances"):
        parts = np.concatenate([getattr(each, name) for each in found])
        assert parts.tobytes() == getattr(whole, name).tobytes()
    assert np.array_equal(whole.subjects[:, 0], 2 * np.arange(30))


def test_a_flipped_byte_is_named(stores, at):
    gallery, probes = stores
    chunk = gallery.path / "images" / "c" / "7" / "0" / "0"
    data = bytearray(chunk.read_bytes())
    data[100] ^= 1
    chunk.write_bytes(data)
    with pytest.raises(FileError, match=r"big\.zarr: is damaged among its images 0 to 69"):
        list(recognize(gallery, probes, 4, at))


def test_stores_of_other_pixels_are_refused(stores):
    gallery, _ = stores
    other = replace(gallery, mask=~gallery.mask)
    with pytest.raises(ArgumentError, match="of other pixels"):
        next(recognize(gallery, other))
