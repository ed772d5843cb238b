import struct

import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_lights

DIRECTIONS = np.array(
    [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [-0.6, 0.0, 0.8], [0, 0.8, 0.6]]
)
TEXT = "\n".join(" ".join(str(x) for x in row) for row in DIRECTIONS)


def read(tmp_path, text, count=5):
    (tmp_path / "lights.txt").write_text(text)
    return read_lights(tmp_path / "lights.txt", count)


@pytest.mark.parametrize(
    "text",
    [
        TEXT,
        f"5\n{TEXT}\n",
        f"\ufeff# x y z\n\n{TEXT}  % the last\n\n",
        TEXT.replace(" ", ", "),
        "\n".join("\t".join(str(x) for x in row) for row in DIRECTIONS.T),
    ],
    ids=["plain", "counted", "commented", "commas", "transposed"],
)
def test_directions_are_read_however_they_are_laid_out(tmp_path, text):
    found = read(tmp_path, text)
    assert np.allclose(found.directions, DIRECTIONS, rtol=0, atol=1e-15)
    assert found.intensities is None
    assert found.notes == ()


def test_a_fourth_number_is_the_intensity(tmp_path):
    table = np.column_stack([DIRECTIONS, [1, 2, 3, 4, 5]])
    found = read(tmp_path, "\n".join(" ".join(map(str, row)) for row in table))
    assert np.allclose(found.directions, DIRECTIONS)
    assert np.array_equal(found.intensities, [1, 2, 3, 4, 5])


def test_lengths_are_not_used_and_that_is_said(tmp_path):
    found = read(tmp_path, "\n".join(" ".join(map(str, 2.0 * row)) for row in DIRECTIONS))
    assert np.allclose(found.directions, DIRECTIONS)
    assert found.notes == ()
    unequal = DIRECTIONS * np.array([[1], [1], [1.5], [1], [1]])
    found = read(tmp_path, "\n".join(" ".join(map(str, row)) for row in unequal))
    assert np.allclose(found.directions, DIRECTIONS)
    assert "lengths of 1 to 1.5, which are not used" in found.notes[0]


def test_positions_keep_their_lengths_if_asked_for(tmp_path):
    places = DIRECTIONS * np.array([[3.0], [2], [1.5], [4], [2]])
    names = [f"{letter}.png" for letter in "edcba"]
    table = [f"{name} {' '.join(map(str, row))}" for name, row in zip(names, places, strict=True)]
    (tmp_path / "lamps.lp").write_text("5\n" + "\n".join(table))
    found = read_lights(tmp_path / "lamps.lp", 5, sorted(names), positions=True)
    assert np.allclose(found.directions * found.distances[:, None], places[::-1])
    assert found.notes == ()
    (tmp_path / "unit.txt").write_text(TEXT)
    found = read_lights(tmp_path / "unit.txt", 5, positions=True)
    assert "one object's width away" in found.notes[0]
    (tmp_path / "angles.txt").write_text("azimuth elevation\n" + "10 20\n" * 5)
    with pytest.raises(FileError, match="holds angles, but positions"):
        read_lights(tmp_path / "angles.txt", 5, positions=True)


# Three lights 30 degrees from the axis, as in a classical set.
THREE = np.array([[0.5, 0, 0.866], [-0.25, 0.433, 0.866], [-0.25, -0.433, 0.866]])


def as_text(table, separator=" "):
    return "\n".join(separator.join(f"{x:g}" for x in row) for row in table)


def assert_same(found, expected):
    """Two decimals of a number are off by 0.005, and three numbers by 0.0087."""
    unit = expected / np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(found.directions, unit, atol=0.01)


def test_three_or_four_lights_are_told_from_their_transpose_by_unit_norms(tmp_path):
    assert_same(read(tmp_path, as_text(THREE), 3), THREE)
    turned = read(tmp_path, as_text(THREE.T), 3)
    assert_same(turned, THREE)
    assert turned.notes == ("lights.txt: a column is taken for each image",)
    four = np.column_stack([DIRECTIONS[:4], [2, 1, 3, 4]])
    for table in (four, four.T):
        found = read(tmp_path, as_text(table), 4)
        assert_same(found, DIRECTIONS[:4])
        np.testing.assert_array_equal(found.intensities, [2, 1, 3, 4])
    assert_same(read(tmp_path, as_text(DIRECTIONS[:4].T), 4), DIRECTIONS[:4])


