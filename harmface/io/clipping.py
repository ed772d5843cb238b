"""Where photographs are clipped: the largest code, or a common one below it."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Num, UInt8

TOP = 0.01
"""Share of the largest code that a clipped photograph has fewer pixels in than at that code."""

FEWEST_CODES = 8
"""Codes that this share must hold: with fewer, one may well have as many pixels as all others."""


@dataclass
class Clipping:
    """Finds the code at which photographs of a set are clipped, in each channel.

    A camera of 12 bits clips at 4095 in a file of 16. Of light that is not clipped few pixels
    have just the largest code: their number falls towards it. Where more pixels have it than have
    all codes of the last hundredth below it, and several photographs have the same largest code,
    it is where they were clipped.
    """

    _tops: list[list[float]] = field(default_factory=list)
    _at: list[list[int]] = field(default_factory=list)
    _below: list[list[int]] = field(default_factory=list)

    def add(self, codes: Num[np.ndarray, "H W *channels"]) -> UInt8[np.ndarray, "H W"]:
        """Take a photograph; return a bit for each channel where it has its largest code."""
        marks = np.zeros(codes.shape[:2], np.uint8)
        tops, at, below = [], [], []
        for number, channel in enumerate(np.moveaxis(np.atleast_3d(codes), -1, 0)):
            top = channel.max()
            largest = channel == top
            marks |= largest.astype(np.uint8) << number
            tops.append(float(top))
            at.append(int(largest.sum()))
            below.append(int((channel >= (1 - TOP) * float(top)).sum()) - at[-1])
        self._tops.append(tops)
        self._at.append(at)
        self._below.append(below)
        return marks

    def levels(self, full: float | None) -> list[float | None]:
        """Return the code at which each channel is clipped below full scale, or None.

        Parameters
        ----------
        full
            The largest code that a file could hold; None of real numbers, which have none.
        """
        found: list[float | None] = []
        for channel in range(max(map(len, self._tops))):
            # Grey photographs among colour have one channel.
            rows = [n for n, tops in enumerate(self._tops) if channel < len(tops)]
            top = max(self._tops[n][channel] for n in rows)
            common = [n for n in rows if self._tops[n][channel] == top]
            at = sum(self._at[n][channel] for n in common)
            below = sum(self._below[n][channel] for n in common)
            fine = full is None or TOP * top >= FEWEST_CODES
            clipped = len(common) > 1 and fine and top > 0 and 0 < below < at and top != full
            found.append(top if clipped else None)
        return found

    def clipped(
        self, number: int, marks: UInt8[np.ndarray, "H W"], levels: list[float | None]
    ) -> Bool[np.ndarray, "H W"]:
        """Return where a photograph is clipped in any channel.

        Parameters
        ----------
        number
            Of the photograph, in the order in which they were taken.
        marks
            What `add` returned for it.
        levels
            What `levels` returns.
        """
        bits = sum(
            1 << channel for channel, top in enumerate(self._tops[number]) if top == levels[channel]
        )
        return (marks & np.uint8(bits)) != 0
