import numpy as np
import pytest
from scipy.stats import chi2, kstest, multivariate_normal

from data_synth.camera_noise import photograph
from harmface.errors import ArgumentError
from harmface.recognition import CameraNoise, likelihood_posteriors, likelihoods, orthonormal_basis

WELL, READ, BITS = 4000.0, 12.0, 8
NOISE = CameraNoise(1 / WELL, READ / WELL, 1 / (2**BITS - 1))
PIXELS = 300


@pytest.fixture
def images(rng):
    """Harmonic-like images of four subjects that differ by a few per cent."""
    common = 0.5 + 0.3 * rng.random((3, PIXELS))
    return common + 0.004 * rng.standard_normal((4, 3, PIXELS))


def photographs(images, count, rng, brightest=0.9):
    """Return photographs of random subjects under random light, and who they show."""
    who = rng.integers(0, len(images), count)
    light = rng.uniform(0, 1, (count, 3))
    means = np.einsum("nd,ndp->np", light, images[who])
    means *= (rng.uniform(0.2, 1, count) * brightest / means.max(axis=1))[:, None]
    return photograph(means, rng=rng, full_well=WELL, read_noise=READ, bits=BITS), who


def test_variance_is_that_of_the_camera(rng):
    levels = np.array([0.05, 0.3, 0.8])
    many = photograph(
        np.repeat(levels[:, None], 20_000, axis=1),
        rng=rng,
        full_well=WELL,
        read_noise=READ,
        bits=BITS,
    )
    # A variance of 20,000 samples is known to one per cent.
    assert np.allclose(many.var(axis=1), NOISE.variance(levels), rtol=0.04)


def test_residuals_of_the_right_subject_follow_chi_square(images, rng):
    probes, who = photographs(images, 400, rng)
    found = likelihoods(probes, orthonormal_basis(images, 3), NOISE)
    own = found.chi_square[np.arange(400), who]
    assert (found.freedom == PIXELS - 3).all()
    assert kstest(chi2.sf(own, found.freedom), "uniform").pvalue > 0.01
    wrong = likelihoods(1.2 * probes + 0.05 * rng.random(probes.shape), images, NOISE)
    assert kstest(chi2.sf(wrong.chi_square[:, 0], wrong.freedom), "uniform").pvalue < 1e-6


def test_posteriors_are_right_as_often_as_they_say(images, rng):
    probes, who = photographs(images, 1000, rng)
    found = likelihood_posteriors(likelihoods(probes, orthonormal_basis(images, 3), NOISE).log)
    right, sure = found.argmax(axis=1) == who, found.max(axis=1)
    assert 0.5 < right.mean() < 0.95
    for low, high in ((0.0, 0.6), (0.6, 0.9), (0.9, 1.0)):
        some = (sure >= low) & (sure < high)
        deviation = np.sqrt((sure[some] * (1 - sure[some])).sum())
        assert some.sum() > 50
        assert abs(right[some].sum() - sure[some].sum()) < 3 * deviation


def test_likelihood_is_the_gaussian_integrated_over_light(rng):
    """Against a broad Gaussian for the light, whose integral has a closed form."""
    basis = orthonormal_basis(rng.random((1, 2, 12)), 2)
    probes = np.abs(basis[0].sum(axis=0)) + 0.01 * rng.standard_normal((2, 12))
    # Without photon noise the variance is the same everywhere.
    noise = CameraNoise(0.0, 0.01, 0.0, np.inf)
    found = likelihoods(probes, basis, noise).log[:, 0]
    covariance = 1e3 * basis[0].T @ basis[0] + 1e-4 * np.eye(12)
    expected = multivariate_normal(cov=covariance).logpdf(probes)
    assert np.diff(found) == pytest.approx(np.diff(expected), rel=1e-4)
    variances = np.full(12, 1e-4)
    residuals = probes - probes @ basis[0].T @ basis[0]
    by_hand = (residuals**2).sum(axis=1) / 1e-4 + np.log(variances).sum() + np.log(1e4) * 2
    assert np.allclose(found, -by_hand / 2)


def test_saturated_pixels_play_no_part(images, rng):
    probes, _ = photographs(images, 3, rng, brightest=0.7)
    basis = orthonormal_basis(images, 3)
    kept = np.arange(PIXELS) % 5 > 0
    burnt = np.where(kept, probes, 1.0)
    one = likelihoods(burnt, basis, NOISE)
    other = likelihoods(probes[:, kept], basis[..., kept], NOISE)
    assert np.allclose(one.log, other.log)
    assert np.array_equal(one.freedom, other.freedom)


def test_probes_are_treated_a_few_at_a_time_without_effect(images, rng, monkeypatch):
    probes, _ = photographs(images, 5, rng)
    together = likelihoods(probes, images, NOISE)
    monkeypatch.setattr("harmface.recognition.noise.CHUNK", 2 * PIXELS)
    assert np.allclose(likelihoods(probes, images, NOISE).log, together.log)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: CameraNoise(-1.0, 1.0, 0.0), "gain must be 0 or more"),
        (lambda: CameraNoise(0.0, np.nan, 0.0), "read must be 0 or more"),
        (lambda: CameraNoise(1.0, 0.0, 0.0), "no camera is free of noise"),
        (lambda: CameraNoise(1.0, 1.0, 1.0, 0.0), "saturation must be above 0"),
        (lambda: likelihoods(np.ones((1, 9)), np.ones((1, 2, 9)), NOISE), "number 0 has 0; expose"),
        (lambda: likelihoods(np.ones((1, 8)), np.ones((1, 2, 9)), NOISE), "9 pixels"),
        (lambda: likelihoods(np.zeros((1, 9)), np.ones((1, 2, 9)), NOISE), "all black"),
        (lambda: likelihood_posteriors(np.full((1, 2), np.nan)), "finite"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
