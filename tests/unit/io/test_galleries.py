import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_gallery, write_gallery, write_npz
from harmface.recognition import Gallery

GALLERY = Gallery(("ann", "bob"), np.random.default_rng(0).random((2, 9, 4, 4)))


def test_what_is_written_is_read(tmp_path):
    write_gallery(tmp_path / "g.npz", GALLERY)
    found = read_gallery(tmp_path / "g.npz")
    assert found.subjects == GALLERY.subjects
    assert np.array_equal(found.images, GALLERY.images)


@pytest.mark.parametrize(
    ("version", "arrays", "attributes", "message"),
    [
        (2, {"images": GALLERY.images}, {"subjects": ["a", "b"]}, "version 1 is needed"),
        (1, {}, {"subjects": ["a", "b"]}, "gallery without"),
        (1, {"images": GALLERY.images}, {}, "gallery without"),
        (1, {"images": GALLERY.images}, {"subjects": ["a", "a"]}, "distinct"),
        (1, {"images": GALLERY.images[0]}, {"subjects": ["a"]}, "enroll again"),
        (1, {"images": np.array([["x"]])}, {"subjects": ["a"]}, "enroll again"),
    ],
)
def test_what_is_not_such_a_gallery_is_refused(tmp_path, version, arrays, attributes, message):
    write_npz(tmp_path / "g.npz", "gallery", version, arrays, attributes)
    with pytest.raises(FileError, match=message):
        read_gallery(tmp_path / "g.npz")
