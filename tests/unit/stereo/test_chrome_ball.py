"""Lamps that a mirror sphere shows."""

import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import angular_errors, directions_from_mirror_sphere
from tests.unit.stereo.mirror_sphere import CENTRE, RADIUS, SHAPE, mirrored, pixels, rays, unit


@pytest.fixture(scope="module")
def mask():
    return pixels(rays()[0].astype(float)) > 0.5


@pytest.fixture(scope="module")
def lamps():
    polar, azimuth = np.radians([5, 20, 40, 60, 80, 110]), np.radians([10, 80, 150, 220, 290, 0])
    return np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    )


@pytest.mark.parametrize("clip", [1.0, np.inf], ids=["clipped", "not clipped"])
def test_lamps_are_found_to_a_fraction_of_a_pixel(mask, lamps, clip):
    found = directions_from_mirror_sphere(mirrored(lamps, clip=clip), mask)
    assert found.centre == pytest.approx(CENTRE, abs=0.05)
    assert found.radius == pytest.approx(RADIUS, abs=0.1)
    error = angular_errors(found.directions, lamps)
    assert (error < 0.25 * found.degrees_per_pixel).all()
    # The normal of a highlight is no direction to a lamp.
    halfway = unit(found.directions + np.array([0, 0, 1]))
    assert angular_errors(halfway, lamps)[2:].min() > 19


def test_what_a_pixel_is_worth_is_what_one_pixel_moves(mask, lamps):
    images = mirrored(lamps[2:5])
    here = directions_from_mirror_sphere(images, mask)
    for axis in (1, 2):
        there = directions_from_mirror_sphere(np.roll(images, 1, axis=axis), mask)
        moved = angular_errors(here.directions, there.directions)
        assert (moved < 1.1 * here.degrees_per_pixel).all()
        assert (moved > 0.5 * here.degrees_per_pixel).any()


def test_glossy_lobes_and_wide_lamps_have_their_middle(mask, lamps):
    on, n = rays()
    mirror = 2 * n[..., 2:] * n - (0, 0, 1)
    lobes = [pixels(on * np.maximum(mirror @ lamp, 0) ** 60) for lamp in lamps[:5]]
    wide = mirrored(lamps[:5], degrees=12)
    for images in (lobes, wide):
        found = directions_from_mirror_sphere(np.array(images), mask)
        # The middle of the highlight's pixels would be a degree and more off at 60 and 80 degrees.
        assert angular_errors(found.directions, lamps[:5]).max() < 0.5


def test_a_window_in_all_photographs_is_no_lamp(mask, lamps):
    images = mirrored(lamps[:4], window=3.0)
    found = directions_from_mirror_sphere(images, mask)
    assert angular_errors(found.directions, lamps[:4]).max() < 0.5


def test_a_hidden_outline_and_a_highlight_painted_black_serve(mask, lamps):
    hidden = mask.copy()
    hidden[80:] = False
    images = mirrored(lamps[:3])
    hidden[images[0] > 0.5] = False
    found = directions_from_mirror_sphere(images, hidden)
    assert angular_errors(found.directions, lamps[:3]).max() < 1.0


def test_photographs_without_a_clear_highlight_are_named(mask, lamps, rng):
    images = mirrored(lamps[:3])
    names = ["a.png", "b.png", "c.png"]

    def refused(number, image, match):
        bad = images.copy()
        bad[number] = image
        with pytest.raises(ArgumentError, match=match):
            directions_from_mirror_sphere(bad, mask, names=names)

    refused(1, 0.0, r"b\.png: shows no highlight")
    two = mirrored(lamps[3:4])[0] + mirrored(lamps[4:5])[0]
    refused(2, np.minimum(two, 1), r"c\.png: shows no clear highlight .* 2 bright parts")
    refused(0, rng.random(SHAPE), r"a\.png: shows no clear highlight")
    on, n = rays()
    refused(0, pixels(on * np.maximum(n @ lamps[2], 0)), r"a\.png: .* wider than 40 degrees")
    with pytest.raises(ArgumentError, match="photograph 1: "):
        directions_from_mirror_sphere(np.zeros((1, *SHAPE)), mask)


@pytest.mark.usefixtures("unchecked")
def test_what_is_no_sphere_is_refused(mask, lamps):
    images = mirrored(lamps[:2])
    square = np.zeros(SHAPE, bool)
    square[20:80, 20:90] = True
    small = np.zeros(SHAPE, bool)
    small[50:54, 50:54] = True
    for wrong, match in (
        (square, "outline is no circle"),
        (small, "at least 5 pixels"),
        (np.zeros(SHAPE, bool), "got an empty one"),
        (np.ones(SHAPE, bool), "has none"),
        (mask[:50], "must have the size"),
    ):
        with pytest.raises(ArgumentError, match=match):
            directions_from_mirror_sphere(images, wrong)
    with pytest.raises(ArgumentError, match="shape"):
        directions_from_mirror_sphere(images[0], mask)
    with pytest.raises(ArgumentError, match="one for each of 2"):
        directions_from_mirror_sphere(images, mask, names=["a"])
