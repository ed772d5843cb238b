import numpy as np
import pytest

from data_synth.shapes import sphere
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, visible
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import random_directions


def test_a_convex_body_casts_no_shadow_on_itself(rng):
    ball = mesh_of(sphere())
    directions = random_directions(50, rng)
    points = ball.vertices[::7]
    normals = ball.normals[::7]
    lit = visible(ball, points, normals, directions)
    cosines = directions @ normals.T
    # Facets stand in front of the sphere's tangent plane by half the angle of an edge.
    assert lit[cosines > 0.05].all()
    assert not lit[cosines < 0].any()


def test_a_wall_shadows_the_floor_exactly_where_geometry_says():
    # A floor z = 0 and a wall of height 1 at x = 0 that faces +x and -x.
    vertices = np.array(
        [
            [-5.0, -5, 0],
            [5, -5, 0],
            [5, 5, 0],
            [-5, 5, 0],
            [0, -5, 0],
            [0, 5, 0],
            [0, 5, 1],
            [0, -5, 1],
        ]
    )
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    normals = np.tile([0.0, 0, 1], (8, 1))
    mesh = Mesh(vertices, faces, normals, np.ones((8, 3)))
    x = np.linspace(0.05, 3, 60)
    points = np.stack([x, np.zeros(60), np.zeros(60)], axis=1)
    slope = np.radians(30)
    light = np.array([[-np.cos(slope), 0, np.sin(slope)]])
    lit = visible(mesh, points, np.tile([0.0, 0, 1], (60, 1)), light)[0]
    reach = 1 / np.tan(slope)
    assert not lit[x < reach - 0.03].any()
    assert lit[x > reach + 0.03].all()


@pytest.mark.usefixtures("unchecked")
def test_points_and_normals_must_match():
    ball = mesh_of(sphere())
    with pytest.raises(ArgumentError, match="normals must match points"):
        visible(ball, ball.vertices[:3], ball.normals[:2], np.array([[0.0, 0, 1]]))


def test_directions_must_be_unit_vectors():
    ball = mesh_of(sphere())
    with pytest.raises(ArgumentError, match="directions must be unit"):
        visible(ball, ball.vertices[:2], ball.normals[:2], np.array([[0.0, 0, 2]]))
