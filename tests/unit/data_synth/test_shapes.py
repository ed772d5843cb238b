"""Shapes against their equations: closed forms, areas, volumes, finite differences."""

import numpy as np
import pytest

from data_synth.shapes import (
    SHAPES,
    TEXTURES,
    Shape,
    bumpy_sphere,
    cone,
    cylinder,
    ellipsoid,
    half_sphere,
    height_field,
    hills,
    ripples,
    sphere,
    superquadric,
    textured,
    torus,
    vase,
)

CLOSED = [sphere, ellipsoid, cylinder, cone, superquadric, torus, vase, bumpy_sphere]
ALL = [*CLOSED, half_sphere, ripples, hills]


def face_vectors(shape: Shape) -> np.ndarray:
    """Twice the area of each face along its normal, (F, 3)."""
    a, b, c = np.moveaxis(shape.vertices[shape.faces], 1, 0)
    return np.cross(b - a, c - a)


def volume(shape: Shape) -> float:
    return (shape.vertices[shape.faces[:, 0]] * face_vectors(shape)).sum() / 6


def merged_faces(shape: Shape) -> np.ndarray:
    """Faces over positions, the doubles of seams and creases made one."""
    _, index = np.unique(shape.vertices.round(12), axis=0, return_inverse=True)
    return index.reshape(-1)[shape.faces]


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_sound(name: str) -> None:
    shape = SHAPES[name]()
    count = len(shape.vertices)
    assert shape.name == name
    assert shape.faces.dtype == np.int32
    assert np.array_equal(np.unique(shape.faces), np.arange(count))
    # A sum of three squares and a root: a few roundings.
    assert np.abs(np.linalg.norm(shape.normals, axis=1) - 1).max() < 8 * np.finfo(float).eps
    assert shape.uvs.shape == (count, 2)
    assert shape.uvs.min() >= 0
    assert shape.uvs.max() <= 1
    assert shape.albedo.shape == (count, 3)
    assert shape.albedo.min() >= 0
    assert shape.albedo.max() <= 1
    extent = np.ptp(shape.vertices, axis=0).max()
    assert 1.2 < extent < 2.8


@pytest.mark.parametrize("build", ALL)
def test_faces_look_outward_along_their_normals_and_none_is_degenerate(build) -> None:
    shape = build(resolution=40)
    vectors = face_vectors(shape)
    areas = np.linalg.norm(vectors, axis=1)
    # A step of 1/40 of a turn in both directions; the smallest are at poles and in the lip.
    assert areas.min() > 1e-6
    cosines = (vectors[:, None] * shape.normals[shape.faces]).sum(axis=2) / areas[:, None]
    assert cosines.min() > 0.9


@pytest.mark.parametrize("build", CLOSED)
def test_closed_shapes_are_closed(build) -> None:
    faces = merged_faces(build(resolution=16))
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward = {tuple(edge) for edge in edges}
    assert len(forward) == len(edges)
    assert forward == {(b, a) for a, b in forward}


def vase_volume() -> float:
    """The solid of revolution, by fine midpoint sums over its profile."""
    series, order = np.array([0.46, 0.08, -0.1, -0.12]), np.pi * np.arange(4)
    s = (np.arange(20000) + 0.5) / 20000
    outer = (np.cos(np.outer(s, order)) @ series) ** 2
    start = 0.06 / 1.8
    t = start + s * (1 - start)
    inner = (np.cos(np.outer(t, order)) @ series - 0.06) ** 2
    rim, tube = 0.46 - 0.08 - 0.1 + 0.12 - 0.03, 0.03
    lip = np.pi**2 * tube**2 * rim  # Pappus: half a disc around the axis
    return np.pi * 1.8 * (outer.mean() - (1 - start) * inner.mean()) + lip


@pytest.mark.parametrize(
    ("build", "exact"),
    [
        (sphere, 4 / 3 * np.pi),
        (ellipsoid, 4 / 3 * np.pi * 0.7 * 0.85),
        (cylinder, np.pi * 0.55**2 * 1.6),
        (cone, np.pi * 0.75**2 * 1.6 / 3),
        (torus, 2 * np.pi**2 * 0.68 * 0.3**2),
        (vase, vase_volume()),
    ],
)
def test_volumes_converge_to_the_exact_ones(build, exact: float) -> None:
    errors = np.array([abs(volume(build(resolution=n)) - exact) / exact for n in (32, 64)])
    # Inscribed polyhedra: second order in the step.
    assert errors[1] < 0.005
    assert 3.5 < errors[0] / errors[1] < 4.5


def test_superquadric_of_exponents_one_is_the_ellipsoid() -> None:
    axes = (0.7, 1.0, 0.85)
    box, egg = superquadric(16, (1.0, 1.0), axes), ellipsoid(16, axes)
    eps = np.finfo(float).eps
    np.testing.assert_allclose(box.vertices, egg.vertices, atol=8 * eps)
    np.testing.assert_allclose(box.normals, egg.normals, atol=8 * eps)


@pytest.mark.parametrize("exponents", [(0.4, 0.4), (1.6, 0.5), (0.5, 1.6)])
def test_superquadric_lies_on_its_equation(exponents: tuple[float, float]) -> None:
    profile, section = exponents
    x, y, z = np.abs(
        superquadric(24, exponents, (0.6, 0.9, 0.75)).vertices.T / [[0.6], [0.9], [0.75]]
    )
    inside = (x ** (2 / section) + z ** (2 / section)) ** (section / profile) + y ** (2 / profile)
    # Powers up to 2 / 0.4 = 5 of values known to eps.
    np.testing.assert_allclose(inside, 1.0, rtol=40 * np.finfo(float).eps)


