import numpy as np
import pytest

from data_synth.shapes import ellipsoid, sphere, superquadric
from harmface.errors import ArgumentError
from harmface.recognition import Gallery, enroll
from harmface.reproduce.synthetic import mesh_of

MESHES = {"ball": mesh_of(sphere()), "egg": mesh_of(ellipsoid()), "box": mesh_of(superquadric())}
GALLERY = enroll(MESHES, 32)


def test_enrolment_keeps_names_and_nine_images_each():
    assert GALLERY.subjects == ("ball", "egg", "box")
    assert GALLERY.images.shape == (3, 9, 32, 32)
    assert GALLERY.images.dtype == np.float32


def test_only_pixels_of_every_subject_are_compared():
    each = GALLERY.images[:, 0] > 0
    assert np.array_equal(GALLERY.mask, each[0] & each[1] & each[2])
    assert GALLERY.mask.sum() < each.sum(axis=(1, 2)).max()


@pytest.mark.parametrize(("method", "first", "last"), [("3d", 1, 4), ("4d", 0, 4), ("9d", 0, 9)])
def test_methods_take_their_harmonics(method, first, last):
    spanning = GALLERY.spanning(method)
    assert np.array_equal(spanning, GALLERY.images[:, first:last, GALLERY.mask])


IMAGES = np.ones((2, 9, 4, 4))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Gallery(("a",), IMAGES), "name each"),
        (lambda: Gallery((), IMAGES[:0]), "name each"),
        (lambda: Gallery(("a", "a"), IMAGES), "distinct"),
        (lambda: Gallery(("a", "b"), IMAGES[:, :8]), "square"),
        (lambda: Gallery(("a", "b"), IMAGES * np.nan), "finite"),
        (lambda: Gallery(("a", "b"), IMAGES * 0), "share some pixels"),
        (lambda: Gallery(("a", "b"), IMAGES).spanning("5d"), "one of 3d, 4d, 9d"),
        (lambda: Gallery(("a", "b"), IMAGES[:, :4]).spanning("9d"), "higher degree"),
        (lambda: enroll({}, 8), "at least one subject"),
    ],
)
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
