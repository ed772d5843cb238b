import numpy as np
import pytest

from harmface.reproduce import population


@pytest.fixture
def small(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(population, "PEOPLE", 2)
    monkeypatch.setattr(population, "SIZE", 16)
    return tmp_path / "cache" / "harmface" / "people-1.npz"


def test_people_are_rendered_once(small, monkeypatch):
    first = population.procedural_people()
    assert first.images.shape[1:] == (16, 16)
    assert np.bincount(first.subjects).tolist() == 2 * [len(first.subjects) // 2]
    # Light from the front stands first, and is brightest of all.
    each = first.images.reshape(2, -1, 256).mean(axis=2)
    assert each.argmax(axis=1).tolist() == [0, 0]
    monkeypatch.setattr(population, "_codes", None)
    again = population.procedural_people()
    assert np.array_equal(again.images, first.images)
    assert np.array_equal(again.subjects, first.subjects)


def test_damaged_people_are_made_again(small):
    first = population.procedural_people()
    small.write_bytes(small.read_bytes()[:-100])
    assert np.array_equal(population.procedural_people().images, first.images)


def test_where_nothing_can_be_kept_people_are_rendered_all_the_same(small, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert len(population.procedural_people().subjects) > 2
