import numpy as np
import pytest

from data_synth.shapes import ellipsoid, sphere, superquadric
from harmface.errors import ArgumentError
from harmface.recognition import Gallery, Photographs, enroll
from harmface.reproduce.synthetic import mesh_of

MESHES = {"ball": mesh_of(sphere()), "egg": mesh_of(ellipsoid()), "box": mesh_of(superquadric())}
GALLERY = enroll(MESHES, 32)


def test_enrolment_keeps_names_harmonic_images_and_nine_photographs_each():
    assert GALLERY.names.tolist() == ["ball", "box", "egg"]
    assert GALLERY.harmonic.shape == (3, 9, 32, 32)
    assert GALLERY.shadowed.shape == (3, 25, 32, 32)
    assert GALLERY.harmonic.dtype == GALLERY.shadowed.dtype == np.float32
    assert np.bincount(GALLERY.which).tolist() == [9, 9, 9]
    # The order of the meshes plays no part: a subject keeps its images.
    alone = enroll({"egg": MESHES["egg"]}, 32, cast_shadows=False)
    assert np.array_equal(alone.harmonic[0], GALLERY.harmonic[2])
    assert np.array_equal(alone.photographs.images, GALLERY.photographs.images[18:])
    assert alone.shadowed is None


def test_only_pixels_of_every_subject_are_compared():
    each = GALLERY.harmonic[:, 0] > 0
    assert np.array_equal(GALLERY.mask, each[0] & each[1] & each[2])
    assert GALLERY.mask.sum() < each.sum(axis=(1, 2)).max()


def test_subjects_are_known_by_their_images():
    photographs = Photographs(np.array(["b", "a", "b"]), np.random.default_rng(0).random((3, 4, 5)))
    relit = Photographs(np.array(["a"]), np.ones((1, 4, 5)))
    gallery = Gallery(photographs, photographs.everywhere, relit=relit)
    a, b = gallery.spanning("photographs")
    assert np.array_equal(a, photographs.images[1:2])
    assert np.array_equal(b, photographs.images[::2])
    a, b = gallery.spanning("relit")
    assert np.array_equal(a, np.concatenate([photographs.images[1:2], relit.images]))
    assert np.array_equal(b, photographs.images[::2])
    degree_one = GALLERY.spanning("shadowed", slice(1, 4))
    assert np.array_equal(np.stack(degree_one), GALLERY.shadowed[:, 1:4])


def test_a_summary_counts_and_names_whom_there_are_fewest_of():
    assert GALLERY.summary == "3 subjects at 32 x 32 pixels"
    photographs = Photographs(np.array(["b", "a", "b"]), np.ones((3, 4, 5)))
    gallery = Gallery(photographs, photographs.everywhere)
    assert gallery.summary == "2 subjects, 3 photographs (fewest 1, of a) at 4 x 5 pixels"
    one = gallery.chosen(gallery.which == 0)
    assert one.summary == "1 subject, 1 photograph at 4 x 5 pixels"


PHOTOGRAPHS = Photographs(np.array(["a", "b"]), np.ones((2, 4, 4)))
ALL = np.ones((4, 4), bool)
IMAGES = np.ones((2, 9, 4, 4))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Photographs(np.array(["a"]), PHOTOGRAPHS.images), "name each photograph"),
        (lambda: Photographs(np.array(["a"]), np.ones((1, 4))), "name each photograph"),
        (lambda: Photographs(np.array(["a"]), np.full((1, 4, 4), np.nan)), "finite"),
        (lambda: Gallery(PHOTOGRAPHS.chosen(ALL[0, :2] & False), ALL), "at least one"),
        (lambda: Gallery(PHOTOGRAPHS, ALL[:3]), "mask must be of shape"),
        (lambda: Gallery(PHOTOGRAPHS, ~ALL), "leave some pixels"),
        (lambda: Gallery(PHOTOGRAPHS, ALL, lights=np.ones((1, 3))), "lights must number 2"),
        (
            lambda: Gallery(
                PHOTOGRAPHS, ALL, relit=Photographs(np.array(["c"]), np.ones((1, 4, 4)))
            ),
            "subjects of the photographs",
        ),
        (
            lambda: Gallery(
                PHOTOGRAPHS, ALL, relit=Photographs(np.array(["a"]), np.ones((1, 4, 5)))
            ),
            "relit must be of shape",
        ),
        (lambda: Gallery(PHOTOGRAPHS, ALL, harmonic=IMAGES[:1]), "harmonic must hold"),
        (lambda: Gallery(PHOTOGRAPHS, ALL, harmonic=IMAGES[:, :8]), "square"),
        (lambda: Gallery(PHOTOGRAPHS, ALL, shadowed=IMAGES * np.nan), "finite"),
        (lambda: Gallery(PHOTOGRAPHS, ALL).spanning("harmonic"), "must hold harmonic images"),
        (lambda: Gallery(PHOTOGRAPHS, ALL).spanning("relit"), "must hold relit photographs"),
        (
            lambda: Gallery(PHOTOGRAPHS, ALL, harmonic=IMAGES).spanning("harmonic", slice(0, 16)),
            "must hold 16 harmonic images",
        ),
        (lambda: enroll({}, 8), "at least one subject"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
