"""How objects that hold arrays show themselves: by shapes, not by a thousand numbers."""

from dataclasses import fields
from typing import Any

import numpy as np


def summary(value: Any) -> str:
    """Return a dataclass in one line: arrays by shape and dtype, all else as it is.

    Parameters
    ----------
    value
        An instance of a dataclass, which may take this function as its `__repr__`.

    Returns
    -------
    str
        Such as `DistantLight(directions=(3, 3) float64, irradiances=(3,) float64)`.
    """
    shown = ", ".join(f"{each.name}={_shown(getattr(value, each.name))}" for each in fields(value))
    return f"{type(value).__name__}({shown})"


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.shape} {value.dtype}"
    return repr(value)
