import json

import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError
from harmface.io import read_coefficients, read_environment_map, write_environment_map
from harmface.light import project
from harmface.scale import Job, project_maps


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def maps(tmp_path, rng):
    folder = tmp_path / "maps"
    folder.mkdir()
    for number in range(4):
        write_environment_map(folder / f"{number}.hdr", rng.random((8, 16, 3), dtype=np.float32))
    return sorted(folder.iterdir())


def test_every_map_is_projected_as_by_itself(maps, tmp_path, at):
    out = tmp_path / "out"
    kept, skipped = project_maps(out, maps, read_environment_map, 3, Job(at))
    assert skipped == []
    for file, path in zip(kept, maps, strict=True):
        expected = project(read_environment_map(path), 3)
        assert np.allclose(read_coefficients(file), expected, rtol=1e-6, atol=1e-7)
    assert json.loads((out / "manifest.json").read_text())["maps"]["2.json"] == "2.hdr"
    again = tmp_path / "again"
    project_maps(again, maps, read_environment_map, 3)
    assert contents(out) == contents(again)
    with pytest.raises(FileError, match="holds other results"):
        project_maps(out, maps, read_environment_map, 2)


def test_a_stopped_run_goes_on(maps, tmp_path):
    def stopping(done):
        if done >= 0.5:
            raise KeyboardInterrupt

    out = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        project_maps(out, maps, read_environment_map, 2, Job(progress=stopping))
    told = []
    project_maps(out, maps, read_environment_map, 2, Job(progress=told.append))
    assert told == [0.5, 1.0]
    project_maps(tmp_path / "whole", maps, read_environment_map, 2)
    assert contents(out) == contents(tmp_path / "whole")


def test_a_map_that_cannot_be_read_is_named(maps, tmp_path, at):
    maps[1].write_bytes(b"of no use")
    with pytest.raises(FileError, match=r"1\.hdr"):
        project_maps(tmp_path / "a", maps, read_environment_map, 2, Job(at))
    job = Job(at, skip_bad=True)
    kept, skipped = project_maps(tmp_path / "b", maps, read_environment_map, 2, job)
    assert [path.name for path in kept] == ["0.json", "2.json", "3.json"]
    assert len(skipped) == 1


def test_two_maps_of_one_name_are_refused(maps, tmp_path):
    with pytest.raises(ArgumentError, match="names of their own"):
        project_maps(tmp_path / "out", [*maps, maps[0]], read_environment_map)
