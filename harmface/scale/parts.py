"""Parts of a long job, made by an engine and kept until all of it is there."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from harmface.io.parts import Parts
from harmface.scale.engines import Engine

Arrays = Mapping[str, np.ndarray]


def kept(
    parts: Parts, engine: Engine, make: Callable[[Any], Arrays], items: Mapping[str, Any]
) -> Iterator[Arrays]:
    """Return what a function makes of the items of a job, from where it is kept, or made anew.

    Parameters
    ----------
    parts
        Where they are kept.
    engine
        Where those that are missing are made.
    make
        Pure; it can be pickled, as items can.
    items
        By name.

    Yields
    ------
    dict
        Arrays of each item, in their order.
    """
    found = {name: parts.load(name) for name in items}
    missing = [item for name, item in items.items() if found[name] is None]
    made = engine.each(partial(_alone, make), missing)
    for name, known in found.items():
        if known is None:
            arrays = next(made)
            parts.save(name, arrays, {})
            yield arrays
        else:
            yield known[0]


def _alone(make: Callable[[Any], Arrays], item: Any) -> Arrays:
    # Sums of one thread have one order, so the bytes do not depend on the number of cores.
    with threadpool_limits(1):
        return make(item)
