"""Light models against the renderer, and their derivatives against differences."""

import numpy as np
import pytest

from harmface.rendering import clamped_cosines, harmonic_images
from harmface.sphere import fibonacci_directions
from harmface.stereo.homogeneous import scaled_normal_images
from harmface.stereo.light_models import DenseLight, HarmonicLight, Mapped, PointLights

RNG = np.random.default_rng(11)
B = RNG.standard_normal((50, 3)) * RNG.uniform(0.2, 2, (50, 1))
LENGTH = np.linalg.norm(B, axis=1)
DENSE = DenseLight(fibonacci_directions(12))
MODELS = [
    (HarmonicLight(1), RNG.standard_normal((4, 4))),
    (HarmonicLight(2), RNG.standard_normal((4, 9))),
    (HarmonicLight(4), RNG.standard_normal((4, 25))),
    (PointLights(1, ambient=False), RNG.standard_normal((4, 3))),
    (PointLights(3, ambient=True), RNG.standard_normal((4, 13))),
    (DENSE, RNG.uniform(0, 1, (4, 13))),
    (
        Mapped(PointLights(2, ambient=True), RNG.standard_normal((3, 3))),
        RNG.standard_normal((4, 10)),
    ),
]


@pytest.mark.parametrize("degree", [0, 1, 2, 4, 6])
def test_scaled_normals_have_the_harmonic_images(degree):
    expected = harmonic_images(B / LENGTH[:, None], LENGTH, degree)
    assert np.allclose(scaled_normal_images(B, degree), expected, rtol=0, atol=1e-12)


def test_points_and_directions_are_clamped_cosines():
    light = MODELS[4][1]
    points = light[:, :9].reshape(4, 3, 3)
    expected = sum(np.maximum(points[:, j] @ B.T, 0) for j in range(3)) + light[:, 12:] * LENGTH
    expected += light[:, 9:12] @ B.T
    assert np.allclose(MODELS[4][0].predict(light, B), expected)
    weights = MODELS[5][1]
    expected = weights[:, :-1] @ clamped_cosines(B, DENSE.directions) + weights[:, -1:] * LENGTH
    assert np.allclose(DENSE.predict(weights, B), expected)


def test_light_all_around_with_a_gradient_is_a_sky_of_degree_one(ball):
    """Radiance `1 + c . w` over all directions w, integrated by the renderer's own cosines."""
    sky = fibonacci_directions(20_000)
    slope = np.array([0.3, 0.6, -0.2])
    radiance = (1 + sky @ slope) * 4 * np.pi / len(sky)
    expected = radiance @ clamped_cosines(ball.b, sky)
    light = np.array([[0, 0, 0, *(2 * np.pi / 3 * slope), np.pi]])
    found = PointLights(1, ambient=True).predict(light, ball.b)
    assert np.abs(found / expected - 1).max() < 1e-3


def test_light_that_is_out_has_no_derivative():
    light = RNG.standard_normal((2, 10))
    light[0, 3:6] = 0
    light[1, 6:9] = 0
    out = ~PointLights(2, ambient=True).by_light(light, B).any(axis=2)
    assert np.array_equal(out[0], np.isin(np.arange(10), [3, 4, 5]))
    assert np.array_equal(out[1], np.isin(np.arange(10), [6, 7, 8]))


def test_light_of_mapped_normals_makes_the_images_of_unmapped_ones():
    mapped, light = MODELS[6]
    unmapped = B @ np.linalg.inv(mapped.map).T
    assert np.allclose(mapped.predict(light, unmapped), mapped.model.predict(light, B))


@pytest.mark.parametrize(("model", "light"), MODELS)
def test_derivatives_agree_with_differences(model, light):
    # Central differences of step h err by h^2 and by eps / h: 1e-10 both at 1e-5. No pixel
    # lies within 1e-5 of a terminator.
    h = 1e-5
    by_normal = model.by_normal(light, B)
    for i in range(3):
        step = h * np.eye(3)[i]
        slope = (model.predict(light, B + step) - model.predict(light, B - step)) / (2 * h)
        assert np.allclose(by_normal[..., i], slope, rtol=1e-6, atol=1e-7)
    by_light = model.by_light(light, B)
    assert by_light.shape == (*light.shape, len(B))
    for q in range(light.shape[1]):
        step = h * np.eye(light.shape[1])[q]
        slope = (model.predict(light + step, B) - model.predict(light - step, B)) / (2 * h)
        assert np.allclose(by_light[:, q], slope, rtol=1e-6, atol=1e-7)
