import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.geometry.camera import OrthographicCamera, PerspectiveCamera, pixel_grid
from harmface.geometry.depth_frankot_chellappa import depth_frankot_chellappa
from harmface.geometry.depth_least_squares import depth_least_squares
from harmface.geometry.slopes import facing_camera
from harmface.geometry.surface_mesh import depth_to_mesh, pixel_coordinates

SIZE = 48


def dome(size=SIZE):
    """A smooth relief without symmetry, its normals from exact derivatives."""
    x, y = (axis.reshape(size, size) for axis in pixel_grid((size, size), 1))
    a = 2 * np.pi / size
    z = 4 * np.cos(a * x) * np.cos(2 * a * y) + 0.02 * x * y
    zx = -4 * a * np.sin(a * x) * np.cos(2 * a * y) + 0.02 * y
    zy = -8 * a * np.cos(a * x) * np.sin(2 * a * y) + 0.02 * x
    normals = np.stack([-zx, -zy, np.ones_like(z)], axis=-1)
    return z, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def disc(size=SIZE):
    x, y = (axis.reshape(size, size) for axis in pixel_grid((size, size), 1))
    return np.hypot(x, y) < 0.4 * size


@pytest.mark.parametrize("masked", [False, True])
def test_least_squares_recovers_a_relief(masked):
    z, normals = dome()
    mask = disc() if masked else np.ones_like(z, bool)
    depth = depth_least_squares(normals, mask)
    # The trapezium rule errs by a twelfth of the third derivative a step: 32 (2 pi / 48)^3 / 12
    # = 6e-3, and errors of one sign add up over a quarter of the wave, 6 pixels.
    assert np.abs(depth - (z - z[mask].mean()))[mask].max() < 0.036
    assert (depth[~mask] == 0).all()


def test_frankot_chellappa_recovers_a_relief():
    z, normals = dome()
    depth = depth_frankot_chellappa(normals)
    # Mirror images leave creases at the border, which ring; inside, a tenth of a pixel.
    inner = (slice(8, -8), slice(8, -8))
    error = depth - z
    assert np.abs(error - error[inner].mean())[inner].max() < 0.1 * np.ptp(z) / 2


def test_both_methods_know_up_from_down():
    normal = np.array([0.0, -1.0, 2.0]) / np.sqrt(5)
    normals = np.broadcast_to(normal, (16, 16, 3)).copy()
    for integrate in (depth_least_squares, depth_frankot_chellappa):
        depth = integrate(normals)
        assert depth[0].mean() > depth[-1].mean()


def test_a_camera_gives_its_unit():
    z, normals = dome()
    camera = OrthographicCamera((0.0, 0.0, 9.0), 2.0, z.shape)
    expected = depth_least_squares(normals) * 2.0 / SIZE
    assert np.allclose(depth_least_squares(normals, camera=camera), expected, rtol=0, atol=1e-12)


def sphere_in_perspective(least_gap):
    """A unit sphere seen from 4 away, by the quadratic equation of ray and sphere."""
    camera = PerspectiveCamera((0.0, 0.0, 4.0), 30.0, (64, 64))
    _, rays = camera.rays()
    along = -4.0 * rays[:, 2]
    gap = along**2 - 15.0
    seen = gap > least_gap
    distance = along - np.sqrt(np.maximum(gap, 0))
    points = np.array([0.0, 0, 4]) + distance[:, None] * rays
    normals = np.where(seen[:, None], points, (0.0, 0.0, 1.0)).reshape(64, 64, 3)
    depth = np.where(seen, -distance * rays[:, 2], 0.0).reshape(64, 64)
    return camera, seen.reshape(64, 64), normals, depth


def test_perspective_depth_of_a_sphere():
    camera, mask, normals, truth = sphere_in_perspective(0.1)
    depth = depth_least_squares(normals, mask, camera=camera)
    # Relative: steps of 1 / 119 of the focal length on a unit sphere at a distance of 3.
    assert np.abs(depth[mask] / (truth[mask] / truth[mask].mean()) - 1).max() < 2e-3
    mesh = depth_to_mesh(depth * truth[mask].mean(), mask, camera=camera)
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 1).max() < 3 * 2e-3
    assert np.einsum("ij,ij->i", mesh.normals, mesh.vertices).min() > 0.95


