import os
import stat
import subprocess
import sys

import pytest
from matplotlib.figure import Figure

from harmface.errors import FileError
from harmface.io import atomic_write, claim, prepare_folder
from harmface.io.atomic import HIDDEN
from harmface.io.folders import output_folder
from harmface.viz import write_figure

HOLD = """
import sys, time
from pathlib import Path
from harmface.io import atomic_write, claim
with {what}:
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder():
    """Start a process that holds something; it is killed in the end."""
    processes = []

    def start(what):
        process = subprocess.Popen(
            [sys.executable, "-c", HOLD.format(what=what)], stdout=subprocess.PIPE, text=True
        )
        processes.append(process)
        assert process.stdout.readline() == "held\n"
        return process

    yield start
    for process in processes:
        process.kill()
        process.wait()
        process.stdout.close()


def hidden(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(HIDDEN)]


def test_what_a_killed_writer_left_is_no_file_of_others_and_is_removed(tmp_path, holder):
    process = holder(f"atomic_write({str(tmp_path / 'a.png')!r})")
    assert len(hidden(tmp_path)) == 1
    # It lives: its file is left alone.
    prepare_folder(tmp_path, ["a.png"])
    assert len(hidden(tmp_path)) == 1
    process.kill()
    process.wait()
    prepare_folder(tmp_path, ["a.png"])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["folder", "file.npz"])
def test_of_two_processes_on_one_output_the_second_is_refused(tmp_path, holder, name):
    path = tmp_path / name
    if name == "folder":
        path.mkdir()
    process = holder(f"claim({str(path)!r})")
    with pytest.raises(FileError, match=r"another process is writing there"), claim(path):
        pass
    with claim(tmp_path / "other.npz"):
        process.kill()
        process.wait()
    with claim(path):
        pass
    assert not list(tmp_path.rglob(f"{HIDDEN}*"))


def test_a_folder_is_held_while_it_is_written_to(tmp_path):
    with (
        output_folder(tmp_path / "new", ["a"]),
        pytest.raises(FileError, match="another process"),
        output_folder(tmp_path / "new", ["a"]),
    ):
        pass
    assert list(tmp_path.iterdir()) == [tmp_path / "new"]
    assert not list((tmp_path / "new").iterdir())


def test_bytes_are_on_the_disk_before_the_name_is_given(tmp_path, monkeypatch):
    path = tmp_path / "a"
    seen = []
    monkeypatch.setattr(os, "fsync", lambda descriptor: seen.append(path.exists()))
    with atomic_write(path) as file:
        file.write(b"x")
    assert seen == [False, True]


def test_permissions_are_the_usual_and_the_process_keeps_its_mask(tmp_path, monkeypatch):
    mask = os.umask(0o027)
    try:
        with monkeypatch.context() as patch:
            patch.setattr(os, "umask", None)
            with atomic_write(tmp_path / "a") as file:
                file.write(b"x")
        assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640
    finally:
        os.umask(mask)


def test_names_may_be_as_long_as_the_system_has_them(tmp_path):
    path = tmp_path / ("x" * 251 + ".npz")
    with claim(path), atomic_write(path) as file:
        file.write(b"x")
    assert path.read_bytes() == b"x"
    with pytest.raises(FileError, match="File name too long"), atomic_write(tmp_path / ("x" * 300)):
        pass
    with pytest.raises(FileError, match="holds a NUL"), atomic_write(tmp_path / "a\0b"):
        pass


def test_devices_pipes_and_folders_are_not_written_over(tmp_path, terminal):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(terminal)
    for path, kind in (
        (terminal, "a device or a pipe"),
        (tmp_path / "link", "a device or a pipe"),
        (tmp_path / "pipe", "a device or a pipe"),
        (tmp_path / "folder", "a folder"),
    ):
        with pytest.raises(FileError, match=kind), atomic_write(path):
            pass
    assert terminal.is_char_device()


def test_what_a_link_points_to_is_replaced_and_the_link_stays(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "a").symlink_to(tmp_path / "elsewhere" / "b")
    with atomic_write(tmp_path / "a") as file:
        file.write(b"x")
    assert (tmp_path / "a").is_symlink()
    assert (tmp_path / "elsewhere" / "b").read_bytes() == b"x"


def test_a_figure_does_not_trip_over_one_that_was_left(tmp_path):
    (tmp_path / ".a.png.partial").mkdir()
    write_figure(tmp_path / "a.png", Figure())
    assert (tmp_path / "a.png").stat().st_size > 0
