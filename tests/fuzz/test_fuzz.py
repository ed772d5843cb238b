import pytest

from fuzz.harness import fuzz
from fuzz.readers import READERS

CASES = 500

OPEN = {"png", "jpeg", "tiff", "hdr", "gallery", "probe grid"}
OPEN |= {"mat", "capture", "coefficients", "manifest", "lights", "gallery list"}
"""Readers that some case gets the better of. A reader that passes must leave the list, as an
expected failure that does not fail is one."""


def marked(name):
    marks = [pytest.mark.xfail(reason="fails some cases")] if name in OPEN else []
    return pytest.param(name, marks=marks)


@pytest.mark.parametrize("name", [marked(name) for name in READERS])
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
    tally = fuzz(name, 0, 6)
    assert sum(tally.outcomes.values()) == 6
    assert set(tally.outcomes) <= {outcome, "read"}
    assert tally.outcomes[outcome] > 1


def test_a_case_is_the_same_every_time(tmp_path):
    for name in ("one", "two"):
        fuzz("exception", 0, 3, tmp_path / name)
    one, two = (sorted((tmp_path / name).rglob("*")) for name in ("one", "two"))
    assert [path.name for path in one] == [path.name for path in two]
    for first, second in zip(one, two, strict=True):
        assert first.is_dir() or first.read_bytes() == second.read_bytes()
