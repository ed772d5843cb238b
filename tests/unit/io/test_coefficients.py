import numpy as np
import pytest

from harmface.errors import FileError
from harmface.io import read_coefficients, write_coefficients


def test_what_is_written_is_read(tmp_path, rng):
    coefficients = rng.standard_normal((3, 16))
    write_coefficients(tmp_path / "c.json", coefficients)
    assert np.array_equal(read_coefficients(tmp_path / "c.json"), coefficients)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[1",
        "[]",
        "{}",
        "null",
        '{"coefficients": 1}',
        '{"coefficients": [1, 2, 3, 4]}',
        '{"coefficients": [[1, 2, 3]]}',
        '{"coefficients": [[[1], [2], [3], [4]]]}',
        '{"coefficients": [[1, 2], [3]]}',
        '{"coefficients": [["a"]]}',
        '{"coefficients": [[NaN]]}',
        '{"coefficients": {"a": 1}}',
        '{"coefficients": [[1' + "0" * 400 + "]]}",
        '{"coefficients": [[1' + "0" * 5000 + "]]}",
        '{"coefficients": ' + "[" * 100_000,
        '{"coefficients": [["' + "x" * 5000 + '"]]}',
    ],
    ids=len,
)
def test_anything_else_is_refused(tmp_path, text):
    (tmp_path / "c.json").write_text(text)
    with pytest.raises(FileError, match=r"c\.json") as error:
        read_coefficients(tmp_path / "c.json")
    assert len(str(error.value)) < 400 + len(str(tmp_path))


def test_tens_of_megabytes_are_not_parsed(tmp_path):
    (tmp_path / "c.json").write_text("[" + "[]," * 10_000_000 + "[]]")
    with pytest.raises(FileError, match="more than the limit of 16777216"):
        read_coefficients(tmp_path / "c.json")
