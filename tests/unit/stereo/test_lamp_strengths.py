"""Strengths of lamps whose directions were measured."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harmface.stereo import image_stack
from harmface.stereo.lamp_strengths import strengths_of
from tests.unit.stereo.conftest import Quadric, front_lights

LAMPS = front_lights(24)
SHAPE = Quadric((26.0, 20.0, 23.0), size=60)


def photographed(strengths, noise, rng):
    """Return the stack of the ellipsoid, with noise relative to the mean of what is lit."""
    values = np.maximum(strengths[:, None] * LAMPS @ SHAPE.normals.T, 0)
    values += noise * values[values > 0].mean() * rng.standard_normal(values.shape)
    images = np.zeros((len(values), *SHAPE.mask.shape))
    images[:, SHAPE.mask] = np.maximum(values, 0)
    return image_stack(images, SHAPE.mask)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_planted_strengths_are_found(seed):
    rng = np.random.default_rng(seed)
    strengths = np.exp(0.5 * rng.standard_normal(24))
    found, beliefs = strengths_of(photographed(strengths, 0.01, rng), LAMPS)
    assert np.mean(found) == pytest.approx(1)
    # 1 % of noise in 600 pixels and more.
    assert np.abs(found / (strengths / strengths.mean()) - 1).max() < 0.02
    known, equal = beliefs
    assert known.accepted
    # Cauchy's scale of normal logarithms is 0.61 of their spread.
    assert equal.scale == pytest.approx(0.61 * np.std(np.log(strengths)), rel=0.35)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_directions_that_are_off_make_up_no_strengths(seed):
    rng = np.random.default_rng(seed)
    stack = photographed(np.ones(24), 0.01, rng)
    off = Rotation.from_rotvec(np.radians(3) / np.sqrt(2) * rng.standard_normal((24, 3)))
    found, beliefs = strengths_of(stack, off.apply(LAMPS))
    assert np.abs(found - 1).max() < 0.05
    assert all(told.accepted for told in beliefs)


def test_the_unit_of_the_images_does_not_matter(rng):
    strengths = np.exp(0.5 * rng.standard_normal(24))
    stack = photographed(strengths, 0.01, rng)
    dim = replace(stack, values=stack.values * 1e-4)
    assert np.allclose(strengths_of(dim, LAMPS)[0], strengths_of(stack, LAMPS)[0], rtol=1e-6)
