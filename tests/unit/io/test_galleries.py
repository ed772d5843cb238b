import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError
from harmface.io import read_gallery, write_gallery, write_npz
from harmface.io.galleries import Enrolled, LabelledPhotographs, enrolled_photographs
from harmface.recognition import Gallery

RNG = np.random.default_rng(0)
GALLERY = Gallery(("bob", "ann"), RNG.random((2, 9, 4, 5)))
TRIALS = LabelledPhotographs(("ann", "bob", "ann"), RNG.random((3, 4, 5)))
HARMONIC = Enrolled(GALLERY, "9d", TRIALS, GALLERY.mask, True, {"cast_shadows": False})
MASK = np.arange(20).reshape(4, 5) > 2
PHOTOGRAPHS = enrolled_photographs(TRIALS, "local", mask=MASK, aligned=True, facts={"srgb": True})


@pytest.mark.parametrize("enrolled", [HARMONIC, PHOTOGRAPHS], ids=["harmonic", "photographs"])
def test_what_is_written_is_read(tmp_path, enrolled):
    write_gallery(tmp_path / "g.npz", enrolled)
    found = read_gallery(tmp_path / "g.npz")
    assert found.content == enrolled.content
    assert found.gallery.subjects == enrolled.gallery.subjects
    assert np.array_equal(found.gallery.images, enrolled.gallery.images)
    assert np.array_equal(found.trials.images, TRIALS.images)
    assert found.trials.subjects == TRIALS.subjects
    assert np.array_equal(found.mask, enrolled.mask)
    assert (found.method, found.aligned, found.facts) == (
        enrolled.method,
        enrolled.aligned,
        enrolled.facts,
    )


def test_a_gallery_needs_no_trials(tmp_path):
    write_gallery(tmp_path / "g.npz", Enrolled(GALLERY, "9d", None, GALLERY.mask, False))
    found = read_gallery(tmp_path / "g.npz")
    assert found.trials is None
    assert found.some_trials(5) is None


def test_all_pixels_are_compared_and_framing_is_free_unless_told():
    enrolled = enrolled_photographs(TRIALS, "local")
    assert enrolled.mask.all()
    assert not enrolled.aligned


def test_names_are_sorted_and_trials_point_at_them():
    assert HARMONIC.names == ("ann", "bob")
    images, which = HARMONIC.some_trials(10)
    assert which.tolist() == [0, 1, 0]
    images, which = HARMONIC.some_trials(2)
    assert np.array_equal(images, TRIALS.images[[0, 2]])
    assert which.tolist() == [0, 0]


def test_a_summary_counts_and_names_whom_there_are_fewest_of():
    assert HARMONIC.summary == "2 subjects at 4 x 5 pixels"
    assert PHOTOGRAPHS.summary == "2 subjects, 3 photographs (fewest 1, of bob) at 4 x 5 pixels"
    one = enrolled_photographs(LabelledPhotographs(("ann",), TRIALS.images[:1]), "local")
    assert one.summary == "1 subject, 1 photograph at 4 x 5 pixels"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LabelledPhotographs(("ann",), TRIALS.images), "name each photograph"),
        (lambda: LabelledPhotographs((), TRIALS.images[:0]), "name each photograph"),
        (lambda: LabelledPhotographs(("a", "b", "c"), TRIALS.images - 1), "negative"),
        (lambda: LabelledPhotographs(("a",), TRIALS.images[0]), "name each photograph"),
        (lambda: LabelledPhotographs(("a",), np.ones((1, 2, 2))), "number 0 has one value"),
        (lambda: Enrolled(GALLERY, "9d", TRIALS, MASK[:3], True), "of one size"),
        (lambda: Enrolled(GALLERY, "9d", TRIALS, MASK & False, True), "leave some pixels"),
        (
            lambda: Enrolled(
                GALLERY, "9d", LabelledPhotographs(("eve",), TRIALS.images[:1]), MASK, True
            ),
            "subjects of the gallery",
        ),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


ARRAYS = {"images": GALLERY.images, "mask": MASK}
ATTRIBUTES = {
    "content": "harmonic images",
    "method": "9d",
    "subjects": ["a", "b"],
    "aligned": True,
    "facts": {},
}


@pytest.mark.parametrize(
    ("version", "arrays", "attributes", "message"),
    [
        (1, {}, {}, "version 2 is needed"),
        (2, {"images": None}, {}, "gallery without 'images'"),
        (2, {"mask": None}, {}, "gallery without 'mask'"),
        (2, {}, {"subjects": None}, "gallery without 'subjects'"),
        (2, {}, {"subjects": ["a", "a"]}, "distinct"),
        (2, {}, {"subjects": 3}, "enroll again"),
        (2, {}, {"content": "voices"}, "content is 'voices'"),
        (2, {}, {"content": "photographs"}, "enroll again"),
        (2, {}, {"method": ["9d"]}, "method must be a name"),
        (2, {}, {"facts": "none"}, "facts a table"),
        (2, {"images": GALLERY.images[0]}, {}, "enroll again"),
        (2, {"images": np.array([["x"]])}, {}, "real numbers"),
        (2, {"mask": MASK.astype(int)}, {}, "true and false"),
        (2, {"mask": MASK[None]}, {}, "true and false"),
        (2, {"trials": TRIALS.images}, {}, "gallery without 'trials'"),
        (2, {"trials": TRIALS.images}, {"trials": ["a"]}, "name each photograph"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_what_is_not_such_a_gallery_is_refused(tmp_path, version, arrays, attributes, message):
    arrays = {name: each for name, each in (ARRAYS | arrays).items() if each is not None}
    attributes = {k: each for k, each in (ATTRIBUTES | attributes).items() if each is not None}
    write_npz(tmp_path / "g.npz", "gallery", version, arrays, attributes)
    with pytest.raises(FileError, match=message):
        read_gallery(tmp_path / "g.npz")
