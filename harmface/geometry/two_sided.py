"""Surfaces whose faces come twice, once each way round."""

import numpy as np
from jaxtyping import Bool, Float, Integer
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components


def same_places(vertices: Float[np.ndarray, "V 3"]) -> Integer[np.ndarray, "V"]:
    """Return a number for each vertex, from 0 on, the same for vertices at the same place.

    Parameters
    ----------
    vertices
        Positions, any unit.

    Returns
    -------
    numpy.ndarray
        Shape (V,), integers.
    """
    return np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1)


def one_side(
    vertices: Float[np.ndarray, "V 3"],
    faces: Integer[np.ndarray, "F 3"],
    position: Integer[np.ndarray, "V"] | None = None,
) -> tuple[Integer[np.ndarray, "f 3"], Bool[np.ndarray, "F"]]:
    """Return the faces of one side of a surface that is modelled with both.

    A surface that is to be seen from both sides is often stored with each face twice, once each
    way round; normals of its vertices, averaged over both, would cancel. The first of each two
    faces is kept. If what is left then runs both ways, it is made to run one way, outwards where
    it encloses a volume. Other meshes come back as they are.

    Parameters
    ----------
    vertices
        Positions, any unit.
    faces
        Vertex indices of each triangle.
    position
        As `same_places` returns it; found if not given.

    Returns
    -------
    faces
        Those that are kept, some of them turned round.
    kept
        Which of the faces given they are.
    """
    position = same_places(vertices) if position is None else position
    corners = position[faces]
    order = np.sort(corners, axis=1)
    # A face runs as its sorted corners do, or the other way.
    turn = np.argmin(corners, axis=1)
    rows = np.arange(len(corners))
    forwards = corners[rows, (turn + 1) % 3] < corners[rows, (turn + 2) % 3]
    # Numbers sort much faster than rows. Two steps, as the product of three may overflow.
    size = int(corners.max()) + 1
    _, pair = np.unique(order[:, 0] * size + order[:, 1], return_inverse=True)
    keys = pair * size + order[:, 2]
    _, first, group = np.unique(keys, return_index=True, return_inverse=True)
    flat = (order[:, 1:] == order[:, :-1]).any(axis=1)
    kept = flat | (forwards == forwards[first][group])
    if kept.all():
        return faces, kept
    corners, kept_faces = corners[kept], faces[kept]
    edges = corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    if len(np.unique(edges[:, 0] * size + edges[:, 1])) == len(edges):
        return kept_faces, kept
    _, index = np.unique(position, return_index=True)
    turned = _turned(vertices[index], corners)
    return np.where(turned[:, None], kept_faces[:, ::-1], kept_faces), kept


def _turned(
    points: Float[np.ndarray, "P 3"], faces: Integer[np.ndarray, "F 3"]
) -> Bool[np.ndarray, "F"]:
    """Return which faces to turn round, so that neighbours run alike and volumes are positive."""
    count = len(faces)
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, edge, sharing = np.unique(low * len(points) + high, return_inverse=True, return_counts=True)
    order = np.argsort(edge, kind="stable")
    order = order[sharing[edge[order]] == 2]
    one, other = order[::2], order[1::2]
    # Neighbours that run alike take their common edge in opposite directions.
    alike = np.where(edges[one, 0] == edges[other, 0], -1.0, 1.0)
    graph = coo_array((alike, (one // 3, other // 3)), shape=(count + 1, count + 1)).tocsr()
    # One more node is tied to a face of each component, so that one search reaches all.
    _, component = connected_components(graph[:count, :count], directed=False)
    _, first = np.unique(component, return_index=True)
    ties = coo_array((np.ones(len(first)), (np.full(len(first), count), first)), graph.shape)
    graph = (graph + graph.T + ties + ties.T).tocsr()
    _, parent = breadth_first_order(graph, count, directed=False)
    parent[count] = count
    nodes = np.arange(count)
    sign = np.ones(count + 1)
    sign[:count] = np.where(np.asarray(graph[nodes, parent[:count]]) < 0, -1, 1)
    for _ in range(count.bit_length()):
        sign, parent = sign * sign[parent], parent[parent]
    sign = sign[:count]
    corners = points[faces]
    sizes = np.bincount(component)
    middle = np.stack(
        [np.bincount(component, corners.mean(axis=1)[:, k]) for k in range(3)], axis=1
    )
    corners = corners - (middle / sizes[:, None])[component][:, None]
    volume = np.bincount(component, sign * np.linalg.det(corners))
    return sign * np.where(volume < 0, -1, 1)[component] < 0
