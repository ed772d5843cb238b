import numpy as np
import pytest
import pyvista
import trimesh

from data_synth.faces import head
from harmface.geometry import Mesh, vertex_normals
from harmface.reproduce.synthetic import mesh_of

FIELDS = ("vertices", "faces", "normals", "albedo")


@pytest.mark.parametrize("through", ["trimesh", "pyvista"])
def test_there_and_back_nothing_changes(through):
    mesh = mesh_of(head(1, n_vertices=5000))
    there = getattr(mesh, f"to_{through}")()
    back = getattr(Mesh, f"from_{through}")(there)
    for name in FIELDS:
        assert np.array_equal(getattr(back, name), getattr(mesh, name)), name


@pytest.mark.parametrize("through", ["trimesh", "pyvista"])
def test_vertices_at_one_place_stay_apart(through):
    seam = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    mesh = Mesh(seam, faces, vertex_normals(seam, faces), np.full((6, 3), 0.3))
    back = getattr(Mesh, f"from_{through}")(getattr(mesh, f"to_{through}")())
    assert np.array_equal(back.vertices, seam)


def test_vertex_colours_of_others_are_albedo():
    box = trimesh.creation.box()
    box.visual.vertex_colors = np.tile([51, 102, 255, 255], (8, 1)).astype(np.uint8)
    assert Mesh.from_trimesh(box).albedo[0] == pytest.approx([0.2, 0.4, 1.0])
    sphere = pyvista.Sphere(theta_resolution=8, phi_resolution=8)
    sphere.point_data["RGB"] = np.full((sphere.n_points, 3), 102, np.uint8)
    assert Mesh.from_pyvista(sphere).albedo[0] == pytest.approx([0.4] * 3)


def test_without_colours_or_normals_both_are_filled_in():
    quads = pyvista.Plane(i_resolution=2, j_resolution=2)
    quads.clear_data()
    mesh = Mesh.from_pyvista(quads)
    assert mesh.faces.shape == (8, 3)
    assert np.array_equal(np.abs(mesh.normals), np.tile([0.0, 0, 1], (9, 1)))
    assert np.array_equal(mesh.albedo, np.ones((9, 3)))


def test_normals_of_others_are_made_unit():
    sphere = pyvista.Sphere(theta_resolution=8, phi_resolution=8)
    sphere.point_data["Normals"] = 3 * sphere.point_data["Normals"]
    lengths = np.linalg.norm(Mesh.from_pyvista(sphere).normals, axis=1)
    assert lengths == pytest.approx(1, abs=1e-7)
