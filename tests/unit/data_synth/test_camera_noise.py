"""Each stage of the camera against the statistics of its model."""

import numpy as np
import pytest

from data_synth.camera_noise import (
    add_read_noise,
    dequantise,
    encode,
    expose,
    photograph,
    quantise,
    saturate,
    shot_noise,
)

N = 100_000
DEVIATIONS = 5  # a sound sampler fails at five standard errors once in two million


def test_expose_fills_the_well_in_proportion() -> None:
    np.testing.assert_array_equal(
        expose(np.array([0.0, 0.25, 3.0]), 2.0, 100.0), [0.0, 50.0, 600.0]
    )


@pytest.mark.parametrize("mean", [0.5, 40.0, 20_000.0])
def test_shot_noise_has_the_variance_of_its_mean(mean: float) -> None:
    electrons = shot_noise(np.full(N, mean), np.random.default_rng(1))
    assert abs(electrons.mean() - mean) < DEVIATIONS * np.sqrt(mean / N)
    # Fourth central moment of a Poisson variable: mean + 3 mean^2.
    error = np.sqrt((mean + 2 * mean**2) / N)
    assert abs(electrons.var() - mean) < DEVIATIONS * error
    np.testing.assert_array_equal(electrons, np.rint(electrons))


def test_read_noise_has_its_deviation_and_no_bias() -> None:
    noise = add_read_noise(np.full(N, 7.0), 3.0, np.random.default_rng(1)) - 7.0
    assert abs(noise.mean()) < DEVIATIONS * 3.0 / np.sqrt(N)
    assert abs(noise.var() - 9.0) < DEVIATIONS * 9.0 * np.sqrt(2 / N)


def test_saturate_holds_both_ends() -> None:
    np.testing.assert_array_equal(saturate(np.array([-3.0, 5.0, 11.0]), 10.0), [0.0, 5.0, 10.0])


def test_srgb_curve_has_its_published_values() -> None:
    # IEC 61966-2-1: ends, either side of the knee, mid grey 0.214041 <-> 0.5, as printed.
    linear = np.array([0.0, 0.002, 0.01, 0.214041, 1.0])
    expected = [0.0, 0.02584, 0.099853, 0.5, 1.0]
    np.testing.assert_allclose(encode(linear, "srgb"), expected, atol=1e-6)


def test_gamma_is_a_power() -> None:
    np.testing.assert_allclose(encode(np.array([0.0, 0.25, 1.0]), 2.0), [0.0, 0.5, 1.0])


@pytest.mark.parametrize(
    ("bits", "dtype"), [(1, np.uint8), (8, np.uint8), (10, np.uint16), (16, np.uint16)]
)
def test_quantise_uses_every_code_and_is_undone_within_half_a_step(bits: int, dtype) -> None:
    values = np.linspace(0.0, 1.0, 4 * 2**bits + 1)
    codes = quantise(values, bits)
    assert codes.dtype == dtype
    assert len(np.unique(codes)) == 2**bits
    half_step = 0.5 / (2**bits - 1)
    assert np.abs(dequantise(codes, bits) - values).max() <= half_step + np.finfo(float).eps


def test_photograph_has_the_variance_of_all_stages() -> None:
    level, full_well, read = 0.3, 4000.0, 12.0
    photo = photograph(
        np.full(N, level), rng=2, exposure=0.5, full_well=full_well, read_noise=read, bits=12
    )
    electrons = level * 0.5 * full_well
    variance = (electrons + read**2) / full_well**2 + 1 / (12 * (2**12 - 1) ** 2)
    assert abs(photo.mean() - level * 0.5) < DEVIATIONS * np.sqrt(variance / N)
    assert abs(photo.var() - variance) < DEVIATIONS * variance * np.sqrt(2 / N)


def test_photograph_without_noise_to_speak_of_is_the_image() -> None:
    image = np.linspace(0.0, 1.0, 50).reshape(5, 10)
    photo = photograph(image, rng=1, full_well=1e12, read_noise=0.0)
    # Half a step of 16 bits, and five deviations of 1e12 electrons.
    np.testing.assert_allclose(photo, image, atol=0.5 / 65535 + 5e-6)
    assert photo.shape == image.shape


def test_photograph_saturates_highlights_and_floors_the_dark() -> None:
    photo = photograph(np.array([0.0, 9.0]), rng=1, read_noise=0.0, bits=8, codes=True)
    np.testing.assert_array_equal(photo, [0, 255])


def test_photograph_returns_encoded_values() -> None:
    photo = photograph(np.full(N, 0.2), rng=1, encoding="srgb", bits=8)
    assert abs(np.median(photo) - encode(np.array(0.2), "srgb")) <= 0.5 / 255
    codes = photograph(np.full(N, 0.2), rng=1, encoding="srgb", bits=8, codes=True)
    np.testing.assert_array_equal(codes / 255, photo)


def test_the_same_seed_gives_the_same_photograph() -> None:
    image = np.full((8, 8), 0.4)
    once, again = photograph(image, rng=3), photograph(image, rng=np.random.default_rng(3))
    assert once.tobytes() == again.tobytes()
    assert not np.array_equal(once, photograph(image, rng=4))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"image": np.array([-0.1])}, "image must be finite and non-negative"),
        ({"image": np.array([np.nan])}, "image must be finite and non-negative"),
        ({"exposure": 0.0}, "exposure must be"),
        ({"exposure": np.inf}, "exposure must be"),
        ({"full_well": -1.0}, "full_well must be"),
        ({"read_noise": -1.0}, "read_noise must be"),
        ({"bits": 0}, "bits must be from 1 to 16"),
        ({"bits": 17}, "bits must be from 1 to 16"),
        ({"encoding": "rec709"}, "encoding must be"),
        ({"encoding": 0.0}, "encoding must be"),
    ],
)
def test_photograph_refuses_nonsense(change: dict, complaint: str) -> None:
    settings = {"image": np.array([0.5]), "rng": 1} | change
    with pytest.raises(ValueError, match=complaint):
        photograph(settings.pop("image"), **settings)


def test_dequantise_refuses_impossible_bits() -> None:
    with pytest.raises(ValueError, match="bits must be"):
        dequantise(np.array([1]), 0)
