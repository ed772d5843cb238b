"""The fixed triangulation of a head: where its vertices lie in the parameter disc.

The head is a disc pulled over the skull: the centre is the crown, the rim is the neck's open
end, the angle runs round the head from the face (+y of the disc) to the nape. Triangles are
halved where the mean head departs most from them until the wanted number of vertices is
reached, so that eyelids, nostrils and ears get small triangles and the back of the skull large
ones. Only the right half is made; the left is its mirror image.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Surface = Callable[[np.ndarray], np.ndarray]

_FAN = 12  # triangles round the crown in the half disc
_SIZE_WEIGHT = 1 / 1600  # 1/mm: a flat edge counts like one of radius 200 mm
_FLIPS = 1  # rounds of edge flips after each round of splits
_GROWTH = 0.12  # a round splits at most this fraction of the vertices' number
_GAIN = 0.9  # a flip has to lower the error to this fraction
_SLIM = 0.05  # the least part of a quadrilateral's area that a flip may leave to one triangle


class Template(NamedTuple):
    """A mirror-symmetric triangulation of the disc, built from its right half."""

    points: np.ndarray  # (H, 2) disc coordinates of the right half, x >= 0
    paired: np.ndarray  # (L,) indices of those of the half that have a twin on the left
    faces: np.ndarray  # (F, 3) int32 over the H + L vertices, counter-clockwise from outside


def build_template(n_vertices: int, surface: Surface) -> Template:
    """Triangulate the disc with `n_vertices` vertices, adapted to `surface`.

    Every triangle is only ever halved at its longest edge in space, and only together with the
    triangle on the other side whose longest edge this is too (Rivara's longest-edge propagation
    path). Between the rounds, diagonals are flipped where the other one lies closer to the
    surface, which lines the edges up with lids, lips and the rims of the ears.

    Parameters
    ----------
    n_vertices
        Vertices of the whole mesh. An odd remainder that no edge of the mid-plane can take up
        leaves the mesh one vertex short.
    surface
        Maps `(N, 2)` disc coordinates with x >= 0 to `(N, D)`: three columns of millimetres in
        space, then anything else that the triangles should follow, scaled to millimetres.
    """
    mesh = _HalfMesh(surface)
    while mesh.split(n_vertices):
        for _ in range(_FLIPS):
            mesh.flip()
    return mesh.mirrored()


class _HalfMesh:
    """A triangulation of the right half disc that is being refined."""

    def __init__(self, surface: Surface) -> None:
        angle = np.linspace(0, np.pi, _FAN + 1)
        rim = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        rim[-1, 0] = 0
        first = np.arange(1, _FAN + 1)
        self._surface = surface
        self._points = np.concatenate([np.zeros((1, 2)), rim])
        self._faces = np.stack([np.zeros_like(first), first, first + 1], axis=1)
        self._position = surface(self._points)
        self._known = np.empty(0, dtype=np.int64)  # keys of the edges whose bend is known
        self._bend = np.empty(0)

    def split(self, n_vertices: int) -> bool:
        """Halve the worst triangles; False when there is nothing left to do."""
        points = self._points
        edges, of_face = _edges(self._faces)
        middle = _midpoints(points, edges, of_face)
        priority = _propagate(of_face, self._length2(edges), self._error(edges))
        chosen = np.flatnonzero(priority > 0)
        chosen = chosen[np.argsort(-priority[chosen], kind="stable")]
        cost = np.where(middle[chosen, 0] > 0, 2, 1)
        count = 2 * len(points) - np.count_nonzero(points[:, 0] == 0)
        limit = min(n_vertices - count, max(64, int(_GROWTH * count)))
        chosen = chosen[np.cumsum(cost) <= limit]
        if len(chosen) == 0:
            return False
        self._faces = _bisect(self._faces, of_face, chosen, len(points))
        self._points = np.concatenate([points, middle[chosen]])
        self._position = np.concatenate([self._position, self._surface(middle[chosen])])
        return True

    def flip(self) -> None:
        """Swap diagonals where the other one of the two lies closer to the surface."""
        points, faces = self._points, self._faces
        _, of_face = _edges(faces)
        side = np.argsort(of_face.ravel(), kind="stable")
        count = np.bincount(of_face.ravel())
        start = (np.cumsum(count) - count)[count == 2]
        f, g = side[start] // 3, side[start + 1] // 3
        c, a, b = (faces[f, (side[start] + k) % 3] for k in range(3))
        d = faces[g, side[start + 1] % 3]

        whole = _area(points, c, a, b) + _area(points, d, b, a)
        least = np.minimum(_area(points, c, a, d), _area(points, c, d, b))
        quad = np.stack([f, g, a, b, c, d])[:, least > _SLIM * whole]
        f, g, a, b, c, d = quad
        old, new = self._error(np.stack([a, b], 1)), self._error(np.stack([c, d], 1))
        gain = np.where(new < _GAIN * old, old - new, 0.0)
        # A face takes part in one flip only, the one that gains most.
        best = np.zeros(len(faces))
        np.maximum.at(best, f, gain)
        np.maximum.at(best, g, gain)
        quad = quad[:, (gain > 0) & (gain == best[f]) & (gain == best[g])]
        claims = np.bincount(quad[:2].ravel(), minlength=len(faces))
        f, g, a, b, c, d = quad[:, (claims[quad[:2]] == 1).all(axis=0)]
        self._faces = faces.copy()
        self._faces[f] = np.stack([c, a, d], axis=1)
        self._faces[g] = np.stack([c, d, b], axis=1)

    def mirrored(self) -> Template:
        """Join the half and its mirror image."""
        points = self._points
        paired = np.flatnonzero(points[:, 0] > 0)
        twin = np.arange(len(points))
        twin[paired] = len(points) + np.arange(len(paired))
        both = np.concatenate([self._faces, twin[self._faces[:, ::-1]]])
        return Template(points, paired, both.astype(np.int32))

    def _error(self, edges: np.ndarray) -> np.ndarray:
        """How badly each edge `(E, 2)` stands for the surface under it, mm."""
        low, high = edges.min(axis=1), edges.max(axis=1)
        keys = low * (1 << 32) + high
        new = np.flatnonzero(~np.isin(keys, self._known))
        a, b = low[new], high[new]
        lifted = self._surface((self._points[a] + self._points[b]) / 2)
        bend = np.linalg.norm(lifted - (self._position[a] + self._position[b]) / 2, axis=1)
        self._known, first = np.unique(np.append(self._known, keys[new]), return_index=True)
        self._bend = np.append(self._bend, bend)[first]
        return self._bend[np.searchsorted(self._known, keys)] + _SIZE_WEIGHT * self._length2(edges)

    def _length2(self, edges: np.ndarray) -> np.ndarray:
        ends = self._position[edges, :3]
        return ((ends[:, 0] - ends[:, 1]) ** 2).sum(axis=1)


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """List the unique edges `(E, 2)` and, per face, those `(F, 3)` opposite its corners."""
    sides = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2).reshape(-1, 2)
    keys = sides[:, 0] * (1 << 32) + sides[:, 1]
    _, where, index = np.unique(keys, return_index=True, return_inverse=True)
    return sides[where], index.reshape(-1, 3)


def _midpoints(points: np.ndarray, edges: np.ndarray, of_face: np.ndarray) -> np.ndarray:
    """Midpoints of the edges; those of the neck's edge are put back on the rim."""
    middle = points[edges].mean(axis=1)
    rim = (np.bincount(of_face.ravel()) == 1) & (middle[:, 0] > 0)
    middle[rim] /= np.linalg.norm(middle[rim], axis=1, keepdims=True)
    return middle


