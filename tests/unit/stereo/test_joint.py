import numpy as np
import pytest

from harmface.stereo import angular_errors, without_linear_map, without_lorentz
from harmface.stereo.joint import fit_jointly
from harmface.stereo.light_models import HarmonicLight, PointLights
from harmface.stereo.per_pixel import fit_normals


def sampled(scene, count=120):
    return scene.b[:: len(scene.b) // count]


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def test_degree_two_is_recovered_up_to_a_lorentz_transformation(ball, rng):
    truth = sampled(ball)
    light = rng.standard_normal((12, 9)) + 4 * np.eye(9)[0]
    model = HarmonicLight(2)
    images = model.predict(light, truth)
    start = truth + 0.05 * rng.standard_normal(truth.shape)
    fit = fit_jointly(images, model, light, start, iterations=200, tolerance=1e-14)
    moved = without_lorentz(unit(fit.b), unit(truth))
    assert angular_errors(moved, unit(truth)).max() < 1e-4


def test_point_sources_are_recovered_up_to_a_linear_map(ball, single_lights, rng):
    truth = sampled(ball)
    model = PointLights(1, ambient=False)
    images = np.maximum(single_lights @ truth.T, 0)
    start = truth + 0.05 * rng.standard_normal(truth.shape)
    fit = fit_jointly(images, model, single_lights, start, iterations=200, tolerance=1e-14)
    mapped = without_linear_map(fit.b, unit(truth))
    assert angular_errors(mapped, unit(truth)).max() < 1e-4


@pytest.mark.parametrize("weighted", [False, True])
def test_energy_falls_and_is_that_of_the_result(ball, single_lights, rng, weighted):
    truth = sampled(ball)
    images = np.maximum(single_lights @ truth.T, 0) + 0.02 * rng.standard_normal((24, len(truth)))
    weights = rng.uniform(0.1, 1, images.shape) if weighted else None
    model = PointLights(2, ambient=True)
    light = np.concatenate([single_lights, 0.1 * single_lights[::-1], np.full((24, 4), 0.1)], 1)
    fit = fit_jointly(images, model, light, truth, weights=weights, iterations=10)
    assert len(fit.energies) > 3
    assert (np.diff(fit.energies) < 0).all()
    squares = (images - model.predict(fit.light, fit.b)) ** 2
    energy = (squares if weights is None else weights * squares).sum() / 2
    assert abs(fit.energies[-1] / energy - 1) < 1e-12


@pytest.mark.parametrize("model", [HarmonicLight(1), PointLights(1, ambient=True)])
@pytest.mark.parametrize("pixels", [4, 100])
def test_step_is_that_of_the_whole_normal_equations(rng, monkeypatch, pixels, model):
    from harmface.stereo import joint

    monkeypatch.setattr(joint, "PIXELS", pixels)
    points = model == PointLights(1, ambient=True)
    light, b = rng.standard_normal((5, 7 if points else 4)), rng.standard_normal((6, 3))
    if points:
        # What is out stays out.
        light[2, :3] = 0
        light[3, 3:6] = 0
    values, weights = rng.standard_normal((5, 6)), rng.uniform(0.5, 1, (5, 6))
    system = joint._normal_equations(values, model, light, b, weights)
    light_step, b_step = joint._solve(system, 0.1)
    q = light.shape[1]
    jacobian = np.zeros((5, 6, 5 * q + 18))
    for f in range(5):
        jacobian[f, :, q * f : q * f + q] = model.by_light(light, b)[f].T
        for p in range(6):
            jacobian[f, p, 5 * q + 3 * p : 5 * q + 3 * p + 3] = model.by_normal(light, b)[f, p]
    flat, w = jacobian.reshape(30, -1), weights.ravel()
    normal = flat.T @ (w[:, None] * flat)
    right = flat.T @ (w * (values - model.predict(light, b)).ravel())
    # The shortest step leaves alone what has no effect.
    step = np.linalg.lstsq(normal + 0.1 * np.diag(np.diag(normal)), right, rcond=None)[0]
    assert np.allclose(np.concatenate([light_step.ravel(), b_step.ravel()]), step, atol=1e-9)


def test_weights_of_zero_leave_outliers_out(ball, single_lights):
    images = np.maximum(single_lights @ ball.b.T, 0)
    weights = (images > 0).astype(float)
    images[:, ::7] += 2 * (np.arange(24) % 5 == 0)[:, None]
    weights[::5, ::7] = 0
    start = ball.b + 0.1
    b = fit_normals(images, PointLights(1, ambient=False), single_lights, start, weights=weights)
    assert np.abs(b - ball.b).max() < 1e-6
