import pytest

from fuzz.harness import fuzz
from fuzz.readers import READERS

CASES = 500


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_read_or_refused(name):
    tally = fuzz(name, 0, CASES)
    assert sum(tally.outcomes.values()) == CASES
    assert tally.outcomes["refused"] > CASES / 10
    assert not tally.failures, f"\n{tally}"


@pytest.mark.parametrize(
    ("name", "outcome"),
    [
        ("segfault", "crash: SIGSEGV"),
        ("exception", "KeyError in pitfalls.py:_exception"),
        ("noise", "noise: library"),
        ("memory", "memory"),
        ("sound", "read"),
    ],
)
def test_what_goes_wrong_is_noticed(name, outcome):
    tally = fuzz(name, 0, 4)
    assert sum(tally.outcomes.values()) == 4
    assert set(tally.outcomes) <= {outcome, "read"}
    assert tally.outcomes[outcome] > 1


def test_reading_without_end_is_noticed():
    assert fuzz("endless", 3, 1).outcomes == {"hang": 1}


def test_a_case_is_the_same_every_time(tmp_path):
    for name in ("one", "two"):
        fuzz("exception", 0, 3, tmp_path / name)
    one, two = (sorted((tmp_path / name).rglob("*")) for name in ("one", "two"))
    assert [path.name for path in one] == [path.name for path in two]
    for first, second in zip(one, two, strict=True):
        assert first.is_dir() or first.read_bytes() == second.read_bytes()
