import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import image_stack, photometric_stereo
from harmface.stereo.stack import spread_images
from tests.unit.stereo.conftest import front_lights
from tests.unit.stereo.mirror_sphere import mirrored, pixels, rays

RNG = np.random.default_rng(3)
IMAGES = RNG.uniform(0.1, 1.0, (6, 5, 7))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"images": IMAGES[:3]}, "at least 4, got 3"),
        ({"images": IMAGES[0]}, r"shape \(F, H, W\)"),
        ({"mask": np.zeros((5, 7), bool)}, "at least one pixel"),
        ({"mask": np.ones((7, 5), bool)}, "mask must have the size"),
        ({"images": np.where(IMAGES > 0.5, np.nan, IMAGES)}, "finite"),
        ({"images": -IMAGES}, "must not be negative"),
        ({"saturated": IMAGES[1:] > 0.9}, r"saturated must tell .* got bool of shape \(5, 5, 7\)"),
        ({"saturated": IMAGES}, "saturated must tell .* got float64"),
        ({"saturated": IMAGES > 0}, "saturated must leave observations"),
        ({"images": np.arange(1.0, 7)[:, None, None] * IMAGES[:1]}, "alike up to exposure"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(change, message):
    with pytest.raises(ArgumentError, match=message):
        image_stack(**{"images": IMAGES, **change})


def test_values_are_the_masked_pixels_and_go_back():
    mask = RNG.random((5, 7)) < 0.5
    stack = image_stack(IMAGES, mask)
    assert np.array_equal(stack.values, IMAGES[:, mask])
    picture = stack.picture(stack.values[2], background=-1.0)
    assert np.array_equal(picture[mask], IMAGES[2][mask])
    assert (picture[~mask] == -1).all()


def test_dark_and_saturated_pixels_are_known():
    images = IMAGES.copy()
    images[0, 0, 0] = 0.0
    saturated = np.zeros(images.shape, bool)
    saturated[1, 2, 3] = saturated[4, 0, 6] = True
    mask = np.ones((5, 7), bool)
    mask[0, 6] = False
    stack = image_stack(images, mask, saturated=saturated)
    expected = ~saturated[:, mask]
    expected[0, 0] = False
    assert np.array_equal(stack.usable, expected)


def test_precision_is_kept():
    assert image_stack(IMAGES.astype(np.float32)).values.dtype == np.float32


@pytest.mark.parametrize("most", [2, 5, 7, 100])
def test_spread_images_reach_from_the_first_to_the_last(most):
    images = np.concatenate([IMAGES] * 7)[:40]
    stack = image_stack(images)
    some = spread_images(stack, most)
    assert len(some.values) == min(most, len(images)) == len(some.seen) == len(some.usable)
    assert np.array_equal(some.values[[0, -1]], stack.values[[0, -1]])


@pytest.mark.parametrize("room", [0.0, 0.02, 1.0], ids=["black room", "dim room", "bright room"])
@pytest.mark.parametrize("count", [4, 5, 12])
def test_what_shows_highlights_only_is_refused(room, count):
    on, _ = rays()
    mask = pixels(on.astype(float)) > 0.5
    lamps = front_lights(count)
    # The room's reflection does not move with the lamp.
    reflected = room * RNG.uniform(0.5, 1, mask.shape)
    chrome = np.minimum(mirrored(lamps, window=0.5) - 0.03 * mask + reflected, 2)
    images = np.where(mask, np.maximum(chrome, 0), 0)
    known = {"method": "known-lights", "light": lamps}
    near = {"method": "known-lights", "positions": 3 * lamps}
    for arguments in (known, near, {"method": "4d"}, {"method": "refined"}):
        with pytest.raises(ArgumentError, match="Chrome or black objects show no shading"):
            photometric_stereo(images, mask, saturated=images >= 1.5, **arguments)


def test_pixels_that_few_images_light_are_not_taken_for_highlights():
    # Lamps at the horizon: each side of a sphere is lit by half of them.
    azimuth = np.radians(30.0 * np.arange(12))
    lamps = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(12)], axis=1)
    on, normals = rays()
    images = np.maximum(np.tensordot(lamps, normals, (1, 2)), 0)
    assert len(image_stack(images, on & (normals[..., 2] < 0.9)).values) == 12
