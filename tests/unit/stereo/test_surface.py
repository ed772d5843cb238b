"""One surface for all pixels, on reliefs of which everything is known."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from harmface.errors import ArgumentError
from harmface.sphere import fibonacci_directions
from harmface.stereo import surface
from harmface.stereo.evaluation import angular_errors
from harmface.stereo.light_models import PointLights
from harmface.stereo.per_pixel import fit_normals
from harmface.stereo.surface import GIVE, fit_integrable

MODEL = PointLights(1, ambient=False)
SIZE = 32
CAUCHY = 2.385


def front(count):
    """Lights within 60 degrees of the viewer; each leaves some of the relief in shadow."""
    directions = fibonacci_directions(8 * count)
    return directions[np.argsort(-directions[:, 2])][: 2 * count : 2]


class Relief:
    """z = 3 (sin(x / 5) + cos(y / 4) + x y / 150), and a flank of one half where x > 0 if stepped.

    The flank ends in a jump that grows upwards, so no continuous surface has its normals.
    """

    def __init__(self, mask=None, stepped=False):
        self.mask = np.ones((SIZE, SIZE), bool) if mask is None else mask
        rows, columns = np.nonzero(self.mask)
        self.x, self.y = columns - SIZE / 2 + 0.5, SIZE / 2 - rows - 0.5
        self.z = 3 * (np.sin(self.x / 5) + np.cos(self.y / 4) + self.x * self.y / 150)
        zx = 3 * (np.cos(self.x / 5) / 5 + self.y / 150)
        zy = 3 * (-np.sin(self.y / 4) / 4 + self.x / 150)
        if stepped:
            zy = zy + 0.5 * (self.x > 0)
        normals = np.stack([-zx, -zy, np.ones_like(zx)], axis=1)
        self.normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.albedo = 0.7 + 0.2 * np.sin(self.x) * np.cos(2 * self.y)

    @property
    def b(self):
        return self.normals * self.albedo[:, None]

    def photographed(self, lights, noise, seed=0):
        """Return noisy images, and each pixel's own scaled normals of least squares."""
        images = MODEL.predict(lights, self.b)
        images += noise * np.random.default_rng(seed).standard_normal(images.shape)
        return images, fit_normals(images, MODEL, lights, self.b)


def mean_error(normals, relief, where=slice(None)):
    return angular_errors(normals, relief.normals)[where].mean()


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def penalty(ratio):
    return CAUCHY**2 / 2 * np.log(1 + (ratio / CAUCHY) ** 2)


def at_pixels(spline, mask, across, up):
    """Evaluate the spline's derivative of an order across and up by scipy, at the pixels."""

    def collocated(count, order):
        # Knots so that coefficient k peaks at k - 1, and pixels at 0, 1, ...
        basis = BSpline(np.arange(count + 6) - 3.0, np.eye(count + 2), 3)
        return basis(np.arange(count) + 0.0, nu=order)

    rows, columns = collocated(mask.shape[0], up), collocated(mask.shape[1], across)
    return ((-1) ** up * rows @ spline @ columns.T)[mask]


def test_energy_is_the_one_stated_and_falls():
    relief = Relief()
    lights = front(8)
    images, own = relief.photographed(lights, 0.03)
    weights = np.random.default_rng(3).uniform(0.3, 1, images.shape)
    fit = fit_integrable(
        images, relief.mask, MODEL, lights, own, weights=weights, noise=0.03, smoothness=8.0
    )
    assert len(fit.energies) > 2
    assert (np.diff(fit.energies) < 0).all()
    assert fit.converged

    z_x, z_y = (at_pixels(fit.spline, relief.mask, *order) for order in ((1, 0), (0, 1)))
    m = np.stack([-z_x, -z_y, np.ones_like(z_x)], axis=1)
    across = fit.b - (fit.b * m).sum(axis=1, keepdims=True) / (m**2).sum(axis=1, keepdims=True) * m
    give = GIVE * np.linalg.norm(own, axis=1)
    bends = [
        np.diff(fit.spline, 2, axis=0),
        np.diff(fit.spline, 2, axis=1),
        np.sqrt(2) * np.diff(np.diff(fit.spline, axis=0), axis=1),
    ]
    expected = (
        (weights * (images - np.maximum(lights @ fit.b.T, 0)) ** 2).sum() / 2
        + 0.03**2 * penalty(np.linalg.norm(across, axis=1) / give).sum()
        + 0.03**2 * sum(penalty(8.0 * each).sum() for each in bends)
    )
    # Sums of a few thousand numbers.
    np.testing.assert_allclose(fit.energies[-1], expected, rtol=1e-10)
    np.testing.assert_allclose(fit.depth, at_pixels(fit.spline, relief.mask, 0, 0), atol=1e-10)
    assert abs(fit.depth.mean()) < 1e-10


def test_energy_does_not_rise_where_three_lights_and_shadows_mislead():
    relief = Relief()
    lights = front(3)
    images, own = relief.photographed(lights, 0.1)
    fit = fit_integrable(images, relief.mask, MODEL, lights, own, noise=0.1)
    assert len(fit.energies) > 1
    assert (np.diff(fit.energies) < 0).all()


