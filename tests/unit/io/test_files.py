import errno
import os
from pathlib import Path

import pytest

from harmface.errors import FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes


def test_an_interrupted_write_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt), atomic_write(path) as file:
        file.write(b"half")
        raise KeyboardInterrupt
    assert [p.read_bytes() for p in tmp_path.iterdir()] == [b"old"]


def test_a_full_disk_is_one_clear_error_and_leaves_nothing(tmp_path):
    with pytest.raises(FileError, match="No space left"), atomic_write(tmp_path / "a"):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(FileError, match="cannot be written"), atomic_write(tmp_path / "no" / "a"):
        pass


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "does not exist"),
        (lambda path: path.mkdir(), "is a folder"),
        (lambda path: path.write_bytes(b""), "is empty"),
        (lambda path: os.mkfifo(path), "is a pipe or a device"),
        (lambda path: path.symlink_to("/dev/zero"), "is a pipe or a device"),
        (lambda path: path.symlink_to(path), "symbolic links"),
    ],
)
def test_files_that_cannot_be_read_are_named(tmp_path, make, message):
    make(tmp_path / "x")
    with pytest.raises(FileError, match=message):
        read_bytes(tmp_path / "x")


def test_a_huge_file_is_not_taken_into_memory(tmp_path):
    path = tmp_path / "sparse"
    with path.open("wb") as file:
        file.truncate(2**33)
    with pytest.raises(FileError, match="more than the limit"):
        read_bytes(path)


@pytest.mark.parametrize(
    ("name", "said"), [("a\0b", "no name that a file can have"), ("a" * 5000, "cannot be read")]
)
def test_names_that_no_file_can_have_are_refused(name, said):
    with pytest.raises(FileError, match=said):
        read_bytes(Path(name))


def test_a_text_longer_than_its_limit_is_not_read(tmp_path):
    (tmp_path / "a").write_bytes(b"12345")
    assert read_bytes(tmp_path / "a", 5) == b"12345"
    with pytest.raises(FileError, match="more than the limit of 4"):
        read_bytes(tmp_path / "a", 4)
