import warnings

import numpy as np
import pytest
from PIL import Image

from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io import choose_gallery, find_photographs, read_photographs
from harmface.io.photo_sets import yale_light

PATTERN = np.arange(24, dtype=np.uint8).reshape(4, 6) * 9


def photograph(path, size=None):
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = Image.fromarray(PATTERN)
    (picture if size is None else picture.resize(size[::-1])).save(path)
    return path


def names(found, folder):
    return [photograph.path.relative_to(folder).as_posix() for photograph in found]


def test_what_systems_leave_behind_is_passed_over(tmp_path):
    for name in ("anna/1.png", "bert/1.png"):
        photograph(tmp_path / name)
    for stray in (
        "__MACOSX/anna/1.png",
        "anna/._1.png",
        ".trash/cleo/1.png",
        "anna/.hidden.png",
        "anna/.cache/1.png",
    ):
        photograph(tmp_path / stray)
    (tmp_path / "anna" / "Thumbs.db").write_bytes(b"stray")
    assert names(find_photographs(tmp_path), tmp_path) == ["anna/1.png", "bert/1.png"]


def test_photographs_of_every_format_are_found(tmp_path):
    for number, suffix in enumerate(("png", "jpg", "tga", "ppm", "webp", "bmp", "tif", "JPG")):
        photograph(tmp_path / "anna" / f"{number}.{suffix}")
        photograph(tmp_path / "bert" / f"{number}.{suffix}")
    found = find_photographs(tmp_path)
    assert len(found) == 16
    assert len(read_photographs(found)[1]) == 16


def test_links_to_folders_are_followed_and_never_in_a_circle(tmp_path):
    for name in ("anna", "bert"):
        photograph(tmp_path / "archive" / name / "1.png")
        (tmp_path / "people").mkdir(exist_ok=True)
        (tmp_path / "people" / name).symlink_to(tmp_path / "archive" / name)
    (tmp_path / "archive" / "anna" / "again").symlink_to(tmp_path / "people")
    folder = tmp_path / "people"
    found = find_photographs(folder)
    assert names(found, folder) == ["anna/1.png", "bert/1.png"]
    assert [photograph.subject for photograph in found] == ["anna", "bert"]


@pytest.mark.parametrize("sessions", [False, True])
def test_two_folders_of_one_of_yale_are_refused(tmp_path, sessions):
    for folder in ("one/yaleB01", "two/yaleB01", "one/yaleB02"):
        photograph(tmp_path / folder / f"{folder[4:]}_P00A+000E+00.png")
    with pytest.raises(FileError, match=r"second folder of subject 'yaleB01'"):
        find_photographs(tmp_path, sessions=sessions)


def test_one_subject_or_none_is_no_set(tmp_path):
    for name in ("anna/1.png", "anna/2.png", "loose.png"):
        photograph(tmp_path / name)
    with pytest.raises(FileError, match="holds photographs of fewer than two subjects"):
        find_photographs(tmp_path)


def test_photographs_may_be_unlabelled_where_that_is_asked_for(tmp_path):
    with pytest.raises(FileError, match="holds no photographs"):
        find_photographs(tmp_path, unlabelled=True)
    for name in ("anna/1.png", "loose.png"):
        photograph(tmp_path / name)
    found = find_photographs(tmp_path, unlabelled=True)
    assert [(each.path.name, each.subject) for each in found] == [
        ("1.png", "anna"),
        ("loose.png", ""),
    ]


def test_a_set_of_which_nothing_can_be_read_is_refused(tmp_path):
    for name in ("anna", "bert"):
        photograph(tmp_path / name / "1.png").write_bytes(b"no picture")
    bad = []
    with pytest.raises(ArgumentError, match="at least one that can be read"):
        read_photographs(find_photographs(tmp_path), bad=bad.append)
    assert len(bad) == 2


def test_other_names_tell_no_light():
    assert yale_light("anna.png") is yale_light("yaleB01_P00A+000E+00.txt") is None


def test_sessions_of_a_person_are_asked_for(tmp_path):
    for name in ("anna/day1/1.png", "anna/day2/1.png", "bert/day1/1.png", "bert/1.png"):
        photograph(tmp_path / name)
    with pytest.raises(FileError, match=r"second folder of subject 'day1'.*--sessions"):
        find_photographs(tmp_path)
    found = find_photographs(tmp_path, sessions=True)
    assert [photograph.subject for photograph in found] == ["anna", "anna", "bert", "bert"]