def test_lights_at_right_angles_are_told_from_their_transpose_by_being_in_front(tmp_path):
    axes = np.array([[0.8165, 0, 0.5774], [-0.4082, 0.7071, 0.5774], [-0.4082, -0.7071, 0.5774]])
    for table in (axes, axes.T):
        assert_same(read(tmp_path, as_text(table), 3), axes)


@pytest.mark.parametrize("start", [0, 1])
def test_running_numbers_are_told_from_intensities(tmp_path, start):
    for lights in (THREE, DIRECTIONS):
        count = len(lights)
        numbered = np.column_stack([np.arange(count) + start, lights])
        found = read(tmp_path, as_text(numbered), count)
        assert_same(found, lights)
        assert found.intensities is None
        assert found.notes == ("lights.txt: its first numbers are taken as running numbers",)
        assert_same(read(tmp_path, as_text(numbered[::-1]), count), lights)


def test_decimal_commas_and_semicolons_are_read(tmp_path):
    with_commas = as_text(DIRECTIONS).replace(".", ",")
    for text in (
        with_commas,
        with_commas.replace(" ", ";"),
        with_commas.replace(" ", "; "),
        with_commas.replace(" ", "\t"),
        as_text(DIRECTIONS, ";"),
        as_text(DIRECTIONS, ","),
        as_text(DIRECTIONS, " , "),
    ):
        assert_same(read(tmp_path, text), DIRECTIONS)
    whole = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [0, 0, 2]])
    assert_same(read(tmp_path, as_text(whole, ",")), whole)


def test_names_of_photographs_say_which_light_is_whose(tmp_path):
    names = [f"img {n}.png" for n in range(5)]
    rows = [f"photos\\img {n}.jpg {' '.join(map(str, DIRECTIONS[n]))}" for n in (3, 1, 0, 4, 2)]
    text = "5\n" + "\n".join(rows)
    (tmp_path / "a.lp").write_text(text)
    np.testing.assert_allclose(read_lights(tmp_path / "a.lp", 5, names).directions, DIRECTIONS)
    with pytest.raises(FileError, match=r"does not name the photograph other.png"):
        read_lights(tmp_path / "a.lp", 5, ["other.png", *names[1:]])
    (tmp_path / "a.lp").write_text(text.replace("img 4", "img 1"))
    with pytest.raises(FileError, match="names a photograph twice"):
        read_lights(tmp_path / "a.lp", 5, names)


def test_names_of_columns_say_what_is_what(tmp_path):
    text = as_text(np.column_stack([[1, 2, 3], THREE[:, ::-1]]), ",")
    found = read(tmp_path, f"Intensity,z,y,x\n{text}", 3)
    assert_same(found, THREE)
    np.testing.assert_array_equal(found.intensities, [1, 2, 3])
    found = read(tmp_path, "azimuth elevation\n90 0\n0 90\n0 0\n-30 0\n0 -30")
    half, root = 0.5, np.sqrt(0.75)
    expected = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-half, 0, root], [0, -half, root]]
    np.testing.assert_allclose(found.directions, expected, atol=1e-15)
    for header, message in (
        ("azimuth elevation", "elevation lies in"),
        ("theta phi", "names the columns theta phi"),
    ):
        with pytest.raises(FileError, match=message):
            read(tmp_path, f"{header}\n10 100\n" + "1 2\n" * 4)


