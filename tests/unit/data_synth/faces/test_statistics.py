"""The population against the lighting statistics of real heads.

Orthographic frontal view of the whole mesh, constant albedo, attached shadows only, one
directional light uniform over the sphere, every visible pixel the same weight, mean image
subtracted.
"""

import numpy as np
import pytest
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from data_synth.faces import head, mean_head

# Eigenvalue fractions of a face [Ramamoorthi 2002, table of measured fractions] and the ranges
# that five real heads span.
PUBLISHED = np.array([0.42, 0.33, 0.16, 0.035, 0.021])
PUBLISHED_TOLERANCE = np.array([0.03, 0.025, 0.025, 0.007, 0.005])
REAL_LOW = np.array([0.421, 0.218, 0.0905, 0.0297, 0.0147])
REAL_HIGH = np.array([0.502, 0.3451, 0.2096, 0.0389, 0.0197])
REAL_SQUARED_NORMAL = np.array([[0.342, 0.150, 0.508], [0.368, 0.151, 0.481]])


def visible_normals(subject, size):
    low, high = subject.vertices.min(axis=0), subject.vertices.max(axis=0)
    centre, half = (low + high)[:2] / 2, (high - low)[:2].max() / 2
    grid = half * (2 * (np.arange(size) + 0.5) / size - 1)
    x, y = (g.ravel() for g in np.meshgrid(centre[0] + grid, centre[1] + grid))
    origin = np.column_stack([x, y, np.full(size**2, 500.0)])
    mesh = trimesh.Trimesh(subject.vertices, subject.faces, process=False)
    down = np.broadcast_to([0.0, 0.0, -1.0], origin.shape)
    triangle = RayMeshIntersector(mesh).intersects_first(origin, down)
    faces = subject.faces[triangle[triangle >= 0]]
    a, b, c = np.moveaxis(subject.vertices[faces, :2], 1, 0)
    p = origin[triangle >= 0, :2]
    cross = lambda u, v: u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]  # noqa: E731
    whole = cross(b - a, c - a)
    weights = np.column_stack([cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)])
    normal = np.einsum("nk,nkd->nd", weights / whole[:, None], subject.normals[faces])
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def fractions(normals, n_lights=500):
    """Eigenvalue fractions of the images under lights evenly spread over the sphere."""
    k = np.arange(n_lights) + 0.5
    z = 1 - 2 * k / n_lights
    angle = np.pi * (1 + np.sqrt(5)) * k
    r = np.sqrt(1 - z * z)
    lights = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    images = np.maximum(lights @ normals.T, 0.0)
    images -= images.mean(axis=0)
    values = np.linalg.eigvalsh(images @ images.T)[::-1]
    return values / values.sum()


@pytest.fixture(scope="module")
def mean_normals():
    return visible_normals(mean_head(20_000), 160)


def test_mean_face_has_the_published_fractions(mean_normals):
    found = fractions(mean_normals, 1_000)
    assert (np.abs(found[:5] - PUBLISHED) <= PUBLISHED_TOLERANCE).all(), found[:5]
    assert found[:3].sum() == pytest.approx(0.91, abs=0.012)
    assert found[:5].sum() == pytest.approx(0.97, abs=0.012)


def test_mean_face_has_the_squared_normals_of_real_heads(mean_normals):
    found = (mean_normals**2).mean(axis=0)
    assert (np.abs(found - REAL_SQUARED_NORMAL).min(axis=0) < 0.04).all(), found


def test_population_spans_the_fractions_of_real_heads():
    found = np.array([fractions(visible_normals(head(s, n_vertices=5_000), 64), 300)[:5]
                      for s in range(40)])  # fmt: skip
    mean = found.mean(axis=0)
    assert ((mean > 0.9 * REAL_LOW) & (mean < 1.1 * REAL_HIGH)).all(), mean
    # 0.012 is wanted of the spread over 200 subjects; 40 leave it uncertain by 11 %.
    assert found[:, 0].std() > 0.012 * (1 - 2 * 0.11)
