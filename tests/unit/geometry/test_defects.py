import numpy as np
import trimesh

from harmface.geometry import Defects, Mesh, mesh_defects


def ball(faces=None):
    """Return a closed mesh of 80 triangles, or of others between its vertices."""
    shape = trimesh.creation.icosphere(1)
    vertices = np.array(shape.vertices)
    faces = np.array(shape.faces if faces is None else faces)
    return Mesh(vertices, faces, vertices.copy(), np.ones_like(vertices))


def test_a_closed_surface_has_none():
    assert mesh_defects(ball()) == Defects(0, 0, 0)


def test_a_missing_triangle_is_a_hole():
    assert mesh_defects(ball(ball().faces[1:])) == Defects(3, 0, 0)


def test_a_face_that_is_turned_over_or_flat_is_counted():
    faces = ball().faces.copy()
    faces[3] = faces[3][::-1]
    turned = mesh_defects(ball(faces))
    assert turned == Defects(0, 0, 1)
    assert mesh_defects(ball(np.vstack([ball().faces, [[0, 0, 1]]]))).degenerate_faces == 1
