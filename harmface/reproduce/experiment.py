"""An experiment: a function that measures one claim from scratch."""

from collections.abc import Callable
from dataclasses import dataclass, field

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Measurement:
    """What an experiment found.

    Parameters
    ----------
    values
        In the order of the claim's expected values.
    note
        What a reader should know: the set-up, and the reason for any difference.
    figures
        Figures by caption.
    """

    values: list[float]
    note: str
    figures: dict[str, Figure] = field(default_factory=dict)


Experiment = Callable[..., Measurement]
"""Runs with its defaults; arguments vary an experiment."""
