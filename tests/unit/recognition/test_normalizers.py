import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition.normalizers import equalized, self_quotient, tan_triggs

NORMALIZERS = [equalized, self_quotient, tan_triggs]


@pytest.mark.parametrize("normalizer", NORMALIZERS)
def test_exposure_plays_no_part(normalizer, rng):
    images = 0.1 + rng.random((3, 20, 16))
    assert np.allclose(normalizer(images), normalizer(4 * images), atol=1e-9)


@pytest.mark.parametrize("normalizer", NORMALIZERS)
def test_images_are_treated_each_for_itself(normalizer, rng):
    images = 0.1 + rng.random((3, 20, 16))
    assert np.allclose(normalizer(images)[1], normalizer(images[1:2])[0])


def test_equalised_values_are_uniform(rng):
    found = np.sort(equalized(0.2 + 0.1 * rng.random((1, 50, 50))).ravel())
    # A histogram of 256 bins resolves 1 / 256, and a sample of 2,500 deviates by 1 / 50.
    assert np.abs(found - np.linspace(0, 1, 2500)).max() < 0.05


@pytest.mark.parametrize("normalizer", [self_quotient, tan_triggs])
def test_a_slow_change_of_light_is_taken_off(normalizer, rng):
    face = 0.2 + rng.random((1, 48, 42))
    light = np.exp(np.linspace(-1, 1, 42))
    before = np.linalg.norm(face * light - face) / np.linalg.norm(face)
    after = normalizer(face * light) - normalizer(face)
    assert np.linalg.norm(after) / np.linalg.norm(normalizer(face)) < before / 2


def test_the_quotient_of_a_flat_or_black_image_is_one():
    assert np.allclose(self_quotient(np.stack([np.zeros((8, 8)), np.full((8, 8), 0.3)])), 1)


def test_tan_triggs_is_bounded_and_leaves_a_flat_image_flat(rng):
    assert np.abs(tan_triggs(rng.random((1, 30, 30)) ** 8)).max() <= 10
    assert not tan_triggs(np.zeros((1, 8, 8))).any()


@pytest.mark.parametrize("normalizer", NORMALIZERS)
def test_negative_images_are_refused(normalizer):
    with pytest.raises(ArgumentError, match="negative"):
        normalizer(-np.ones((1, 8, 8)))
