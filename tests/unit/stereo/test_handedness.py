import numpy as np

from harmface.stereo import seems_upside_down


def test_a_surface_is_told_from_one_upside_down(hills, ball):
    for scene in (hills, ball):
        normals = scene.pictures(scene.normals.T).transpose(1, 2, 0)
        assert not seems_upside_down(normals, scene.mask)
        assert seems_upside_down(normals * (1, -1, 1), scene.mask)
        assert seems_upside_down(normals * (-1, 1, 1), scene.mask)
        assert not seems_upside_down(normals * (-1, -1, 1), scene.mask)


def test_nothing_is_said_of_what_looks_the_same_either_way(rng):
    x = np.linspace(-0.6, 0.6, 30) * np.ones((30, 1))
    cylinder = np.stack([x, 0 * x, np.sqrt(1 - x**2)], axis=-1)
    mask = np.ones(x.shape, bool)
    assert not seems_upside_down(cylinder, mask)
    assert not seems_upside_down(cylinder, np.zeros_like(mask))
    for _ in range(8):
        noise = rng.standard_normal((30, 30, 3)) + np.array([0, 0, 4])
        noise /= np.linalg.norm(noise, axis=-1, keepdims=True)
        assert not seems_upside_down(noise, mask)
