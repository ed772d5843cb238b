import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.stereo import image_stack

RNG = np.random.default_rng(3)
IMAGES = RNG.uniform(0.1, 1.0, (6, 5, 7))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"images": IMAGES[:3]}, "at least 4, got 3"),
        ({"images": IMAGES[0]}, r"shape \(F, H, W\)"),
        ({"mask": np.zeros((5, 7), bool)}, "at least one pixel"),
        ({"mask": np.ones((7, 5), bool)}, "mask must have the images' size"),
        ({"images": np.where(IMAGES > 0.5, np.nan, IMAGES)}, "finite"),
        ({"images": -IMAGES}, "must not be negative"),
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
    images[0, 0, 0], images[1, 2, 3] = 0.0, 5.0
    usable = image_stack(images, saturated=4.0).usable.reshape(images.shape)
    assert not usable[0, 0, 0]
    assert not usable[1, 2, 3]
    assert usable.sum() == usable.size - 2


def test_precision_is_kept():
    assert image_stack(IMAGES.astype(np.float32)).values.dtype == np.float32
