from dataclasses import replace

import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError
from harmface.io import read_gallery, write_gallery, write_npz
from harmface.io.npz import read_npz
from harmface.recognition import (
    METHODS,
    Gallery,
    Photographs,
    SubjectClassifier,
    SubspaceDistance,
)

RNG = np.random.default_rng(0)
PHOTOGRAPHS = Photographs(np.repeat(["bob", "ann"], 6), RNG.random((12, 12, 14)))
MASK = np.arange(168).reshape(12, 14) > 2
PLAIN = Gallery(PHOTOGRAPHS, MASK, aligned=True, facts={"srgb": True})
RELIT = replace(
    PLAIN, lights=RNG.random((12, 3)), relit=Photographs(np.array(["ann"]), RNG.random((1, 12, 14)))
)
HARMONIC = replace(PLAIN, harmonic=RNG.random((2, 9, 12, 14)), shadowed=RNG.random((2, 25, 12, 14)))
PROBES = RNG.random((4, 168))


OTHERS = Photographs(np.repeat(np.arange(4), 3), RNG.random((12, 12, 14)))


# dlib's network is not installed everywhere.
@pytest.mark.parametrize(
    "method", ["best", *sorted({*METHODS} - {"dlib"}), "tan-triggs+nearest", "shadowed+robust"]
)
def test_what_is_written_recognises_as_before(tmp_path, method):
    made = SubjectClassifier.from_gallery(replace(HARMONIC, others=OTHERS), method)
    write_gallery(tmp_path / "g.npz", made)
    found = read_gallery(tmp_path / "g.npz")
    assert found.method == made.method == ("framed+25d" if method == "best" else method)
    assert np.array_equal(found.classes_, ["ann", "bob"])
    assert np.array_equal(found.distances(PROBES), made.distances(PROBES))
    assert np.array_equal(found.predict_proba(PROBES), made.predict_proba(PROBES))


@pytest.mark.parametrize("gallery", [PLAIN, RELIT, HARMONIC], ids=["plain", "relit", "harmonic"])
def test_the_gallery_is_kept(tmp_path, gallery):
    write_gallery(tmp_path / "g.npz", SubjectClassifier.from_gallery(gallery, "nearest"))
    found = read_gallery(tmp_path / "g.npz").gallery_
    assert np.array_equal(found.photographs.subjects, gallery.photographs.subjects)
    for name in ("mask", "lights", "harmonic", "shadowed"):
        ours, theirs = getattr(gallery, name), getattr(found, name)
        assert np.array_equal(ours, theirs) if ours is not None else theirs is None
    assert np.array_equal(found.photographs.images, gallery.photographs.images)
    assert (found.relit is None) == (gallery.relit is None)
    if gallery.relit is not None:
        assert np.array_equal(found.relit.images, gallery.relit.images)
        assert np.array_equal(found.relit.subjects, gallery.relit.subjects)
    assert (found.aligned, found.facts) == (True, {"srgb": True})


def test_few_photographs_need_no_trials(tmp_path):
    few = PLAIN.chosen(np.array([0, 6]))
    write_gallery(tmp_path / "g.npz", SubjectClassifier.from_gallery(few, "nearest"))
    assert read_gallery(tmp_path / "g.npz").held_out_ is None


@pytest.mark.parametrize(
    "made",
    [
        SubjectClassifier.from_gallery(PLAIN, SubspaceDistance(dimension=2)),
        SubjectClassifier("nearest").fit(PROBES, [0, 0, 1, 1]),
    ],
    ids=["a distance", "numbers"],
)
def test_what_has_no_name_is_not_written(tmp_path, made):
    with pytest.raises(ArgumentError, match="method by its name and subjects that are text"):
        write_gallery(tmp_path / "g.npz", made)


@pytest.mark.parametrize(
    ("arrays", "attributes", "message"),
    [
        ({"photographs": None}, {}, "gallery without 'photographs'"),
        ({"mask": None}, {}, "gallery without 'mask'"),
        ({"known": None}, {}, "gallery without 'known'"),
        ({"model.bases": None}, {}, "gallery without 'bases'"),
        ({}, {"subjects": None}, "gallery without 'subjects'"),
        ({}, {"subjects": 3}, "enroll again"),
        ({}, {"subjects": ["a"]}, "name each photograph"),
        ({}, {"method": ["9d"]}, "method must be a name"),
        ({}, {"method": "magic"}, "method must be best"),
        ({}, {"facts": "none"}, "facts a table"),
        ({"photographs": PHOTOGRAPHS.images[0]}, {}, "enroll again"),
        ({"photographs": PHOTOGRAPHS.images - 1}, {}, "negative"),
        ({"photographs": PHOTOGRAPHS.images * 0}, {}, "one value everywhere"),
        ({"photographs": np.array([["x"]])}, {}, "real numbers"),
        ({"mask": MASK.astype(int)}, {}, "true and false"),
        ({"mask": MASK[None]}, {}, "true and false"),
        ({"harmonic": HARMONIC.harmonic[:1]}, {}, "harmonic must hold"),
        ({"model.bases": np.ones((3, 6, 165))}, {}, "of other subjects"),
        ({"model.bases": np.ones((2, 2, 5))}, {}, "must have 5 pixels"),
        ({"model.bases": np.full((2, 2, 77), np.nan)}, {}, "finite"),
        ({"held_out": np.ones((2, 3))}, {}, "held_out are not of its subjects"),
        ({"known.truth": np.full(12, 7)}, {}, "known are not of its subjects"),
        ({"relit": RELIT.relit.images}, {}, "gallery without 'relit'"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_what_is_not_such_a_gallery_is_refused(tmp_path, arrays, attributes, message):
    write_gallery(tmp_path / "g.npz", SubjectClassifier.from_gallery(HARMONIC, "subspace"))
    given, said = read_npz(tmp_path / "g.npz", "gallery", 3)
    arrays = {name: each for name, each in (given | arrays).items() if each is not None}
    attributes = {k: each for k, each in (said | attributes).items() if each is not None}
    write_npz(tmp_path / "g.npz", "gallery", 3, arrays, attributes)
    with pytest.raises(FileError, match=message):
        read_gallery(tmp_path / "g.npz")


def test_another_version_is_refused(tmp_path):
    write_npz(tmp_path / "g.npz", "gallery", 2, {}, {})
    with pytest.raises(FileError, match="version 3 is needed"):
        read_gallery(tmp_path / "g.npz")
