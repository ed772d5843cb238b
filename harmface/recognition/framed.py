"""Any distance, of probes that are framed differently from the gallery.

The motion under which a probe comes nearest to anybody is searched for, from coarse to fine: over
places first, then over angles and sizes, then over both more finely. All subjects are compared
under that one motion. Every probe comes somewhat nearer by it, and where light grazes, a probe that
is in place may come nearest to another person. So a probe of photographs is moved only if it comes
nearer, in proportion, than 19 in 20 photographs that are in place, the gallery's own, held out, and
if it is then told apart from other people more clearly: chance brings all of them nearer.

Steps are fractions of the picture's height, so that the search reaches a tenth of it, 5 degrees and
7 %; the last are half a pixel of a small picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.recognition.answers import margins
from harmface.recognition.distance import Distance, Model
from harmface.recognition.evaluation import spread
from harmface.recognition.gallery import Gallery
from harmface.recognition.held_out import tries
from harmface.recognition.local_subspace import LocalDistance
from harmface.recognition.registration import Motion, undone

PLACES = (
    (-1 / 16, -1 / 32, 0, 1 / 32, 1 / 16),
    (-1 / 48, 0, 1 / 48),
    (-1 / 96, 0, 1 / 96),
)
"""Shifts along each axis that are tried in each round, as fractions of the height."""

ANGLES = ((-3.0, 0.0, 3.0), (-1.5, 0.0, 1.5), (-0.75, 0.0, 0.75))
"""Turns that are tried, in degrees."""

SIZES = ((0.96, 1.0, 1.04), (0.98, 1.0, 1.02), (0.99, 1.0, 1.01))
"""Enlargements that are tried together with the turns."""

IN_PLACE = 0.95
"""Share of the photographs that are in place which are left there."""

MOST_TRIED = 200
"""Photographs in place that are searched for it: the twentieth part is then ten of them."""


@dataclass(frozen=True)
class FramedDistance(Distance):
    """Another distance, of the probe in its best position.

    Parameters
    ----------
    inner
        The distance of the moved probe.
    """

    inner: Distance = field(default_factory=LocalDistance)

    @property
    def of_framed(self) -> Distance:
        """The inner distance: the gallery's own photographs are framed as they are."""
        return self.inner

    @property
    def learns(self) -> bool:  # type: ignore[override]
        """As the inner distance does."""
        return self.inner.learns

    @property
    def harmonics(self) -> slice:
        """Those of the inner distance."""
        return self.inner.harmonics

    def fit(self, gallery: Gallery) -> Model:
        """Return what the inner distance knows, and how much nearer the search must bring a probe.

        Without photographs that are held out any nearer place will do.
        """
        tried = [] if self.of_surfaces else tries(gallery, self.learns)
        ratios = [np.ones(0)]
        for known, probes, truth in tried:
            model, some = self.inner.fit(known), spread(len(truth), MOST_TRIED // len(tried))
            there = self.inner.distances(model, probes[some], known.mask)
            after = self._nearest(model, probes[some], known.mask, there)[0].min(axis=1)
            before = there.min(axis=1)
            ratios.append(after[before > 0] / before[before > 0])
        found = np.concatenate(ratios)
        least = np.quantile(found, 1 - IN_PLACE) if found.size else 1.0
        return {**self.inner.fit(gallery), "ratio_in_place": np.array(least)}

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the inner distance of every probe in its best position."""
        return self.search(model, probes, mask)[0]

    def search(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the distances, and how every probe lies against the frame of the gallery."""
        before = self.inner.distances(model, probes, mask)
        found, motions = self._nearest(model, probes, mask, before)
        stays = found.min(axis=1) >= model["ratio_in_place"] * before.min(axis=1)
        if before.shape[1] > 1:
            stays |= margins(found) <= margins(before)
        motions = [
            Motion() if stay else motion for motion, stay in zip(motions, stays, strict=True)
        ]
        return np.where(stays[:, None], before, found), motions

    def _nearest(
        self,
        model: Model,
        probes: Float[np.ndarray, "n H W"],
        mask: Bool[np.ndarray, "H W"],
        distances: Float[np.ndarray, "n N"],
    ) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the distances where they are least, those where the probes are given first."""
        motions = [Motion()] * len(probes)
        searched = self.inner.searched(model)
        least = distances if searched is model else self.inner.distances(searched, probes, mask)
        for places, angles, sizes in zip(PLACES, ANGLES, SIZES, strict=True):
            steps = [fraction * mask.shape[0] for fraction in places]
            shifts = [Motion(x, y) for x in steps for y in steps]
            turns = [Motion(rotation=a, scale=s) for a in angles for s in sizes]
            for candidates in (shifts, turns):
                least, motions = self._better(searched, probes, mask, least, motions, candidates)
        if searched is model:
            return least, motions
        moved = np.array([motion != Motion() for motion in motions])
        if not moved.any():
            return distances, motions
        distances = distances.copy()
        there = [undone(probes[n], motions[n]) for n in np.flatnonzero(moved)]
        distances[moved] = self.inner.distances(model, np.stack(there), mask)
        return distances, motions

    def explained(
        self, gallery: Gallery, probes: Float[np.ndarray, "n H W"], which: Integer[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "n H W"], Float[np.ndarray, "n K"] | None]:
        """Return what the inner distance makes of the probes as they are."""
        return self.inner.explained(gallery, probes, which)

    def _better(
        self,
        model: Model,
        probes: Float[np.ndarray, "n H W"],
        mask: Bool[np.ndarray, "H W"],
        distances: Float[np.ndarray, "n N"],
        motions: Sequence[Motion],
        candidates: Sequence[Motion],
    ) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the best of motions as they are, and followed by each of the candidates."""
        best = list(motions)
        for more in candidates:
            if more == Motion():
                continue
            tried = [_sum(motion, more) for motion in motions]
            moved = np.stack([undone(*each) for each in zip(probes, tried, strict=True)])
            # Moved away from what little light there is, a probe shows nothing.
            empty = np.ptp(moved[:, mask], axis=1) == 0
            moved[empty] = probes[empty]
            found = self.inner.distances(model, moved, mask)
            nearer = found.min(axis=1) < distances.min(axis=1)
            distances = np.where(nearer[:, None], found, distances)
            best = [
                new if take else old for old, new, take in zip(best, tried, nearer, strict=True)
            ]
        return distances, best


def misframed(motion: Motion, rows: int) -> bool:
    """Return whether a probe lies farther off than the finest step of the search.

    Parameters
    ----------
    motion
        How it lies.
    rows
        Height of the picture.
    """
    return bool(
        np.hypot(motion.right, motion.down) > PLACES[0][-2] * rows
        or abs(motion.rotation) > ANGLES[1][-1]
        or abs(motion.scale - 1) > SIZES[1][-1] - 1 + 1e-9
    )


def _sum(one: Motion, more: Motion) -> Motion:
    return Motion(
        one.right + more.right,
        one.down + more.down,
        one.rotation + more.rotation,
        one.scale * more.scale,
    )
