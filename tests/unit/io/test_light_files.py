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


@pytest.mark.parametrize(
    ("text", "message"),
    [
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
