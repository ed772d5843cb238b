"""Surfaces whose faces come twice, once each way round."""

import numpy as np
from jaxtyping import Bool, Float, Integer


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
        A number for each vertex, the same for vertices at the same place; found if not given.

    Returns
    -------
    faces
        Those that are kept, some of them turned round.
    kept
        Which of the faces given they are.
    """
    if position is None:
        _, position = np.unique(vertices, axis=0, return_inverse=True)
    places = position.reshape(-1)[faces]
    order = np.sort(places, axis=1)
    # A face runs as its sorted corners do, or the other way.
    turn = np.argmin(places, axis=1)
    rows = np.arange(len(places))
    forwards = places[rows, (turn + 1) % 3] < places[rows, (turn + 2) % 3]
    _, first, group = np.unique(order, axis=0, return_index=True, return_inverse=True)
    group = group.reshape(-1)
    flat = (order[:, 1:] == order[:, :-1]).any(axis=1)
    kept = flat | (forwards == forwards[first][group])
    if kept.all():
        return faces, kept
    places, kept_faces = places[kept], faces[kept]
    edges = places[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    if len(np.unique(edges, axis=0)) == len(edges):
        return kept_faces, kept
    # trimesh is slow to import, and this is rare.
    import trimesh

    _, index = np.unique(position, return_index=True)
    solid = trimesh.Trimesh(vertices[index], places, process=False)
    trimesh.repair.fix_normals(solid)
    turned = np.asarray(solid.faces)[:, 0] != places[:, 0]
    turned |= np.asarray(solid.faces)[:, 1] != places[:, 1]
    return np.where(turned[:, None], kept_faces[:, ::-1], kept_faces), kept
