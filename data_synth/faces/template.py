"""The fixed triangulation of a head: where its vertices lie in the parameter disc.

The head is a disc pulled over the skull: the centre is the crown, the rim is the neck's open
end, the angle runs round the head from the face (+y of the disc) to the nape. Triangles are
halved where the surface of the mean head bends most until the wanted number of vertices is
reached, so that eyelids, nostrils and ears get small triangles and the back of the skull large
ones. Only the right half is made; the left is its mirror image.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Surface = Callable[[np.ndarray], np.ndarray]

_FAN = 12  # triangles round the crown in the half disc
_SIZE_WEIGHT = 1 / 1600  # 1/mm: a flat edge counts like one of radius 200 mm
_FLIPS = 2  # rounds of edge flips after each round of splits
_GROWTH = 0.2  # a pass splits at most this fraction of the vertices' number


class Template(NamedTuple):
    """A mirror-symmetric triangulation of the disc, built from its right half."""

    points: np.ndarray  # (H, 2) disc coordinates of the right half, x >= 0
    paired: np.ndarray  # (L,) indices of those of the half that have a twin on the left
    faces: np.ndarray  # (F, 3) int32 over the H + L vertices, counter-clockwise from outside


def build_template(n_vertices: int, surface: Surface) -> Template:
    """Triangulate the disc with `n_vertices` vertices, adapted to `surface`.

    Every triangle is only ever halved at its longest edge in space, and only together with the
    triangle on the other side whose longest edge this is too (Rivara's longest-edge propagation
    path), which keeps the mesh conforming and its angles bounded away from zero.

    Parameters
    ----------
    n_vertices
        Vertices of the whole mesh. An odd remainder that no edge of the mid-plane can take up
        leaves the mesh one vertex short.
    surface
        Maps `(N, 2)` disc coordinates with x >= 0 to `(N, 3)` millimetres.
    """
    mesh = _Growing(surface)
    while mesh.split(n_vertices):
        for _ in range(_FLIPS):
            mesh.flip()
    return mesh.mirrored()


def _fan() -> tuple[np.ndarray, np.ndarray]:
    angle = np.linspace(0, np.pi, _FAN + 1)
    rim = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    rim[-1, 0] = 0
    points = np.concatenate([np.zeros((1, 2)), rim])
    first = np.arange(1, _FAN + 1)
    return points, np.stack([np.zeros_like(first), first, first + 1], axis=1)


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unique edges `(E, 2)` and, for each face, the three edges `(F, 3)` opposite its corners."""
    sides = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2).reshape(-1, 2)
    keys = sides[:, 0] * (int(faces.max()) + 1) + sides[:, 1]
    _, where, index = np.unique(keys, return_index=True, return_inverse=True)
    return sides[where], index.reshape(-1, 3)


def _midpoints(points: np.ndarray, edges: np.ndarray, of_face: np.ndarray) -> np.ndarray:
    middle = points[edges].mean(axis=1)
    lonely = np.bincount(of_face.ravel(), minlength=len(edges)) == 1
    rim = lonely & (middle[:, 0] > 0)
    middle[rim] /= np.linalg.norm(middle[rim], axis=1, keepdims=True)
    return middle


def _propagate(of_face: np.ndarray, length2: np.ndarray, error: np.ndarray) -> np.ndarray:
    """For each edge that may be split now, the largest error among the faces that wait for it."""
    rows = np.arange(len(of_face))
    longest = of_face[rows, length2[of_face].argmax(axis=1)]
    # The neighbour across the longest edge: the sum of both owners minus oneself.
    owners = np.zeros(len(length2), dtype=np.int64)
    np.add.at(owners, of_face.ravel(), np.repeat(rows, 3))
    shared = np.bincount(of_face.ravel(), minlength=len(length2)) == 2
    onward = np.where(shared[longest], owners[longest] - rows, rows)
    settled = longest[onward] == longest
    onward[settled] = rows[settled]
    while True:
        further = onward[onward]
        if np.array_equal(further, onward):
            break
        onward = further
    priority = np.zeros(len(length2))
    np.maximum.at(priority, longest[onward], error[of_face].max(axis=1))
    return priority


def _bisect(
    faces: np.ndarray, of_face: np.ndarray, edges: np.ndarray, chosen: np.ndarray, first: int
) -> np.ndarray:
    new_vertex = np.full(len(edges), -1)
    new_vertex[chosen] = first + np.arange(len(chosen))
    middle = new_vertex[of_face]
    hit, corner = np.nonzero(middle >= 0)
    m = middle[hit, corner]
    apex, a, b = (faces[hit, (corner + k) % 3] for k in range(3))
    kept = np.delete(faces, hit, axis=0)
    return np.concatenate([kept, np.stack([apex, a, m], 1), np.stack([apex, m, b], 1)])