def test_converges_by_its_tolerance(monkeypatch):
    relief = Relief()
    lights = front(4)
    images, own = relief.photographed(lights, 0.03)
    arguments = (images, relief.mask, MODEL, lights, own)
    monkeypatch.setattr(surface, "TOLERANCE", 1.0)
    at_once = fit_integrable(*arguments, noise=0.03)
    assert at_once.converged
    assert len(at_once.energies) == 2
    monkeypatch.setattr(surface, "TOLERANCE", 0.0)
    monkeypatch.setattr(surface, "STEPS", 1)
    cut_short = fit_integrable(*arguments, noise=0.03)
    assert not cut_short.converged


def test_noise_free_relief_keeps_its_normals_and_gets_its_depth():
    relief = Relief()
    lights = front(8)
    images, own = relief.photographed(lights, 0.0)
    fit = fit_integrable(images, relief.mask, MODEL, lights, own)
    assert mean_error(fit.normals, relief) < 1e-6
    # A spline's slopes are wrong by z''''' / 180, here 3 / 5^5 / 180, over a width of 32 pixels;
    # slopes by central differences would be by z''' / 6, and depth by 0.1.
    np.testing.assert_allclose(fit.depth, relief.z - relief.z.mean(), atol=1e-3)


def test_neighbours_reduce_noise_without_a_prior():
    relief = Relief()
    lights = front(16)
    images, own = relief.photographed(lights, 0.02)
    fit = fit_integrable(images, relief.mask, MODEL, lights, own, smoothness=0.0)
    assert fit.noise == pytest.approx(0.02, rel=0.05)
    before = mean_error(unit(own), relief)
    # One depth for two slopes: the square root of a half, with room for the mask's rim.
    assert mean_error(fit.normals, relief) < 0.78 * before


def test_smoothness_flattens_noise():
    relief = Relief()
    lights = front(4)
    images, own = relief.photographed(lights, 0.03)
    errors = [
        mean_error(
            fit_integrable(
                images, relief.mask, MODEL, lights, own, noise=0.03, smoothness=smoothness
            ).normals,
            relief,
        )
        for smoothness in (0.0, 1.0, 6.0)
    ]
    before = mean_error(unit(own), relief)
    assert errors[0] > 1.05 * errors[1]
    assert errors[1] > 1.5 * errors[2]
    assert errors[2] < 0.4 * before


def test_jump_is_not_bent():
    relief = Relief(stepped=True)
    lights = front(16)
    images, own = relief.photographed(lights, 0.01)
    fit = fit_integrable(images, relief.mask, MODEL, lights, own)
    beside = np.abs(relief.x) < 2
    assert mean_error(fit.normals, relief, beside) < mean_error(unit(own), relief, beside)
    assert mean_error(fit.normals, relief, ~beside) < 0.8 * mean_error(unit(own), relief, ~beside)


def test_dark_pixels_take_the_normals_about_them():
    relief = Relief()
    spot = np.hypot(relief.x - 3, relief.y + 4) < 2.2
    relief.albedo[spot] = 0
    lights = front(8)
    images, own = relief.photographed(lights, 0.0)
    own[spot] = 0
    fit = fit_integrable(images, relief.mask, MODEL, lights, own)
    assert spot.sum() > 10
    assert np.linalg.norm(fit.b[spot], axis=1).max() < 0.01
    # A thin plate is wrong by the fourth derivative, 3 / 5^4 r^3 / 8: a slope of 0.006 at r = 2.2.
    assert angular_errors(fit.normals, relief.normals)[spot].max() < 0.4


def test_pixels_that_start_in_shadow_are_found_again():
    relief = Relief()
    lost = np.arange(len(relief.x)) % 7 == 0
    lights = front(8)
    images, own = relief.photographed(lights, 0.01)
    own[lost] = 0
    fit = fit_integrable(images, relief.mask, MODEL, lights, own, noise=0.01)
    assert mean_error(fit.normals, relief, lost) < 1.3 * mean_error(fit.normals, relief, ~lost)


def test_any_mask_will_do():
    y, x = np.mgrid[:SIZE, :SIZE] - SIZE / 2
    two = (np.hypot(x + 7, y) < 7) | (np.hypot(x - 9, y) < 5)
    two[0, 0] = True
    relief = Relief(two)
    lights = front(8)
    images, own = relief.photographed(lights, 0.02)
    fit = fit_integrable(images, relief.mask, MODEL, lights, own)
    assert fit.depth.shape == (two.sum(),)
    assert mean_error(fit.normals, relief) < 0.9 * mean_error(unit(own), relief)


def test_refuses_nonsense():
    relief = Relief()
    lights = front(8)
    images, own = relief.photographed(lights, 0.01)
    with pytest.raises(ArgumentError, match="mask must cover the pixels"):
        fit_integrable(images, np.ones((3, 3), bool), MODEL, lights, own)
    with pytest.raises(ArgumentError, match="smoothness must be at least 0"):
        fit_integrable(images, relief.mask, MODEL, lights, own, smoothness=-1.0)
    with pytest.raises(ArgumentError, match="noise must be at least 0"):
        fit_integrable(images, relief.mask, MODEL, lights, own, noise=float("nan"))
    with pytest.raises(ArgumentError, match="b must be finite"):
        fit_integrable(images, relief.mask, MODEL, lights, own * np.inf)
    with pytest.raises(ArgumentError, match="b must not be zero at every pixel"):
        fit_integrable(images, relief.mask, MODEL, lights, 0 * own, noise=0.01)
    with pytest.raises(ArgumentError, match="noise must be given"):
        fit_integrable(images[:3], relief.mask, MODEL, lights[:3], own)
