"""Any distance, of probes that are framed differently from the gallery.

The motion under which a probe comes nearest to anybody is searched for, from coarse to fine: over
places first, then over angles and sizes, then over both more finely. All subjects are compared
under that one motion. Every probe comes somewhat nearer by it, and where light grazes, a probe that
is in place may come nearest to another person. So a probe of photographs is moved only if it comes
nearer, in proportion, than 9 in 10 photographs that are in place, the gallery's own, held out.

Steps are fractions of the picture's height, so that the search reaches a tenth of it, 5 degrees and
7 %; the last are half a pixel of a small picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from operator import itemgetter

import numpy as np
from jaxtyping import Bool, Float, Integer

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

IN_PLACE = 0.9
"""Share of the photographs that are in place which are left there."""

MOST_TRIED = 50
"""Photographs in place that are searched for it: the tenth part is then five of them."""

BEAM = 5
"""Motions that each round starts from. Of a probe that is shifted, turned and larger at once the
first rounds see one after another, and the nearest of one round may lead the next astray."""

AT_ONCE = 2000
"""Moved probes compared at a time: 16 MB of a small picture."""

DIGITS = 9
"""Digits of motions after the point."""

Beam = dict[Motion, float]
"""How far a probe is from the nearest subject after each motion."""


@dataclass(frozen=True)
class FramedDistance(Distance):
    """Another distance, of the probe in its best position.

    Parameters
    ----------
    source
        What subjects are known by, one of `SOURCES`.
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

        Parameters
        ----------
        gallery
            Who was enrolled.

        Returns
        -------
        mapping of str to numpy.ndarray
            What the inner distance knows, and the scalar `ratio_in_place`.
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
        """Return the inner distance of every probe in its best position.

        Parameters
        ----------
        model
            From `fit`.
        probes
            Linear photographs in the gallery's unit, (n, rows, columns).
        mask
            Pixels that are compared: those of the gallery.

        Returns
        -------
        numpy.ndarray
            Shape (n, N), subjects in the order of `Gallery.names`.
        """
        return self.search(model, probes, mask)[0]

    def search(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> tuple[Float[np.ndarray, "n N"], list[Motion]]:
        """Return the distances, and how every probe lies against the frame of the gallery.

        Parameters
        ----------
        model
            From `fit`.
        probes
            Linear photographs in the gallery's unit, (n, rows, columns).
        mask
            Pixels that are compared: those of the gallery.

        Returns
        -------
        distances : numpy.ndarray
            Shape (n, N), subjects in the order of `Gallery.names`.
        motions : list of Motion
            One for each probe; no motion for those that stay in place.
        """
        before = self.inner.distances(model, probes, mask)
        found, motions = self._nearest(model, probes, mask, before)
        stays = found.min(axis=1) >= model["ratio_in_place"] * before.min(axis=1)
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
        searched = self.inner.searched(model)
        least = distances if searched is model else self.inner.distances(searched, probes, mask)
        beams = [{Motion(): float(nearest)} for nearest in least.min(axis=1)]
        for places, angles, sizes in zip(PLACES, ANGLES, SIZES, strict=True):
            steps = [fraction * mask.shape[0] for fraction in places]
            shifts = [Motion(x, y) for x in steps for y in steps]
            turns = [Motion(rotation=a, scale=s) for a in angles for s in sizes]
            for candidates in (shifts, turns):
                beams = self._better(searched, probes, mask, beams, candidates)
        motions = [min(beam, key=beam.__getitem__) for beam in beams]
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
        """Return what the inner distance makes of the probes as they are.

        Parameters
        ----------
        gallery
            That of `fit`.
        probes
            Linear photographs, (n, rows, columns).
        which
            Number of the subject to compare each with.

        Returns
        -------
        pictures : numpy.ndarray
            Shape (n, rows, columns), in the probes' unit.
        light : numpy.ndarray or None
            Shape (n, K): harmonic coefficients; None if subjects are known by photographs alone.
        """
        return self.inner.explained(gallery, probes, which)

    def _better(
        self,
        model: Model,
        probes: Float[np.ndarray, "n H W"],
        mask: Bool[np.ndarray, "H W"],
        beams: list[Beam],
        candidates: Sequence[Motion],
    ) -> list[Beam]:
        """Return the best of each beam as it is, and followed by each of the candidates."""
        tried = [
            (n, motion)
            for n, beam in enumerate(beams)
            for motion in dict.fromkeys(_sum(old, more) for old in beam for more in candidates)
            if motion not in beam
        ]
        grown = [dict(beam) for beam in beams]
        for first in range(0, len(tried), AT_ONCE):
            some = tried[first : first + AT_ONCE]
            moved = np.stack([undone(probes[n], motion) for n, motion in some])
            # Moved away from what little light there is, a probe shows nothing.
            empty = np.ptp(moved[:, mask], axis=1) == 0
            moved[empty] = probes[[n for n, _ in some]][empty]
            nearest = self.inner.distances(model, moved, mask).min(axis=1)
            for (n, motion), distance in zip(some, nearest, strict=True):
                grown[n][motion] = float(distance)
        return [dict(sorted(beam.items(), key=itemgetter(1))[:BEAM]) for beam in grown]


def misframed(motion: Motion, rows: int) -> bool:
    """Return whether a probe lies farther off than the finest step of the search.

    Parameters
    ----------
    motion
        How it lies.
    rows
        Height of the picture.

    Returns
    -------
    bool
        True if it is worth telling.
    """
    return bool(
        np.hypot(motion.right, motion.down) > PLACES[0][-2] * rows
        or abs(motion.rotation) > ANGLES[1][-1]
        or abs(motion.scale - 1) > SIZES[1][-1] - 1 + 1e-9
    )


def _sum(one: Motion, more: Motion) -> Motion:
    """Return two motions as one, the same by whichever steps it is reached."""
    return Motion(
        round(one.right + more.right, DIGITS),
        round(one.down + more.down, DIGITS),
        round(one.rotation + more.rotation, DIGITS),
        round(one.scale * more.scale, DIGITS),
    )