def test_other_poses_of_the_yale_database_are_left_out_with_a_word(tmp_path):
    for person in ("yaleB01", "yaleB02"):
        for pose in ("00", "05"):
            photograph(tmp_path / person / f"{person}_P{pose}A+000E+00.pgm")
    with pytest.warns(FileWarning, match="2 photographs of other poses than P00 are left out"):
        found = find_photographs(tmp_path)
    assert all("_P00" in photograph.path.name for photograph in found)
    for path in tmp_path.rglob("*_P00*"):
        path.unlink()
    assert len(find_photographs(tmp_path)) == 2
    photograph(tmp_path / "yaleB01" / "yaleB01_P07A+000E+00.pgm")
    with pytest.raises(FileError, match="the poses P05, P07 but not P00"):
        find_photographs(tmp_path)


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp"])
def test_names_of_the_yale_database_may_end_otherwise(tmp_path, suffix):
    for person in ("yaleB01", "yaleB02"):
        photograph(tmp_path / person / f"{person}_P00A+000E+90.{suffix}")
    assert find_photographs(tmp_path)[0].light == pytest.approx((0, 1, 0), abs=1e-15)


def test_photographs_are_cut_with_a_word_and_never_stretched(tmp_path):
    for name, size in (("anna/1", (192, 168)), ("bert/1", (96, 84))):
        photograph(tmp_path / f"{name}.png", size)
    found = find_photographs(tmp_path)
    kept, images = read_photographs(found, size=(48, 42))
    assert images.shape == (2, 48, 42)
    with pytest.warns(FileWarning, match="192 x 168 pixels, of which the middle .* 24 x 42"):
        cut = read_photographs(found, size=(24, 42))[1]
    # Both are multiples of 48 x 42, of which the middle 24 rows remain.
    np.testing.assert_allclose(cut, images[:, 12:36], atol=1e-6)
    photograph(tmp_path / "cleo/1.png", (192, 192))
    found = find_photographs(tmp_path)
    with pytest.raises(FileError, match=r"cleo.1.png: has 192 x 192 pixels, another ratio"):
        read_photographs(found, size=(48, 42))
    skipped = []
    kept, _ = read_photographs(found, size=(48, 42), bad=skipped.append)
    assert len(kept) == 2 and len(skipped) == 1


def test_a_list_names_photographs_with_or_without_their_folders(tmp_path, monkeypatch):
    for person in ("yaleB01", "yaleB02"):
        for light in ("A+000E+00", "A+035E+40"):
            photograph(tmp_path / "set" / person / f"{person}_P00{light}.pgm")
    found = find_photographs(tmp_path / "set")
    wanted = [True, False, True, False]
    listed = tmp_path / "gallery.txt"
    for first in (
        "yaleB01_P00A+000E+00.pgm",
        "yaleB01/yaleB01_P00A+000E+00.pgm",
        "./set/yaleB01/yaleB01_P00A+000E+00.pgm",
        "set\\yaleB01\\yaleB01_P00A+000E+00.pgm",
        str(found[0].path),
    ):
        listed.write_text(f"\ufeff{first}\r\nyaleB02/yaleB02_P00A+000E+00.pgm\r\n")
        np.testing.assert_array_equal(choose_gallery(found, str(listed)), wanted)
    monkeypatch.chdir(tmp_path)
    listed.write_text(f"{found[0].path}\n{found[2].path}\n")
    relative = find_photographs("set")
    np.testing.assert_array_equal(choose_gallery(relative, str(listed)), wanted)
    listed.write_text("yaleB02/yaleB01_P00A+000E+00.pgm\n")
    with pytest.raises(FileError, match="not among the photographs"):
        choose_gallery(found, str(listed))


def test_photographs_are_turned_as_their_file_says(tmp_path):
    exif = Image.Exif()
    exif[0x112] = 3
    for name in ("anna", "bert"):
        (tmp_path / name).mkdir()
        Image.fromarray(PATTERN).save(tmp_path / name / "1.png", exif=exif)
    _, images = read_photographs(find_photographs(tmp_path))
    np.testing.assert_allclose(images[0] * 255, np.rot90(PATTERN, 2), rtol=1e-6)


def test_a_set_too_large_for_memory_is_refused(tmp_path):
    for number in range(17):
        photograph(tmp_path / f"{number}" / "1.png")
    found = find_photographs(tmp_path)
    with pytest.raises(FileError, match="more than 16 times 24 together"):
        read_photographs(found, max_pixels=24)
    # What counts is what is kept.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(read_photographs(found, max_pixels=24, size=(2, 3))[1]) == 17
