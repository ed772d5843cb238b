"""Published figures, and what it takes to agree with them."""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

import numpy as np

from harmface.errors import ArgumentError

Kind = Literal["equal", "at_most", "at_least", "report", "goal"]
Values = list[float]


@dataclass(frozen=True)
class Claim:
    """A published figure that an experiment measures.

    Parameters
    ----------
    id
        Name on the command line.
    source
        Where it is published.
    what
        What is measured.
    expected
        The published values, or words where there are none to hold against.
    kind
        "equal": within `tolerance`, element by element; "at_most" and "at_least": bounded by
        `expected`; "goal": bounded like "at_most", but a miss fails nothing; "report": only shown.
    tolerance
        For "equal": one for all, or one for each value.
    """

    id: str
    source: str
    what: str
    expected: Values | str
    kind: Kind
    tolerance: Values

    def holds(self, measured: Values) -> bool | None:
        """Return whether `measured` agrees with what was published; None if not to be judged."""
        if self.kind == "report" or isinstance(self.expected, str):
            return None
        if len(measured) != len(self.expected):
            raise ArgumentError(
                f"claim {self.id} expects {len(self.expected)} values, got {len(measured)}"
            )
        found, expected = np.array(measured), np.array(self.expected)
        if self.kind == "equal":
            return bool((np.abs(found - expected) <= np.array(self.tolerance)).all())
        within = found >= expected if self.kind == "at_least" else found <= expected
        return bool(within.all())

    @property
    def bound(self) -> str:
        """What a measurement must be for the claim to hold, in words; how it would fail."""
        if self.kind == "report" or isinstance(self.expected, str):
            return "cannot fail: it is shown beside the published figure, without a bound"
        if self.kind == "equal":
            least = np.broadcast_to(self.tolerance, len(self.expected))
            ranges = ", ".join(
                f"{value - within:.6g} to {value + within:.6g}"
                for value, within in zip(self.expected, least, strict=True)
            )
            return f"fails if a value lies outside {ranges}"
        words = "below" if self.kind == "at_least" else "above"
        limits = ", ".join(f"{value:.6g}" for value in self.expected)
        if self.kind == "goal":
            return f"is not reached if a value lies {words} {limits}, which fails nothing"
        return f"fails if a value lies {words} {limits}"

    @property
    def binding(self) -> bool:
        """Whether the run fails if the claim does not hold."""
        return self.kind not in ("report", "goal")


def load_claims() -> dict[str, Claim]:
    """Return every claim of `claims.toml` by its id, in order."""
    with (files(__package__) / "claims.toml").open("rb") as file:
        table = tomllib.load(file)["claim"]
    return {entry["id"]: _claim(entry) for entry in table}


def _claim(entry: dict[str, Any]) -> Claim:
    expected = entry["expected"]
    return Claim(
        entry["id"],
        entry["source"],
        entry["what"],
        expected if isinstance(expected, str) else _values(expected),
        entry["kind"],
        _values(entry.get("tolerance", 0.0)),
    )


def _values(value: float | Values) -> Values:
    return list(map(float, value)) if isinstance(value, list) else [float(value)]
