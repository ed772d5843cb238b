import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition.answers import estimated_light, margins, posteriors
from harmface.rendering import relight


def test_margin_is_the_lead_of_the_first_over_the_second():
    distances = np.array([[0.4, 0.1, 0.2], [0.3, 0.3, 0.9], [0.0, 0.0, 1.0], [0.5, 0.0, 1.0]])
    assert np.allclose(margins(distances), [0.5, 0, 0, 1])


def test_posteriors_are_those_of_gaussian_noise_of_unknown_strength(rng):
    residuals = np.array([3.0, 4.0])
    pixels = 10
    # The likelihood of a residual r under the deviation that makes it most likely, r / sqrt(p).
    deviations = residuals / np.sqrt(pixels)
    likelihoods = deviations**-pixels * np.exp(-(residuals**2) / (2 * deviations**2))
    expected = likelihoods / likelihoods.sum()
    assert np.allclose(posteriors(0.1 * residuals[None], pixels), expected)


def test_posteriors_stay_finite_for_many_pixels_and_a_perfect_fit():
    assert np.allclose(posteriors(np.array([[0.0, 0.5], [1e-3, 1e-3]]), 1e5), [[1, 0], [0.5, 0.5]])


def test_estimated_light_is_that_of_least_squares(rng):
    images = rng.standard_normal((3, 4, 30))
    light = rng.standard_normal((3, 4))
    probes = np.stack([relight(own, basis) for own, basis in zip(light, images, strict=True)])
    assert np.allclose(estimated_light(probes, images), light)
    noisy = probes + rng.standard_normal(probes.shape)
    each = [np.linalg.lstsq(s.T, x, rcond=None)[0] for s, x in zip(images, noisy, strict=True)]
    assert np.allclose(estimated_light(noisy, images), each)


TWO = np.ones((4, 2))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: margins(np.ones((3, 1))), "at least two subjects"),
        (lambda: margins(-TWO), "negative"),
        (lambda: posteriors(TWO, 0.0), "independent must be above 0"),
        (lambda: posteriors(np.full((1, 2), np.nan), 1.0), "finite"),
        (lambda: estimated_light(np.ones((2, 5)), np.ones((1, 3, 5))), "each of 2 probes"),
        (lambda: estimated_light(np.ones((2, 4)), np.ones((2, 3, 5))), "5 pixels"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