def test_a_perspective_camera_sees_less_of_a_sphere_than_a_parallel_one():
    camera, mask, normals, _ = sphere_in_perspective(0.0)
    assert np.array_equal(facing_camera(normals, mask, camera), mask)
    turned = np.where(mask[..., None], normals - 0.6 * np.array([0, 0, 1]), normals)
    turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
    seen, parallel = facing_camera(turned, mask, camera), facing_camera(turned, mask)
    assert seen.sum() < parallel.sum() < mask.sum()


def test_pixel_coordinates_are_the_centres_of_pixels():
    mask = np.zeros((2, 4), bool)
    mask[0, 1] = mask[1, 3] = True
    assert np.array_equal(pixel_coordinates(mask), [[0.375, 0.75], [0.875, 0.25]])


def test_discontinuities_are_stepped_over():
    height = np.where(np.arange(40) < 20, 0.0, 15.0)
    slope = np.gradient(height)
    normals = np.broadcast_to(
        (np.stack([-slope, 0 * slope, 1 + 0 * slope], -1) / np.hypot(slope, 1)[:, None])[None],
        (20, 40, 3),
    ).copy()
    # Two rows of pixels whose normals are wrong must not bend what lies around them.
    normals[8:10, 10:12] = np.array([0.0, 0.8, 0.6])
    flat = depth_least_squares(normals, discontinuities=True)
    bent = depth_least_squares(normals)
    left = (slice(None), slice(0, 8))
    assert np.ptp(flat[left]) < 0.3 * np.ptp(bent[left])


def test_pixels_without_weight_have_no_say():
    z, normals = dome()
    weights = np.ones_like(z)
    wrong = normals.copy()
    wrong[20:24, 20:24] = (0.6, 0.0, 0.8)
    weights[20:24, 20:24] = 0
    depth = depth_least_squares(wrong, weights=weights)
    right = np.ones_like(z, bool)
    right[19:25, 19:25] = False
    error = depth - z
    assert np.abs(error - error[right].mean())[right].max() < 0.036


def test_mesh_faces_the_viewer_and_keeps_colour():
    z, normals = dome()
    mask = disc()
    albedo = np.linspace(0.2, 2.0, z.size).reshape(z.shape)
    mesh = depth_to_mesh(z, mask, albedo)
    assert len(mesh.vertices) == mask.sum()
    assert (mesh.normals[:, 2] > 0).all()
    assert mesh.albedo.max() == 1
    middle = np.flatnonzero(np.flatnonzero(mask) == SIZE // 2 * SIZE + SIZE // 2)[0]
    assert np.allclose(mesh.vertices[middle], [0.5, -0.5, z[SIZE // 2, SIZE // 2]])
    assert np.degrees(np.arccos(mesh.normals[middle] @ normals[SIZE // 2, SIZE // 2])) < 1


@pytest.mark.parametrize("integrate", [depth_least_squares, depth_frankot_chellappa])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mask": np.zeros((SIZE, SIZE), bool)}, "at least one pixel"),
        ({"mask": np.ones((3, 3), bool)}, "mask must have the size"),
        ({"normals": np.full((SIZE, SIZE, 3), 0.5)}, "unit vectors"),
        ({"normals": np.tile([0.0, 0, -1], (SIZE, SIZE, 1))}, "face the camera"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(integrate, change, message):
    arguments = {"normals": dome()[1], **change}
    with pytest.raises(ArgumentError, match=message):
        integrate(**arguments)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"weights": -np.ones((SIZE, SIZE))}, "must not be negative"),
        ({"weights": np.ones((3, 3))}, "weights must have"),
        ({"camera": OrthographicCamera((0.0, 0.0, 1.0), 1.0, (3, 3))}, "camera must have"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_least_squares_refuses(change, message):
    with pytest.raises(ArgumentError, match=message):
        depth_least_squares(dome()[1], **change)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mask": np.ones((3, 3), bool)}, "mask must have"),
        ({"mask": np.eye(SIZE, dtype=bool)}, "block of 2 x 2"),
        ({"albedo": np.ones((3, 3))}, "albedo must have"),
        ({"albedo": -np.ones((SIZE, SIZE))}, "must not be negative"),
        ({"depth": np.full((SIZE, SIZE), np.nan)}, "finite"),
        ({"camera": PerspectiveCamera((0.0, 0.0, 1.0), 30.0, (SIZE, SIZE))}, "positive distances"),
        ({"camera": PerspectiveCamera((0.0, 0.0, 1.0), 30.0, (3, 3))}, "camera must have"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_mesh_refuses(change, message):
    arguments = {"depth": dome()[0], "mask": np.ones((SIZE, SIZE), bool), **change}
    with pytest.raises(ArgumentError, match=message):
        depth_to_mesh(**arguments)
