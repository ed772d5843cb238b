import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo import angular_errors, without_convexity
from harmface.stereo.cues import Cues, Knowledge, KnownNormals, outline_of
from harmface.stereo.gauge import best_linear, improved, shifted
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.inflation import inflated_normals

RNG = np.random.default_rng(8)


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def relief_matrix(mu, nu, flatten):
    return np.array([[1, 0, mu], [0, 1, nu], [0, 0, flatten]])


def test_the_truth_is_cheaper_than_what_is_near(hills, ball):
    for scene in (hills, ball):
        outline = outline_of(ball.mask) if scene is ball else None
        cues = Cues(scene.b.T, scene.mask, Knowledge(outline))
        truth = cues.cost(np.eye(3))
        for axis in np.eye(3):
            turned = Rotation.from_rotvec(0.3 * axis).as_matrix()
            assert cues.cost(turned) > truth + 10


def test_outline_tells_convex_from_concave(ball):
    cues = Cues(ball.b.T, ball.mask, Knowledge(outline_of(ball.mask)))
    assert cues.cost(np.diag([-1.0, -1, 1])) > cues.cost(np.eye(3)) + 50
    plain = Cues(ball.b.T, ball.mask)
    assert plain.cost(np.diag([-1.0, -1, 1])) == pytest.approx(plain.cost(np.eye(3)))


def test_outward_directions_of_a_disc():
    y, x = np.mgrid[30:-31:-1, -30:31]
    outline = outline_of(np.hypot(x, y) < 25)
    inside = np.flatnonzero(np.hypot(x, y) < 25)
    radial = np.stack([x.ravel()[inside], y.ravel()[inside]], axis=1)[outline.pixels]
    radial = radial / np.linalg.norm(radial, axis=1, keepdims=True)
    assert (np.linalg.norm(radial, axis=1) > 0.9).all()
    # A pixel on a circle of radius 25 subtends 2.3 degrees.
    assert np.degrees(np.arccos((outline.outward * radial).sum(axis=1).clip(-1, 1))).max() < 4


def test_the_border_of_the_picture_is_no_outline():
    assert len(outline_of(np.ones((9, 9), bool)).pixels) == 0


def test_known_normals_undo_a_bas_relief(hills):
    bent = relief_matrix(0.3, -0.2, 0.6) @ hills.b.T
    pixels = np.array([105, 700, 1310, 421])
    known = KnownNormals(pixels, hills.normals[pixels])
    rows = best_linear(Cues(bent, hills.mask, Knowledge(normals=known)), [np.eye(3)])
    assert angular_errors(unit((rows @ bent).T), hills.normals).mean() < 2


def test_equal_lights_undo_a_bas_relief(hills, single_lights):
    bend = relief_matrix(0.3, -0.2, 0.6)
    sources = single_lights @ np.linalg.inv(bend)
    cues = Cues(bend @ hills.b.T, hills.mask, lights=sources)
    rows = best_linear(cues, [np.eye(3)])
    normals = unit((rows @ bend @ hills.b.T).T)
    assert angular_errors(without_convexity(normals, hills.normals), hills.normals).mean() < 1


def test_symmetry_undoes_a_slant(ball):
    size = ball.mask.shape[0]
    index = np.full(ball.mask.shape, -1)
    index[ball.mask] = np.arange(len(ball.b))
    mirrored = index[:, ::-1][ball.mask]
    y, x = np.mgrid[1 : -1 : size * 1j, -1 : 1 : size * 1j] * 1.05
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    sphere = np.stack([x, y, z], axis=-1)[ball.mask]
    cues = Cues(sphere.T, ball.mask, Knowledge(mirrored=mirrored))
    slanted = relief_matrix(0.3, 0.0, 1.0)
    plain = Cues(sphere.T, ball.mask)
    gain = cues.cost(slanted) - cues.cost(np.eye(3))
    assert gain > plain.cost(slanted) - plain.cost(np.eye(3)) + 50


def test_no_component_gains_by_vanishing(ball):
    index = np.full(ball.mask.shape, -1)
    index[ball.mask] = np.arange(len(ball.b))
    cues = Cues(ball.b.T, ball.mask, Knowledge(mirrored=index[:, ::-1][ball.mask]))
    plain = Cues(ball.b.T, ball.mask)
    flat = np.diag([1e-6, 1.0, 1.0])
    assert cues.cost(flat) - plain.cost(flat) == pytest.approx(
        cues.cost(np.eye(3)) - plain.cost(np.eye(3)), rel=0.3
    )


def test_uniform_light_prefers_rotations(ball):
    cues, plain = (Cues(ball.b.T, ball.mask, uniform=share) for share in (0.3, 0.0))
    turned = Rotation.from_rotvec([0.2, -0.5, 0.1]).as_matrix()
    assert cues.cost(turned) == pytest.approx(plain.cost(turned))
    stretched = np.diag([1.0, 1.0, 0.5])
    assert cues.cost(stretched) > plain.cost(stretched) + 10
    slightly = np.diag([1.0, 1.0, 0.95])
    surer = Cues(ball.b.T, ball.mask, uniform=0.3, isometry=0.02)
    assert surer.cost(slightly) > cues.cost(slightly) + 5


def test_many_candidates_cost_what_each_costs(ball, rng):
    rows = rng.standard_normal((70, 3, 3))
    cues = Cues(ball.b.T, ball.mask, Knowledge(outline_of(ball.mask)), lights=rng.random((8, 3)))
    assert np.allclose(cues.costs(rows), [cues.cost(each) for each in rows], rtol=1e-12)


def test_harmonics_that_explain_the_structure_cost_less(ball):
    structure = RNG.standard_normal((9, 9)) @ scaled_normal_images(ball.b, 2)
    rows = np.linalg.lstsq(structure.T, ball.b, rcond=None)[0].T
    cues, plain = (Cues(structure, ball.mask, explain=explain) for explain in (True, False))
    assert cues.cost(rows) == pytest.approx(plain.cost(rows), abs=1e-6)
    wrong = rows + 0.1 * RNG.standard_normal(rows.shape) * np.abs(rows).mean()
    assert cues.cost(wrong) > plain.cost(wrong) + 1


def test_improvement_never_costs_more(hills):
    cues = Cues(hills.b.T, hills.mask)
    start = np.eye(3) + 0.2 * RNG.standard_normal((3, 3))
    assert cues.cost(improved(cues, start, shifted, 9)) < cues.cost(start)


def test_a_disc_blown_up_is_a_hemisphere():
    y, x = np.mgrid[40:-41:-1, -40:41] / 38.0
    mask = x**2 + y**2 < 1
    normals = inflated_normals(mask)
    x, y = x[mask], y[mask]
    truth = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=1)
    error = angular_errors(normals, truth)
    # Zero lies a pixel outside the mask; at the rim that and its steps tell.
    assert np.median(error) < 1.5
    assert error[x**2 + y**2 < 0.8].max() < 4
