"""The outcome of an experiment, judged."""

from dataclasses import dataclass

from harmface.reproduce.claims import Claim


@dataclass(frozen=True)
class Result:
    """A claim, what was measured, and whether it holds (None: not to be judged).

    Parameters
    ----------
    claim
        What was to be measured.
    values, note
        What was found, see `Measurement`.
    pictures
        Its figures as PNG, by caption.
    holds
        Whether the claim holds.
    seconds
        How long it took.
    """

    claim: Claim
    values: list[float]
    note: str
    pictures: dict[str, bytes]
    holds: bool | None
    seconds: float

    @property
    def failed(self) -> bool:
        """Whether this result makes the run fail."""
        return self.holds is False and self.claim.binding

    @property
    def verdict(self) -> str:
        """One word for people."""
        if self.holds is None:
            return "shown"
        if self.claim.kind == "goal":
            return "reached" if self.holds else "not reached"
        return "holds" if self.holds else "FAILS"