def _propagate(of_face: np.ndarray, length2: np.ndarray, error: np.ndarray) -> np.ndarray:
    """For each edge that may be split now, the largest error among the faces that wait for it."""
    rows = np.arange(len(of_face))
    longest = of_face[rows, length2[of_face].argmax(axis=1)]
    # The neighbour across the longest edge: the sum of both owners less the face itself.
    owners = np.zeros(len(length2), dtype=np.int64)
    np.add.at(owners, of_face.ravel(), np.repeat(rows, 3))
    shared = np.bincount(of_face.ravel()) == 2
    onward = np.where(shared[longest], owners[longest] - rows, rows)
    settled = longest[onward] == longest
    onward[settled] = rows[settled]
    while not np.array_equal(further := onward[onward], onward):
        onward = further
    priority = np.zeros(len(length2))
    np.maximum.at(priority, longest[onward], error[of_face].max(axis=1))
    return priority


def _bisect(faces: np.ndarray, of_face: np.ndarray, chosen: np.ndarray, first: int) -> np.ndarray:
    """Split the faces on the `chosen` edges, whose midpoints are numbered from `first` on."""
    new_vertex = np.full(of_face.max() + 1, -1)
    new_vertex[chosen] = first + np.arange(len(chosen))
    middle = new_vertex[of_face]
    hit, corner = np.nonzero(middle >= 0)
    m = middle[hit, corner]
    apex, a, b = (faces[hit, (corner + k) % 3] for k in range(3))
    kept = np.delete(faces, hit, axis=0)
    return np.concatenate([kept, np.stack([apex, a, m], 1), np.stack([apex, m, b], 1)])


def _area(p: np.ndarray, i: np.ndarray, j: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Twice the area in the disc, positive for faces seen from outside the head."""
    u, w = p[j] - p[i], p[k] - p[i]
    return u[:, 1] * w[:, 0] - u[:, 0] * w[:, 1]