def test_arrays_are_read(tmp_path):
    for array in (DIRECTIONS, DIRECTIONS.astype(np.float32), np.asfortranarray(DIRECTIONS)):
        np.save(tmp_path / "lights.npy", array)
        assert_same(read_lights(tmp_path / "lights.npy", 5), DIRECTIONS)
    whole = (tmp_path / "lights.npy").read_bytes()
    for data, message in (
        (whole.replace(b"(5, 3)", b"(9, 3)"), "does not hold the array"),
        (whole[:6] + b"\1\0" + struct.pack("<H", 9999) + b"[" * 9999, "no array"),
        (whole.replace(b"<f8", b"|O8"), "no array"),
        (whole[:6], "no array"),
    ):
        (tmp_path / "lights.npy").write_bytes(data)
        with pytest.raises(FileError, match=message):
            read_lights(tmp_path / "lights.npy", 5)


def test_directions_of_any_length_keep_their_direction(tmp_path):
    for length in ("1e200", "1e-200", "1e-310"):
        found = read(tmp_path, "\n".join([f"{length} {length} {length}"] * 5))
        np.testing.assert_allclose(found.directions, np.full((5, 3), 3**-0.5), rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("10 0 20\n-10 5 20\n3 10 20", 3),
        ("1 10 0 20\n2 -10 5 20\n3 3 10 20\n4 0 0 20", 4),
        ("1 10 0 20\n2 -10 5 20\n3 3 10 20\n4 0 0 20\n5 1 1 20", 5),
        ("0.8 0.6 0\n-0.6 0.8 0\n0 0 1", 3),
    ],
    ids=["3 x 3", "4 x 4", "N x 4", "unit both ways"],
)
def test_what_can_be_understood_in_several_ways_is_refused(tmp_path, text, count):
    with pytest.raises(FileError, match=r"can be understood in \d ways"):
        read(tmp_path, text, count)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 0 0 1 0 0\n" * 5, "5 lines of 6 numbers"),
        ("10 80\n" * 5, "angles need the line azimuth elevation"),
        (f"6\n{TEXT}", "promises 6 lines, 5 follow"),
        (f"five\n{TEXT}", "promises five lines"),
        (f"{TEXT}\n0 0 1", "holds 6 lines of 3 numbers, but 5 images"),
        ("1 0\n" * 5, "5 lines of 2 numbers"),
        ("1 0 1\n" * 4 + "1 0", "not a table of numbers"),
        ("nan 0 1\n" * 5, "not a table of numbers"),
        ("left\n" * 5, "promises left lines|not a table"),
        ("# nothing", "holds 1 lines of 0 numbers"),
        ("0 0 1\n" * 4 + "0 0 0", "length zero"),
        ("0 0 -1\n0 0.1 -1\n" * 2 + "1 0 0", "every light behind the object"),
        ("0 0 1 1\n" * 4 + "0 0 1 0", "not positive"),
    ],
)
def test_nonsense_is_refused_with_the_file(tmp_path, text, message):
    with pytest.raises(FileError, match=message) as error:
        read(tmp_path, text)
    assert str(error.value).startswith(str(tmp_path / "lights.txt"))


def test_a_few_lights_from_behind_are_believed(tmp_path):
    assert len(read(tmp_path, "0 0 1\n" * 3 + "0 1 -1\n" * 2).directions) == 5


def test_broken_bytes_raise_file_errors_only(tmp_path, rng):
    whole = TEXT.encode()
    refused = 0
    for _ in range(200):
        broken = bytearray(whole)
        for position in rng.integers(len(whole), size=3):
            broken[position] = rng.integers(256)
        (tmp_path / "lights.txt").write_bytes(broken[: rng.integers(1, len(whole) + 1)])
        try:
            found = read_lights(tmp_path / "lights.txt", 5)
        except FileError:
            refused += 1
        else:
            assert np.allclose(np.linalg.norm(found.directions, axis=1), 1)
    assert refused > 100


def test_only_numbers_that_run_are_running_numbers(tmp_path):
    """Here y z and the intensity are of unit length, too, but the first numbers do not run."""
    (tmp_path / "a.txt").write_text(".6 0 .8 .6\n.28 0 .96 .28\n")
    found = read_lights(tmp_path / "a.txt", 2)
    np.testing.assert_allclose(found.directions, [[0.6, 0, 0.8], [0.28, 0, 0.96]])
    np.testing.assert_allclose(found.intensities, [0.6, 0.28])
