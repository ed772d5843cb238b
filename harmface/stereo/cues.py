"""What is known of a surface beside its images, as a measure of how badly a candidate fits.

A candidate for the scaled normals is `b = T v`, with v known and T to be found. Each cue is a
set of residuals r that vanish for the true T but for noise of unknown size. With a heavy-tailed
distribution of unknown width, a cue of N residuals costs about `N mean(log(r^2 + floor^2)) / 2`:
its weight follows from how well it can be met, so cues need no weights of their own, and edges,
discontinuities and wrong pixels count for little.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion, gaussian_filter

from harmface.stereo.cells import Cells, cells_of
from harmface.stereo.homogeneous import directions_of, scaled_normal_images
from harmface.stereo.lorentz import METRIC

TINY = float(np.finfo(np.float64).tiny)

BATCH = 32
"""Candidates judged at a time: 30 arrays of 1000 cells each stay in the cache."""

SEARCH_CELLS = 500
"""Cells that a search looks at: they fix a dozen numbers many times over."""

MOST_CELLS = 1000
"""Cells that as many as there are count like at most: neighbours say the same."""

ALL_CELLS = 10_000
"""Cells that the last step looks at, so that noise in single ones averages out."""

TWIST = 0.03
"""Antisymmetric share of the slopes' derivatives that differences over a cell may leave."""

FLOOR = 0.02
"""Error of a unit vector, or relative error, that counts as none: about a degree."""

GRAIN_SAY = 0.1
"""Weight of the albedo's derivatives: neighbouring cells share the grain of a texture."""

KNOWN_SAY = 100.0
"""Weight of all measured normals together: what was measured comes before what is likely, but the
structure at a few pixels is not exact either."""

LORENTZ = 0.1
"""Departure of first-order rows from a Lorentz transformation that light of degree 2 may cause."""

LORENTZ_SAY = 10.0
"""Weight of each of its six numbers; the same for rotations, which uniform light tells apart."""

ISOMETRY = 0.1
"""Departure from a rotation that light which is not quite uniform may cause."""

USUAL_UNIFORM = 0.1
"""Share of uniform light that is enough to tell."""

LIGHT_SAY = 1500.0
"""Weight of all light strengths together, against about a thousand cells."""

UNEQUAL = 0.05
"""Relative difference of strengths beyond which sources are just different ones."""

UNEQUAL_SAY = 20.0
"""Weight of the strength of each source, equal or only alike: like a score of cells."""

MOST_EXPLAINED = 500
"""Pixels whose images the harmonics of a candidate must explain."""

UNEXPLAINED = 0.03
"""Share of a pixel's values that light beyond degree 2 may leave unexplained."""

EXPLAIN_SAY = 3.0

USUAL_SPREAD = 0.4
"""Standard deviation of a normal's components over an object."""

RIM_TURN = 0.1
"""Part along the outline of a unit normal near it that counts as none: it is seen half a pixel or
half a block inside, where dents begin."""

RIM_SLANT = 0.95
"""Least outward component of a normal on an occluding outline, seen half a pixel inside it."""

REGIONS = 6
"""Regions along each side of the object. Within one, residuals err together, since neighbours
share texture and surface."""

ALONE = np.int64(-1)
"""Region of what errs by itself."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Pixels on an occluding outline: normals there have no part along the outline.

    Parameters
    ----------
    pixels
        Index among the masked pixels.
    outward
        Unit vectors in the image plane, x right and y up, away from the object.
    """

    pixels: Int[np.ndarray, "r"]
    outward: Float[np.ndarray, "r 2"]


def outline_of(mask: Bool[np.ndarray, "H W"]) -> Outline:
    """Return the rim of a mask where it does not touch the border of the picture.

    The outward direction is the slope of the blurred mask, so that it does not follow the steps
    of the pixels.
    """
    rim = mask & ~binary_erosion(mask, border_value=1)
    blurred = gaussian_filter(mask.astype(np.float64), max(2.0, np.sqrt(mask.sum()) / 20))
    down, right = np.gradient(blurred)
    index = np.full(mask.shape, -1)
    index[mask] = np.arange(mask.sum())
    slope = -np.stack([right[rim], -down[rim]], axis=1)
    length = np.linalg.norm(slope, axis=1)
    sure = length > 0.1 * length.max(initial=0)
    return Outline(index[rim][sure], slope[sure] / length[sure, None])


@dataclass(frozen=True, eq=False)
class KnownNormals:
    """Normals that were measured.

    Parameters
    ----------
    columns
        Of a stack or structure, where they were measured.
    normals
        Unit normals.
    """

    columns: Int[np.ndarray, "k"]
    normals: Float[np.ndarray, "k 3"]


