import numpy as np
import pytest

from harmface.enrollment import surfaces
from harmface.enrollment.shading import SlopeEquations
from harmface.enrollment.surfaces import Grid, depths_near_generic

SHAPE = (24, 20)


def slope_error(depth, hill):
    """Root mean square within the rim, where differences are central."""
    found = Grid(SHAPE).slopes(depth.ravel()).reshape(2, *SHAPE)
    return np.sqrt(((found - hill.slopes)[:, 1:-1, 1:-1] ** 2).mean())


def test_slopes_are_those_of_a_plane():
    x, y = np.arange(5.0), -np.arange(4.0)[:, None]
    assert np.allclose(Grid((4, 5)).slopes((2 * x - 3 * y).ravel()), [[-2] * 20, [3] * 20])


def test_roughness_sums_the_squared_steps(rng):
    z = rng.random((4, 5))
    expected = (np.diff(z, axis=0) ** 2).sum() + (np.diff(z, axis=1) ** 2).sum()
    assert np.isclose(z.ravel() @ Grid((4, 5)).roughness @ z.ravel(), expected)


def test_depth_minimises_misfit_and_departure_together(rng):
    grid, m = Grid((4, 5)), 20
    factor = rng.random((m, 2, 3))
    matrix = np.moveaxis(factor @ factor.swapaxes(1, 2), 0, 2)
    equations, near = SlopeEquations(matrix, rng.random((2, m))), rng.random(m)

    def energy(z):
        s, away = grid.slopes(z), z - near
        fit = np.einsum("im,ijm,jm->", s, matrix, s) - 2 * (equations.right * s).sum()
        return fit + 0.5 * away @ grid.roughness @ away

    found = grid.depth(equations, near, 0.5)
    for step in 1e-3 * rng.standard_normal((20, m)):
        assert energy(found + step) > energy(found)


def test_light_from_all_around_gives_the_surface(hill, around):
    hills = [hill(knob) for knob in (0.5, 1.5)]
    lights = around(35.0)
    depths, bright = depths_near_generic([each.images(lights) for each in hills], [lights] * 2)
    for each, depth, g in zip(hills, depths, bright, strict=True):
        # Differences of a knob three pixels wide are off by a twentieth of its slope, and the
        # generic surface draws a little.
        assert slope_error(depth, each) < 0.03
        assert np.allclose(g, each.albedo * each.normals[..., 2], rtol=0.05)


def test_noisy_frontal_photographs_gain_from_the_other_subjects(hill, around, rng, monkeypatch):
    hills = [hill(knob, seed) for seed, knob in enumerate(np.linspace(0.5, 1.5, 8))]
    lights = around(10.0)
    taken = [each.images(lights) for each in hills]
    noisy = [images + 0.02 * rng.standard_normal(images.shape) for images in taken]
    noisy = [np.maximum(images, 0) for images in noisy]

    def error():
        depths, _ = depths_near_generic(noisy, [lights] * len(hills))
        return np.mean([slope_error(z, each) for z, each in zip(depths, hills, strict=True)])

    together = error()
    monkeypatch.setattr(surfaces, "DEPARTURE", surfaces.FLATNESS)
    assert together < error() / 2


def test_a_highlight_is_seen_through_in_turn(hill, around, monkeypatch):
    lights = around(12.0)
    images = hill(1.0).images(lights)
    images[3, 6:9, 6:9] += 0.5

    def error():
        return slope_error(depths_near_generic([images], [lights])[0][0], hill(1.0))

    settled = error()
    monkeypatch.setattr(surfaces, "ROUNDS", 1)
    assert settled < error() / 2


def test_one_frontal_photograph_each_is_a_flat_surface(hill):
    front = np.array([[0.0, 0.0, 1.0]])
    depths, bright = depths_near_generic([hill(1.0).images(front)], [front])
    assert np.ptp(depths) < 1e-6
    # All of the brightness is albedo then.
    assert np.allclose(bright[0], hill(1.0).images(front)[0], rtol=1e-4)


@pytest.mark.parametrize("behind", [110.0, 130.0])
def test_light_from_behind_does_not_upset_the_others(hill, around, behind):
    turned = np.radians(behind)
    lights = np.concatenate([around(35.0), [[np.sin(turned), 0.0, np.cos(turned)]]])
    depths, _ = depths_near_generic([hill(1.0).images(lights)], [lights])
    assert slope_error(depths[0], hill(1.0)) < 0.04