def _area(p: np.ndarray, i: np.ndarray, j: np.ndarray, k: np.ndarray) -> np.ndarray:
    # The disc is seen from outside the head with the face below, so that it is turned over.
    u, w = p[j] - p[i], p[k] - p[i]
    return u[:, 1] * w[:, 0] - u[:, 0] * w[:, 1]


class _Growing:
    """A triangulation of the half disc that is being refined."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._points, self._faces = _fan()
        self._position = surface(self._points)
        self._known = np.empty(0, dtype=np.int64)  # keys of the edges whose bend is known
        self._bend = np.empty(0)

    def _error(self, edges: np.ndarray) -> np.ndarray:
        """How badly each edge `(E, 2)` stands for the surface under it, mm."""
        low, high = edges.min(axis=1), edges.max(axis=1)
        keys = low * (1 << 32) + high
        new = np.flatnonzero(~np.isin(keys, self._known))
        if len(new):
            a, b = low[new], high[new]
            lifted = self._surface((self._points[a] + self._points[b]) / 2)
            bend = np.linalg.norm(lifted - (self._position[a] + self._position[b]) / 2, axis=1)
            self._known, first = np.unique(np.append(self._known, keys[new]), return_index=True)
            self._bend = np.append(self._bend, bend)[first]
        length2 = self._length2(edges)
        return self._bend[np.searchsorted(self._known, keys)] + _SIZE_WEIGHT * length2

    def _length2(self, edges: np.ndarray) -> np.ndarray:
        return ((self._position[edges[:, 0], :3] - self._position[edges[:, 1], :3]) ** 2).sum(
            axis=1
        )

    def split(self, n_vertices: int) -> bool:
        points, faces = self._points, self._faces
        edges, of_face = _edges(faces)
        middle = _midpoints(points, edges, of_face)
        priority = _propagate(of_face, self._length2(edges), self._error(edges))
        chosen = np.flatnonzero(priority > 0)
        chosen = chosen[np.argsort(-priority[chosen], kind="stable")]
        cost = np.where(middle[chosen, 0] > 0, 2, 1)
        count = 2 * len(points) - np.count_nonzero(points[:, 0] == 0)
        limit = min(n_vertices - count, max(64, int(_GROWTH * count)))
        chosen = chosen[np.cumsum(cost) <= limit]
        self._faces = _bisect(faces, of_face, edges, chosen, len(points))
        self._points = np.concatenate([points, middle[chosen]])
        self._position = np.concatenate([self._position, self._surface(middle[chosen])])
        return len(chosen) > 0

    def flip(self) -> None:
        """Swap diagonals where the other one of the two lies closer to the surface."""
        points, faces = self._points, self._faces
        edges, of_face = _edges(faces)
        order = np.argsort(of_face.ravel(), kind="stable")
        count = np.bincount(of_face.ravel(), minlength=len(edges))
        first = order[np.cumsum(count) - count]
        second = order[np.cumsum(count) - 1]
        inner = np.flatnonzero(count == 2)
        first, second = first[inner], second[inner]
        f, g = first // 3, second // 3
        c, a, b = (faces[f, (first + k) % 3] for k in range(3))
        d = faces[g, second % 3]
        whole = _area(points, c, a, b) + _area(points, d, b, a)
        slim = np.minimum(_area(points, c, a, d), _area(points, c, d, b))
        ok = np.flatnonzero(slim > 0.05 * whole)
        f, g, a, b, c, d = (i[ok] for i in (f, g, a, b, c, d))
        old, new = self._error(np.stack([a, b], 1)), self._error(np.stack([c, d], 1))
        gain = np.where(new < 0.9 * old, old - new, 0.0)
        best = np.zeros(len(faces))
        np.maximum.at(best, f, gain)
        np.maximum.at(best, g, gain)
        flipped = (gain > 0) & (gain == best[f]) & (gain == best[g])
        f, g, a, b, c, d = (i[flipped] for i in (f, g, a, b, c, d))
        claims = np.bincount(np.concatenate([f, g]), minlength=len(faces))
        alone = (claims[f] == 1) & (claims[g] == 1)
        f, g, a, b, c, d = (i[alone] for i in (f, g, a, b, c, d))
        self._faces = faces.copy()
        self._faces[f] = np.stack([c, a, d], axis=1)
        self._faces[g] = np.stack([c, d, b], axis=1)

    def mirrored(self) -> Template:
        return _mirror(self._points, self._faces)


def _mirror(points: np.ndarray, faces: np.ndarray) -> Template:
    paired = np.flatnonzero(points[:, 0] > 0)
    twin = np.arange(len(points))
    twin[paired] = len(points) + np.arange(len(paired))
    both = np.concatenate([faces, twin[faces[:, ::-1]]])
    return Template(points, paired, both.astype(np.int32))
