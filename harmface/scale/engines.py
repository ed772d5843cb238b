"""Where the items of a job are worked on: in this process, or on a Dask cluster.

A job is groups of items. Every item is worked on by itself, what a group's items give is merged,
and the results come in the order of the groups, whoever worked on them. On Dask a worker that is
lost loses nothing but time: its items are given to others, and give the same.
"""

import logging
import warnings
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import reduce
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, TypeVar

from harmface import checks
from harmface.errors import ArgumentError, HarmfaceError

if TYPE_CHECKING:
    from distributed import Client, Future

Item = TypeVar("Item")
Result = TypeVar("Result")

MEMORY = "2 GiB"
"""Memory of a worker of a local cluster: one that needs more is ended, and its item given anew."""

SECONDS = 10
"""How long to wait for a scheduler to answer."""

AHEAD = 1000
"""Items that a scheduler is given before the first of them is done."""

MERGED = 8
"""Results that one step of a merge takes."""

PACKAGES = ("harmface", "numpy", "scipy", "zarr", "dask", "distributed")
"""What must be of one version everywhere, for results to be the same everywhere."""


LOGS = ("distributed", "distributed.client", "distributed.worker", "tornado", "asyncio")
"""Logs of Dask and of what it stands on."""


class Engine(ABC):
    """Something that works on the items of a job."""

    @abstractmethod
    def merged(
        self,
        function: Callable[[Item], Result],
        groups: Iterable[Sequence[Item]],
        merge: Callable[[Result, Result], Result],
    ) -> Iterator[Result]:
        """Return what the items of each group give, merged, in the order of the groups.

        Parameters
        ----------
        function
            Pure: what it returns depends on its item alone. It can be pickled, as items can.
        groups
            Items of each, at least one.
        merge
            Associative.

        Yields
        ------
        Any
            One result for each group.
        """

    def each(self, function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
        """Return what every item gives, in their order.

        Parameters
        ----------
        function
            As of `merged`.
        items
            Any number.

        Returns
        -------
        Iterator
            One result for each item.
        """
        return self.merged(function, ([item] for item in items), _never)


class InProcess(Engine):
    """Works on one item after the other, in this process."""

    def merged(
        self,
        function: Callable[[Item], Result],
        groups: Iterable[Sequence[Item]],
        merge: Callable[[Result, Result], Result],
    ) -> Iterator[Result]:
        """Return what the items of each group give, merged."""
        for group in groups:
            yield reduce(merge, map(function, group))


class OnDask(Engine):
    """Works on many items at a time, on the workers of a Dask cluster.

    Parameters
    ----------
    client
        Connected to the cluster.
    """

    def __init__(self, client: "Client") -> None:
        self.client = client

    def merged(
        self,
        function: Callable[[Item], Result],
        groups: Iterable[Sequence[Item]],
        merge: Callable[[Result, Result], Result],
    ) -> Iterator[Result]:
        """Return what the items of each group give, merged by a tree on the workers."""
        waiting: deque[tuple[int, Future]] = deque()
        told: set[str] = set()
        with warnings.catch_warnings():
            # It may carry a gallery: it goes to each worker once, and anew if that is lost.
            warnings.simplefilter("ignore", UserWarning)
            carried = self.client.submit(_carried, function, pure=False)
        try:
            for group in groups:
                waiting.append((len(group), self._submitted(carried, group, merge)))
                while sum(count for count, _ in waiting) > AHEAD and len(waiting) > 1:
                    yield self._result(waiting.popleft()[1], told)
            while waiting:
                yield self._result(waiting.popleft()[1], told)
        finally:
            # Whoever stops early may have closed the client before.
            if waiting and self.client.status == "running":
                self.client.cancel([future for _, future in waiting], force=True)

    def _submitted(
        self,
        carried: "Future",
        group: Sequence[Item],
        merge: Callable[[Result, Result], Result],
    ) -> "Future":
        found = self.client.map(_noted, group, function=carried, pure=False)
        while len(found) > 1:
            found = [
                self.client.submit(_merged, merge, *found[first : first + MERGED], pure=False)
                for first in range(0, len(found), MERGED)
            ]
        return found[0]

    def _result(self, future: "Future", told: set[str]) -> Any:
        """Return a result; warnings of the workers are given here, each once."""
        from distributed import KilledWorker

        try:
            result, notes = future.result()
        except KilledWorker:
            raise HarmfaceError(
                "one part of the work has ended several workers one after the other, as happens "
                "when memory runs out; give workers more of it. The same command goes on from there"
            ) from None
        except CancelledError:
            raise HarmfaceError(
                "the scheduler was lost; start it anew, and the same command goes on from there"
            ) from None
        for category, text in notes:
            if text not in told:
                told.add(text)
                warnings.warn(text, category, stacklevel=2)
        return result


@contextmanager
def engine(
    workers: int | None = None,
    scheduler: str | None = None,
    tell: Callable[[str], None] = lambda text: None,
) -> Iterator[Engine]:
    """Open where items are worked on: this process, if nothing else is asked for.

    Parameters
    ----------
    workers
        Processes of a cluster on this machine, of one thread each.
    scheduler
        Address of the scheduler of a cluster that runs.
    tell
        Given the address of the cluster's dashboard.

    Yields
    ------
    Engine
        While the block runs.

    Raises
    ------
    ArgumentError
        If both are asked for, or Dask is not installed.
    HarmfaceError
        If no scheduler answers at the address, it has no workers, or their versions are others.
    """
    if workers is None and scheduler is None:
        yield InProcess()
        return
    if workers is not None and scheduler is not None:
        raise ArgumentError("workers and a scheduler are two places to work at; give one of them")
    if find_spec("distributed") is None:
        raise ArgumentError("Dask is not installed; pip install 'harmface[dask]'")
    from distributed import Client, LocalCluster

    # What it says of lost connections and restarted workers is of no use beside a result.
    for name in LOGS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    if workers is not None:
        checks.positive_integer("workers", workers)
        with (
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                memory_limit=MEMORY,
                dashboard_address=":0",
                silence_logs=logging.CRITICAL,
            ) as cluster,
            Client(cluster) as client,
        ):
            tell(client.dashboard_link)
            yield OnDask(client)
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # versions are compared below
            client = Client(scheduler, timeout=SECONDS)
    except (OSError, ValueError, TypeError) as error:
        raise HarmfaceError(
            f"{scheduler}: no scheduler answers there ({str(error)[:100]}); start `dask scheduler`"
        ) from None
    with client:
        _check_versions(client, str(scheduler))
        tell(client.dashboard_link)
        yield OnDask(client)


