import numpy as np
import pytest

from data_synth.shapes import ellipsoid, torus
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, one_side, vertex_normals

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
FACE = np.array([[0, 1, 2]])
UP = np.tile([0.0, 0, 1], (3, 1))
WHITE = np.ones((3, 3))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"faces": np.empty((0, 3), int)}, "at least one triangle"),
        ({"faces": FACE + 1}, "index 3 vertices"),
        ({"faces": FACE - 1}, "index 3 vertices"),
        ({"vertices": TRIANGLE * np.nan}, "vertices must be finite"),
        ({"normals": UP * 1.01}, "unit vectors"),
        ({"albedo": WHITE * 255}, "divide 8-bit colours by 255"),
        ({"albedo": -WHITE}, "must not be negative"),
        ({"faces": FACE[..., :0]}, r"faces must have shape \(F, 3\), got \(1, 0\)"),
        ({"faces": FACE[0]}, r"faces must have shape \(F, 3\), got \(3,\)"),
        ({"faces": None}, r"faces must have shape \(F, 3\), got \(\)"),
        ({"vertices": 1.0}, r"vertices must have shape \(..., 3\), got \(\)"),
        ({"vertices": TRIANGLE[None]}, r"vertices must have shape \(V, 3\)"),
        ({"normals": UP[:2]}, r"normals must have shape \(V, 3\) for all V vertices, got \(2, 3\)"),
        ({"albedo": WHITE[:, :1]}, r"albedo must have shape \(V, 3\) .*, got \(3, 1\)"),
        ({"albedo": WHITE[:0]}, r"albedo must have shape \(V, 3\) .*, got \(0, 3\)"),
    ],
)
def test_nonsense_is_refused(unchecked, change, message):
    arrays = {"vertices": TRIANGLE, "faces": FACE, "normals": UP, "albedo": WHITE, **change}
    with pytest.raises(ArgumentError, match=message):
        Mesh(**arrays)


def test_normals_of_no_mesh_are_refused(unchecked):
    for vertices, faces, message in (
        (1.0, FACE, "vertices must have shape"),
        (TRIANGLE[:, :0], FACE, "vertices must have shape"),
        (TRIANGLE, FACE[None], r"faces must have shape \(F, 3\)"),
        (TRIANGLE, "x", r"faces must have shape \(F, 3\)"),
    ):
        with pytest.raises(ArgumentError, match=message):
            vertex_normals(vertices, faces)


def test_bounds_ignore_vertices_without_a_face():
    vertices = np.concatenate([TRIANGLE, [[9.0, 9, 9]]])
    mesh = Mesh(vertices, FACE, np.tile([0.0, 0, 1], (4, 1)), np.ones((4, 3)))
    assert np.array_equal(mesh.bounds, [[0, 0, 0], [1, 1, 0]])


def test_rotation_turns_positions_and_normals():
    quarter = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    turned = Mesh(TRIANGLE, FACE, UP, WHITE).rotated(quarter)
    assert np.allclose(turned.normals, [1, 0, 0])
    assert np.allclose(turned.vertices[1], [0, 0, -1])


def test_a_reflection_is_no_rotation():
    with pytest.raises(ArgumentError, match="reflection"):
        Mesh(TRIANGLE, FACE, UP, WHITE).rotated(np.diag([1.0, 1, -1]))


@pytest.mark.parametrize("shape", [ellipsoid(), torus()], ids=lambda shape: shape.name)
def test_vertex_normals_approach_the_analytic_ones(shape):
    normals = vertex_normals(shape.vertices, shape.faces)
    angle = np.degrees(np.arccos(np.clip(np.sum(normals * shape.normals, axis=1), -1, 1)))
    # Second order in the edge length, about a degree and a half of arc on these meshes.
    assert np.median(angle) < 0.5


def test_a_soup_of_triangles_is_as_smooth_as_the_mesh_it_came_from():
    shape = ellipsoid()
    soup = shape.vertices[shape.faces].reshape(-1, 3)
    faces = np.arange(len(soup)).reshape(-1, 3)
    expected = vertex_normals(shape.vertices, shape.faces)[shape.faces].reshape(-1, 3)
    assert np.allclose(vertex_normals(soup, faces), expected, atol=1e-12)


def test_normals_do_not_depend_on_how_a_square_is_cut():
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, -1], [0, 1, -1]])
    side = [[0, 4, 5], [0, 5, 3]]
    one = vertex_normals(corner, np.array([[0, 1, 2], [0, 2, 3], *side]))
    other = vertex_normals(corner, np.array([[0, 1, 3], [1, 2, 3], *side]))
    assert np.allclose(one[0], other[0], atol=1e-12)
    assert not np.allclose(one[0], [0, 0, 1])


def test_a_degenerate_face_leaves_a_usable_normal():
    assert np.array_equal(vertex_normals(TRIANGLE * 0, FACE), UP)


@pytest.mark.parametrize("order", ["one after the other", "one side first", "at random"])
def test_of_faces_that_come_twice_both_ways_one_counts(order, rng):
    shape = ellipsoid()
    faces = np.concatenate([shape.faces, shape.faces[:, ::-1]])
    if order == "one after the other":
        faces = faces.reshape(2, -1, 3).swapaxes(0, 1).reshape(-1, 3)
    elif order == "at random":
        faces = rng.permutation(faces)[:, [1, 2, 0]]
    expected = vertex_normals(shape.vertices, shape.faces)
    assert np.allclose(vertex_normals(shape.vertices, faces), expected, atol=1e-12)
    kept, which = one_side(shape.vertices, faces)
    assert len(kept) == which.sum() == len(shape.faces)


def test_a_sheet_with_two_sides_and_vertices_for_each_keeps_the_first():
    vertices = np.concatenate([TRIANGLE, TRIANGLE])
    faces = np.array([[0, 1, 2], [5, 4, 3]])
    assert np.allclose(vertex_normals(vertices, faces), [0, 0, 1])
    assert np.allclose(vertex_normals(vertices, faces[::-1]), [0, 0, -1])


def test_a_mesh_with_one_side_is_left_as_it_is():
    shape = torus()
    flat = np.concatenate([shape.faces, [[0, 0, 1]]])
    kept, which = one_side(shape.vertices, flat)
    assert kept is flat
    assert which.all()


def test_faces_that_cancel_to_rounding_leave_a_usable_normal():
    # A tent folded flat: its two sides face each other, but share only an edge.
    vertices = np.array([[0.0, 0, 0], [1, 0.3, 0.1], [0, 1, 0], [0, 1, 1e-17]])
    normals = vertex_normals(vertices * 0.7, np.array([[0, 1, 2], [0, 3, 1]]))
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)
    assert np.array_equal(normals[:2], UP[:2])
