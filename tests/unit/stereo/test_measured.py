"""Pixels of known normals beside blocks."""

import numpy as np

from harmface.stereo import angular_errors, image_stack, photometric_stereo
from harmface.stereo.coarse import coarse_factor, coarse_stack
from harmface.stereo.cues import KnownNormals
from harmface.stereo.measured import beside
from harmface.stereo.stack import picture
from tests.unit.stereo.conftest import bumpy_ball

SLOPES = np.random.default_rng(3).uniform(-0.01, 0.01, (30, 2))


def ramps(size=40):
    """Images that change linearly over the picture, each its own way, with a crease at one row."""
    y, x = np.mgrid[:size, :size]
    images = 1 + SLOPES[:, :1, None] * x + SLOPES[:, 1:, None] * y
    images[:, 30] += 0.5 * np.sign(SLOPES[:, :1])
    return images


def seen_beside(images, places, mask=None):
    stack = image_stack(images, mask)
    index = np.full(stack.mask.shape, -1)
    index[stack.mask] = np.arange(stack.mask.sum())
    known = KnownNormals(index[tuple(np.transpose(places))], np.eye(3)[: len(places)])
    blocks = coarse_stack(stack, 4)
    extended, moved = beside(blocks, stack, known)
    assert np.array_equal(extended.values[:, : len(blocks.values.T)], blocks.values)
    assert (moved.normals == known.normals).all()
    assert extended.seen.shape == extended.usable.shape == extended.values.shape
    return extended.values[:, moved.columns].T


def test_without_noise_pixels_are_taken_as_they_are():
    images = ramps()
    places = [(20, 20), (30, 10), (0, 39)]
    found = seen_beside(images, places)
    assert np.allclose(found, [images[:, i, j] for i, j in places], atol=1e-12)


def test_noise_is_averaged_out_where_the_surface_is_even(rng):
    true = ramps()
    images = true + 0.02 * rng.standard_normal(true.shape)
    even, creased, border = seen_beside(images, [(15, 20), (30, 10), (0, 39)])
    # A mean over 17 x 17 pixels that fall off linearly leaves 0.08 of the noise.
    assert np.std(even - true[:, 15, 20]) < 0.15 * 0.02
    # Neither a crease nor a border has a mean that is its own.
    assert np.array_equal(creased, images[:, 30, 10])
    assert np.array_equal(border, images[:, 0, 39])


def test_means_stay_inside_the_mask(rng):
    images = ramps() + 0.02 * rng.standard_normal((30, 40, 40))
    mask = np.ones((40, 40), bool)
    mask[:, :19] = False
    images[:, ~mask] = 7.0
    (found,) = seen_beside(images, [(15, 20)], mask)
    assert np.std(found - ramps()[:, 15, 20]) < 0.02
    # Two pixels to the border: a reach of one is all.
    assert not np.array_equal(found, images[:, 15, 20])


def test_known_normals_decide_where_light_is_found_on_blocks(single_lights, rng):
    """The concave counterpart of a surface makes the same images."""
    scene = bumpy_ball(110)
    assert coarse_factor(scene.mask) > 1
    images = scene.images(single_lights, np.eye(24))
    images = scene.pictures(np.abs(images + 0.01 * rng.standard_normal(images.shape)))
    concave = scene.normals * (-1, -1, 1)
    known = np.zeros_like(concave)
    known[[2000, 4500, 6000]] = concave[[2000, 4500, 6000]]
    result = photometric_stereo(
        images, scene.mask, normals_known=picture(known, scene.mask), outline=False, refine=False
    )
    assert angular_errors(result.normals[scene.mask], concave).mean() < 2