def _check_versions(client: "Client", scheduler: str) -> None:
    """Refuse a cluster that has no workers, or whose versions are not those of this process."""
    try:
        client.wait_for_workers(1, timeout=SECONDS)
    except TimeoutError:
        raise HarmfaceError(
            f"{scheduler}: has no workers; start `dask worker {scheduler}`"
        ) from None
    workers = client.get_versions(packages=list(PACKAGES))["workers"]
    for address, found in workers.items():
        for package in PACKAGES:
            own, theirs = version(package), found["packages"].get(package)
            if own != theirs:
                raise HarmfaceError(
                    f"{scheduler}: worker {address} has {package} {theirs}, this process {own}; "
                    "install the same version everywhere"
                )


def _carried(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return function


def _noted(item: Any, function: Callable[[Any], Any]) -> tuple[Any, list[tuple[Any, str]]]:
    """Return a result, and the warnings on the way to it, which are not seen on a worker."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        result = function(item)
    return result, [(each.category, str(each.message)) for each in found]


def _merged(merge: Callable[[Any, Any], Any], *some: Any) -> tuple[Any, list[tuple[Any, str]]]:
    results, notes = zip(*some, strict=True)
    return reduce(merge, results), [note for own in notes for note in own]


def _never(one: Any, other: Any) -> Any:
    raise AssertionError("items by themselves are not merged")