@dataclass(frozen=True, eq=False)
class Knowledge:
    """What is known of a surface beside its images.

    Parameters
    ----------
    outline
        Occluding outline.
    normals
        Normals measured at some pixels.
    mirrored
        Index of each pixel's mirror image, for an object symmetric about a vertical plane that
        the viewer looks along; -1 where there is none.
    """

    outline: Outline | None = None
    normals: KnownNormals | None = None
    mirrored: Int[np.ndarray, "p"] | None = None


NOTHING = Knowledge()


@dataclass(frozen=True, eq=False)
class Evidence:
    """What cues say of candidates.

    Parameters
    ----------
    residual
        Of all cues over their floors, a row a candidate.
    weight
        Of each residual.
    region
        Where in the picture each residual comes from, `ALONE` if it is of no place.
    """

    residual: Float[np.ndarray, "m r"]
    weight: Float[np.ndarray, "r"]
    region: Int[np.ndarray, "r"]


class Cues:
    """Cost of candidates `b = T v` for fixed v.

    Parameters
    ----------
    structure
        v, d numbers a pixel; beyond the pixels of the mask, of where normals are known.
    mask
        The pixels.
    knowledge
        What else is known.
    explain
        Whether the harmonic images of the candidate must span the structure: of nine dimensions.
    cells
        Most cells looked at. They count for all, and all like `MOST_CELLS` at most.
    lights
        One point source an image: light rows in the basis of v, so that the sources are
        `lights T^-1`.
    equal
        Whether their strengths are thought equal, but for a few, or only alike.
    uniform
        Share of uniform light in the images. It shows `a |b|`, which only rotations keep.
    isometry
        Departure from a rotation that counts as none.
    """

    def __init__(
        self,
        structure: Float[np.ndarray, "d p"],
        mask: Bool[np.ndarray, "H W"],
        knowledge: Knowledge = NOTHING,
        *,
        lights: Float[np.ndarray, "F d"] | None = None,
        equal: bool = True,
        uniform: float = 0.0,
        isometry: float = ISOMETRY,
        explain: bool = False,
        cells: int = SEARCH_CELLS,
    ) -> None:
        # Albedo is divided out, so that its edges do not pass for slopes; all pixels count alike.
        size = np.linalg.norm(structure, axis=0)
        size = np.maximum(np.abs(size), 1e-6 * np.abs(size).max())
        v = (structure / size).T
        everywhere = cells_of(mask)
        seen: Cells = everywhere.thinned(cells)
        region = _regions(mask)
        self._cell_region = region[seen.corners[:, 0]]
        self._cell_say = min(MOST_CELLS, len(everywhere.corners)) / max(1, len(seen.corners))
        fields = (seen.middle(v), seen.along_x(v), seen.along_y(v))
        self._middle, self._dx, self._dy = (np.ascontiguousarray(field.T) for field in fields)
        log = np.log(size)[:, None]
        self._grain = np.stack([seen.along_x(log)[:, 0], seen.along_y(log)[:, 0]])
        self._coarse = 0.1 * float(np.median(np.abs(self._grain))) + 1e-6
        self._lights = lights
        self._equal = equal
        self._isometry = isometry
        self._isometry_say = LORENTZ_SAY * min(1.0, uniform / USUAL_UNIFORM)
        outline, known, mirrored = knowledge.outline, knowledge.normals, knowledge.mirrored
        self._outline = None
        if outline is not None:
            self._outline = (v[outline.pixels], outline.outward, region[outline.pixels])
        self._known = None
        if known is not None:
            self._known = (v[known.columns], known.normals)
        self._explained = None
        if explain:
            some = np.linspace(0, len(region) - 1, min(len(region), MOST_EXPLAINED)).astype(int)
            self._explained = (v[some], region[some])
        self._pairs = None
        if mirrored is not None:
            left = np.flatnonzero(mirrored >= 0)
            left = left[:: max(1, len(left) // MOST_CELLS)]
            self._pairs = (structure.T[left], structure.T[mirrored[left]], region[left])

    def cost(self, rows: Float[np.ndarray, "3 d"]) -> float:
        """Return the cost of T: lower is better, differences of a few units count."""
        return float(self.costs(rows[None])[0])

    def costs(self, rows: Float[np.ndarray, "m 3 d"]) -> Float[np.ndarray, "m"]:
        """Return the cost of each of many T."""
        found = []
        for first in range(0, len(rows), BATCH):
            said = self.evidence(rows[first : first + BATCH])
            found.append(np.log1p(said.residual**2) @ said.weight / 2)
        return np.concatenate(found)

    def evidence(self, rows: Float[np.ndarray, "m 3 d"]) -> Evidence:
        """Return the residuals of all cues for each T, and how they are to be counted."""
        # Components first: sums over three of them are the bulk of the work.
        b, dx, dy = rows @ self._middle, rows @ self._dx, rows @ self._dy
        (x, y, z), (xdx, ydx, zdx), (xdy, ydy, zdy) = (f.swapaxes(0, 1) for f in (b, dx, dy))
        squared = x * x + y * y + z * z + TINY
        # b x db holds b_z^2 times the derivatives of the slopes; integrable ones are symmetric,
        # and the share of the antisymmetric part does not change under bas-relief.
        xx, xy = y * zdx - z * ydx, z * xdx - x * zdx
        yx, yy = y * zdy - z * ydy, z * xdy - x * zdy
        bend = np.sqrt(xx * xx + xy * xy + yx * yx + yy * yy) + TINY
        gx = self._grain[0] + (x * xdx + y * ydx + z * zdx) / squared
        gy = self._grain[1] + (x * xdy + y * ydy + z * zdy) / squared
        say, region = self._cell_say, self._cell_region
        parts: list[tuple[Float[np.ndarray, "m n"], float, Int[np.ndarray, "*n"] | np.int64]] = [
            ((xx + yy) / bend / TWIST, say, region),
            (gx / self._coarse, GRAIN_SAY * say, region),
            (gy / self._coarse, GRAIN_SAY * say, region),
            (np.minimum(z / np.sqrt(squared), 0) / FLOOR, say, region),
        ]
        turned = rows.swapaxes(1, 2)
        if len(self._middle) == 4:
            parts.append((anisotropy(-rows @ METRIC @ turned) / LORENTZ, LORENTZ_SAY, ALONE))
        if self._isometry_say > 0:
            parts.append((anisotropy(rows @ turned) / self._isometry, self._isometry_say, ALONE))
        if self._outline is not None:
            v, outward, region = self._outline
            n = directions_of(v @ turned)
            along = n[..., 1] * outward[:, 0] - n[..., 0] * outward[:, 1]
            short = np.maximum(RIM_SLANT - (n[..., :2] * outward).sum(axis=-1), 0)
            parts += [(along / RIM_TURN, 1.0, region), (short / FLOOR, 1.0, region)]
        if self._known is not None:
            v, normals = self._known
            missed = (directions_of(v @ turned) - normals) / FLOOR
            parts.append((missed.reshape(len(rows), -1), KNOWN_SAY / len(normals), ALONE))
        if self._pairs is not None:
            # Unit vectors, since albedo need not be symmetric; each component against its own
            # spread, so that none gains by vanishing everywhere.
            left, right, region = self._pairs
            here, there = (directions_of(side @ turned) for side in (left, right))
            spread = here.std(axis=1, keepdims=True) + TINY
            apart = ((here - there * (-1, 1, 1)) / spread).reshape(len(rows), -1)
            parts.append((apart * USUAL_SPREAD / FLOOR, 1 / 3, region.repeat(3)))
        if self._explained is not None:
            v, region = self._explained
            b = (v @ turned).reshape(-1, 3)
            images = scaled_normal_images(b, 2).T.reshape(len(rows), len(v), -1)
            basis = np.linalg.qr(images)[0]
            missed = v - basis @ (basis.swapaxes(1, 2) @ v)
            parts.append((np.linalg.norm(missed, axis=-1) / UNEXPLAINED, EXPLAIN_SAY, region))
        if self._lights is not None:
            sources = self._lights @ np.linalg.pinv(rows)
            strength = np.log(np.linalg.norm(sources, axis=-1) + TINY)
            if self._equal:
                apart = strength - np.median(strength, axis=1, keepdims=True)
                bounded = apart / np.hypot(1, apart / UNEQUAL)
                parts.append((bounded / FLOOR, LIGHT_SAY / strength.shape[1], ALONE))
                parts.append((apart / FLOOR, UNEQUAL_SAY, ALONE))
            else:
                # All together: one by one, T could make eight of a dozen alike and gain by it.
                spread = strength.std(axis=1, keepdims=True)
                parts.append((spread / FLOOR, UNEQUAL_SAY * strength.shape[1], ALONE))
        return Evidence(
            np.concatenate([part for part, _, _ in parts], axis=1),
            np.concatenate([np.full(part.shape[1], say) for part, say, _ in parts]),
            np.concatenate([np.broadcast_to(place, part.shape[1]) for part, _, place in parts]),
        )


def _regions(mask: Bool[np.ndarray, "H W"]) -> Int[np.ndarray, "p"]:
    """Return the number of the region of each pixel, below `REGIONS` squared."""
    places = np.argwhere(mask)
    first = places.min(axis=0)
    row, column = ((places - first) * REGIONS // (places.max(axis=0) - first + 1)).T
    return np.asarray(row * REGIONS + column)


def anisotropy(products: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "m 6"]:
    """Return how far symmetric matrices are from multiples of the identity, relative to those."""
    scale = np.abs(np.einsum("mii->m", products)) / 3 + TINY
    return (products / scale[:, None, None] - np.eye(3))[:, *np.triu_indices(3)]
