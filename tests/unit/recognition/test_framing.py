import cv2
import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition import Gallery, Photographs
from harmface.recognition.framing import in_frame_of


@pytest.fixture
def heads():
    """Pictures of blobs that lie alike, under light from several sides."""
    rng = np.random.default_rng(3)
    rows, columns = np.mgrid[:96, :96]
    face = np.full((96, 96), 0.5)
    for row, column, size in ((40, 35, 4), (40, 61, 4), (55, 48, 5), (68, 48, 7)):
        face -= 0.3 * np.exp(-((rows - row) ** 2 + (columns - column) ** 2) / 2 / size**2)
    slopes = np.linspace(-0.4, 0.4, 8)[:, None, None] * (columns / 48 - 1)
    images = face * (1 + slopes) * (1 + 0.02 * rng.random((8, 96, 96)))
    return Photographs(np.repeat(np.arange(4), 2), images.astype(np.float32))


def test_the_frame_is_found_where_the_features_are(heads):
    known = [image[30:78, 27:69] for image in heads.images[:3]]
    larger = np.stack([cv2.resize(image, (84, 96)) for image in known])
    gallery = Gallery(Photographs(np.arange(3), larger), np.ones((96, 84), bool))
    found = in_frame_of(gallery, heads)
    assert found.images.shape == (8, 96, 84)
    dark = np.unravel_index(found.images[3][:50].argmin(), (50, 84))
    expected = np.unravel_index(
        cv2.resize(heads.images[3, 30:78, 27:69], (84, 96))[:50].argmin(), (50, 84)
    )
    # Sizes are tried 5 % apart: on a frame of 96 rows that is off by 2.5 at its rim.
    assert np.abs(np.subtract(dark, expected)).max() <= 3


def test_a_frame_larger_than_the_others_is_refused(heads):
    wide = np.random.default_rng(0).random((2, 20, 60))
    gallery = Gallery(Photographs(np.arange(2), wide), np.ones((20, 60), bool))
    with pytest.raises(ArgumentError, match="must fit into"):
        in_frame_of(gallery, Photographs(heads.subjects, heads.images[:, :, :80]))
