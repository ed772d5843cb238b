"""Boxes and what is painted on their walls."""

import numpy as np
import pytest

from data_synth.environments.box import Wall, box
from data_synth.environments.environment import Environment, quadrature
from data_synth.environments.layers import Glow, Lancet, Panes

KEYS = ("-x", "+x", "-y", "+y", "-z", "+z")
LOW, HIGH = (-2.0, -1.0, -3.0), (1.0, 4.0, 2.0)


def flat_box(nodes: int = 6, **layers) -> Environment:
    walls = {
        key: Wall((float(i), 1.0, 2.0), tuple(layers.get(f"w{i}", ())), dusk=0.0)
        for i, key in enumerate(KEYS)
    }
    return box("test", LOW, HIGH, walls, nodes)


def test_axes_see_their_walls() -> None:
    axes = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1.0]])
    np.testing.assert_array_equal(flat_box().radiance(axes)[:, 0], np.arange(6))


def test_rays_end_at_the_nearest_wall() -> None:
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = flat_box().radiance(directions)[:, 0]
    for direction, wall in zip(directions, found, strict=True):
        # March in small steps until outside.
        steps = np.arange(0, 7, 1e-3)[:, None] * direction
        outside = np.flatnonzero(((steps < LOW) | (steps > HIGH)).any(axis=1))[0]
        point = steps[outside]
        crossed = [key for key in range(6) if _beyond(point, key)]
        assert int(wall) in crossed


def _beyond(point: np.ndarray, key: int) -> bool:
    axis, upper = divmod(key, 2)
    return bool(point[axis] > HIGH[axis] if upper else point[axis] < LOW[axis])


def test_the_rule_gives_each_wall_its_solid_angle() -> None:
    environment = flat_box(nodes=10)
    directions, weights = quadrature(environment)
    np.testing.assert_allclose(weights.sum(), 4 * np.pi, rtol=1e-10)
    wall = environment.radiance(directions)[:, 0]

    def corner(s: float, t: float, d: float) -> float:
        return np.arctan(s * t / (d * np.sqrt(s * s + t * t + d * d)))

    # The wall at x = 1 spans y from -1 to 4 and z from -3 to 2.
    exact = sum(corner(s, t, 1.0) for s in (1.0, 4.0) for t in (3.0, 2.0))
    np.testing.assert_allclose(weights[wall == 1.0].sum(), exact, rtol=1e-8)


def test_layers_sit_where_their_coordinates_say() -> None:
    red = np.array([[[9.0, 0.0, 0.0]]])
    pane = Panes((0.5, 1.0), (1.0, 1.0), (1.0, 1.0), red)
    # (s, t) = (0.9, 1.5): across x that is (z, y), across y (x, z), across z (x, y).
    for wall, point in {
        0: (-2, 1.5, 0.9),
        2: (0.9, -1, 1.5),
        3: (0.9, 4, 1.5),
        5: (0.9, 1.5, 2),
    }.items():
        direction = np.array(point) / np.linalg.norm(point)
        painted = flat_box(**{f"w{wall}": [pane]}).radiance(direction)
        np.testing.assert_allclose(painted, [9, 0, 0], atol=1e-15)


def test_edges_are_in_the_dusk() -> None:
    walls = {key: Wall((1.0, 1.0, 1.0), dusk=0.5, reach=0.1) for key in KEYS}
    environment = box("dusk", (-1.0,) * 3, (1.0,) * 3, walls, 6)
    middle, edge, corner = environment.radiance(
        np.array([[0, 0, 1], [0.0, 1 / np.sqrt(2), 1 / np.sqrt(2)], np.ones(3) / np.sqrt(3)])
    )[:, 0]
    # The losses of the far edges, e^-10, are felt in the middle.
    np.testing.assert_allclose([middle, edge, corner], [1.0, 0.5, 0.25], rtol=4 * np.exp(-10))


def test_panes_form_a_grid_with_soft_edges() -> None:
    colours = np.arange(18.0).reshape(2, 3, 3)
    panes = Panes((1.0, 2.0), (0.0, 3.0), (1.0, 2.0), colours, edge=0.2)
    s = np.array([1.5, 3.5, 5.5, 5.5, 2.5, 0.5, 6.5])
    t = np.array([1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.0])
    under = np.full((7, 3), -1.0)
    painted = panes.paint(under, s, t)
    np.testing.assert_allclose(painted[:4], colours[[0, 0, 0, 1], [0, 1, 2, 2]])
    np.testing.assert_array_equal(painted[4:], under[4:])
    # A smoothstep over the edge: 5 / 32 at its first quarter, a half at its middle.
    edge = panes.paint(np.zeros((2, 3)), np.array([1.05, 1.1]), np.ones(2))
    np.testing.assert_allclose(edge, np.array([[5 / 32], [1 / 2]]) * colours[0, 0])


def test_a_glow_is_a_gaussian_added() -> None:
    glow = Glow((1.0, 2.0), (0.5, 0.25), (4.0, 2.0, 1.0))
    painted = glow.paint(np.ones((3, 3)), np.array([1.0, 1.5, 1.0]), np.array([2.0, 2.0, 2.25]))
    fall = np.exp(-0.5)
    np.testing.assert_allclose(painted[:, 0], [5.0, 1 + 4 * fall, 1 + 4 * fall])


def test_a_lancet_is_pointed() -> None:
    glass = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    window = Lancet(2.0, 0.0, 3.0, 1.0, glass, edge=0.01)
    apex = 3.0 + np.sqrt(3.0)
    s = np.array([2.0, 2.0, 2.0, 2.95, 2.95, 3.05, 2.0, 1.0])
    t = np.array([1.0, apex - 0.1, apex + 0.1, 2.0, apex - 0.5, 2.0, -0.1, 2.0])
    cover = window.paint(np.zeros((8, 3)), s, t)[:, 0]
    np.testing.assert_allclose(cover, [1, 1, 0, 1, 0, 0, 0, 0.5], atol=0.01)


@pytest.mark.parametrize(
    ("low", "keys", "complaint"),
    [
        ((-1.0, 0.0, -1.0), KEYS, "low and high must enclose"),
        ((-1.0, -1.0, -1.0), KEYS[:5], "walls must have"),
        ((-1.0, -1.0, -1.0), (), "walls must have"),
    ],
)
def test_boxes_refuse_nonsense(low, keys, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        box("bad", low, (1.0, 1.0, 1.0), {key: Wall((1.0, 1.0, 1.0)) for key in keys}, 4)