@pytest.mark.parametrize(
    "build",
    [
        bumpy_sphere,
        lambda resolution: superquadric(resolution, (0.8, 0.6)),
        torus,
        vase,
        ripples,
        hills,
    ],
)
def test_normals_are_the_limit_of_the_faces(build) -> None:
    def distance(resolution: int) -> float:
        shape = build(resolution=resolution)
        vectors = face_vectors(shape)
        flat = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
        mean = shape.normals[shape.faces].mean(axis=1)
        return np.linalg.norm(flat - mean, axis=1).mean()

    # A face's slope is that of its edges' middles, not of its centroid: first order in the step.
    coarse, fine = distance(40), distance(80)
    assert fine < 0.03
    assert coarse / fine > 1.9


def test_half_sphere_faces_the_viewer() -> None:
    shape = half_sphere(16)
    assert shape.vertices[:, 2].min() == 0.0
    np.testing.assert_allclose(shape.vertices, shape.normals, atol=4 * np.finfo(float).eps)


def test_cone_normals_lean_by_its_slope() -> None:
    shape = cone(16, radius=0.75, height=1.6)
    side = shape.normals[shape.normals[:, 1] > -0.5]
    np.testing.assert_allclose(side[:, 1], 0.75 / np.hypot(0.75, 1.6), rtol=1e-14)


def test_height_field_takes_any_surface() -> None:
    shape = height_field("tilt", lambda x, y: (0.5 * x, np.full_like(x, 0.5), 0.0 * y), 8)
    np.testing.assert_allclose(shape.vertices[:, 2], 0.5 * shape.vertices[:, 0])
    np.testing.assert_allclose(shape.normals, np.tile([-1, 0, 2] / np.sqrt(5), (81, 1)))


@pytest.mark.parametrize(("build", "resolution"), [(ripples, 400), (hills, 200)])
def test_height_fields_have_the_slopes_of_their_heights(build, resolution: int) -> None:
    shape = build(resolution)
    step, side = 2 / resolution, (resolution + 1, resolution + 1)
    heights = shape.vertices[:, 2].reshape(side)
    nx, ny, nz = (field.reshape(side)[1:-1, 1:-1] for field in shape.normals.T)
    by_x = (heights[1:-1, 2:] - heights[1:-1, :-2]) / (2 * step)
    by_y = (heights[2:, 1:-1] - heights[:-2, 1:-1]) / (2 * step)
    # Central differences err by step^2 / 6 times the third derivative, here below 200.
    assert np.abs(by_x + nx / nz).max() < 200 * step**2 / 6
    assert np.abs(by_y + ny / nz).max() < 200 * step**2 / 6


@pytest.mark.parametrize("kind", TEXTURES)
def test_textures_differ_in_colour_and_only_in_albedo(kind: str) -> None:
    plain = sphere(32)
    painted, again = textured(plain, kind, 4), textured(plain, kind, np.random.default_rng(4))
    assert painted.vertices is plain.vertices
    assert painted.albedo.tobytes() == again.albedo.tobytes()
    assert not np.array_equal(painted.albedo, textured(plain, kind, 5).albedo)
    assert (np.ptp(painted.albedo, axis=0) > 0.15).all()


@pytest.mark.parametrize("build", [bumpy_sphere, hills])
def test_random_shapes_follow_their_seed(build) -> None:
    assert build(16, rng=3).vertices.tobytes() == build(16, rng=3).vertices.tobytes()
    assert not np.array_equal(build(16, rng=3).vertices, build(16, rng=4).vertices)


@pytest.mark.parametrize(
    ("call", "complaint"),
    [
        *((lambda build=build: build(resolution=7), "resolution must be") for build in ALL),
        (lambda: sphere(radius=0.0), "radius must be"),
        (lambda: ellipsoid(semi_axes=(1.0, -1.0, 1.0)), "semi_axes must be"),
        (lambda: superquadric(semi_axes=(1.0, np.nan, 1.0)), "semi_axes must be"),
        (lambda: superquadric(exponents=(1.0, 2.0)), "exponents must be"),
        (lambda: bumpy_sphere(amplitude=0.3), "amplitude must be"),
        (lambda: bumpy_sphere(amplitude=0.0), "amplitude must be"),
        (lambda: bumpy_sphere(waves=0), "waves must be"),
        (lambda: cylinder(height=np.inf), "radius and height must be"),
        (lambda: cone(radius=-1.0), "radius and height must be"),
        (lambda: half_sphere(radius=0.0), "radius must be"),
        (lambda: torus(tube=0.0), "radius and tube must be"),
        (lambda: torus(radius=0.3, tube=0.4), "tube must be smaller"),
        (lambda: vase(height=0.0), "height must be"),
        (lambda: vase(wall=0.3), "wall must be"),
        (lambda: hills(count=0), "count must be"),
        (lambda: height_field("hole", lambda x, y: (x / 0 * y, x, y), 8), "height must return"),
        (lambda: textured(sphere(8), "tartan"), "kind must be one of"),
    ],
)
def test_shapes_refuse_nonsense(call, complaint: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(ValueError, match=complaint):
        call()
