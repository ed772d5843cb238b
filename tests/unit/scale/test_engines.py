import operator
import os
import re
import signal
import warnings
from concurrent.futures import CancelledError

import numpy as np
import pytest

from harmface.errors import ArgumentError, FileError, FileWarning, HarmfaceError
from harmface.scale import engine


def joined(item):
    return [item]


def poisoned(item):
    if item == 3:
        raise FileError("three.png: cannot be read")
    return item


def warned(item):
    warnings.warn("old.png: was believed", FileWarning, stacklevel=1)
    return item


def killed_once(item):
    number, marker = item
    if number == 5 and not marker.exists():
        marker.write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return np.random.default_rng(number).random(3).tobytes()


def test_groups_are_merged_in_order(at):
    groups = [range(20), range(20, 21), range(21, 40)]
    found = list(at.merged(joined, groups, operator.add))
    assert found == [list(group) for group in groups]
    assert list(at.each(poisoned, [1, 2])) == [1, 2]


def test_a_poisoned_item_is_named_as_on_one_machine(at):
    with pytest.raises(FileError, match=r"^three\.png: cannot be read$"):
        list(at.each(poisoned, range(6)))
    # The engine is as good as before.
    assert list(at.each(poisoned, [7])) == [7]


def test_warnings_of_workers_are_given_once(cluster):
    with (
        engine(scheduler=cluster.scheduler_address) as at,
        pytest.warns(FileWarning, match="was believed") as found,
    ):
        assert list(at.each(warned, range(5))) == list(range(5))
    assert len(found) == 1


def test_many_items_are_not_all_handed_over_at_once(cluster, monkeypatch):
    monkeypatch.setattr("harmface.scale.engines.AHEAD", 4)
    with engine(scheduler=cluster.scheduler_address) as at:
        assert list(at.each(abs, range(50))) == list(range(50))


def test_a_killed_worker_changes_no_byte(cluster, tmp_path):
    items = [(number, tmp_path / "killed") for number in range(12)]
    with engine(scheduler=cluster.scheduler_address) as at:
        found = list(at.each(killed_once, items))
    assert (tmp_path / "killed").exists()
    assert found == [np.random.default_rng(number).random(3).tobytes() for number in range(12)]


def test_an_item_that_ends_every_worker_is_said(cluster, monkeypatch):
    monkeypatch.setattr(cluster.scheduler, "allowed_failures", 0)
    with (
        engine(scheduler=cluster.scheduler_address) as at,
        pytest.raises(HarmfaceError, match="has ended several workers"),
    ):
        list(at.each(os._exit, [1]))


def test_a_scheduler_that_is_lost_is_said(cluster, monkeypatch):
    def lost(future):
        raise CancelledError("scheduler-connection-lost")

    with engine(scheduler=cluster.scheduler_address) as at:
        monkeypatch.setattr("distributed.Future.result", lost)
        with pytest.raises(HarmfaceError, match="the scheduler was lost"):
            list(at.each(abs, [1]))


def test_the_dashboard_is_told(cluster):
    told = []
    with engine(scheduler=cluster.scheduler_address, tell=told.append):
        pass
    assert re.fullmatch(r"http://[\d.]+:\d+/status", told[0])


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense"])
def test_an_address_without_a_scheduler_is_refused(address, monkeypatch):
    monkeypatch.setattr("harmface.scale.engines.SECONDS", 1)
    with pytest.raises(HarmfaceError, match="no scheduler answers there"), engine(None, address):
        pass


def test_a_scheduler_without_workers_is_refused(monkeypatch):
    from distributed import LocalCluster

    monkeypatch.setattr("harmface.scale.engines.SECONDS", 1)
    with (
        LocalCluster(n_workers=0, dashboard_address=":0") as empty,
        pytest.raises(HarmfaceError, match="has no workers"),
        engine(scheduler=empty.scheduler_address),
    ):
        pass


def test_other_versions_are_refused(cluster, monkeypatch):
    from importlib.metadata import version

    def other(package):
        return "0.0.1" if package == "numpy" else version(package)

    monkeypatch.setattr("harmface.scale.engines.version", other)
    with (
        pytest.raises(HarmfaceError, match=r"worker tcp://.* has numpy .*, this process 0\.0\.1"),
        engine(scheduler=cluster.scheduler_address),
    ):
        pass


def test_two_places_to_work_at_are_refused():
    with pytest.raises(ArgumentError, match="give one of them"), engine(2, "tcp://a:1"):
        pass
    with pytest.raises(ArgumentError, match="workers"), engine(0):
        pass


def test_without_dask_it_is_said(monkeypatch):
    monkeypatch.setattr("harmface.scale.engines.find_spec", lambda name: None)
    with pytest.raises(ArgumentError, match="Dask is not installed"), engine(2):
        pass
    with engine() as at:
        assert list(at.each(abs, [-1])) == [1]
