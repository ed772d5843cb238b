import numpy as np

from harmface.io import read_capture, write_image
from harmface.io.hot_pixels import without_hot_pixels


def photographs(rng, count=5, size=60):
    """Return a smooth shading with bright specks of paint, and hot pixels in each photograph."""
    y, x = np.mgrid[:size, :size] / size
    paint = np.where(rng.random((size, size)) < 0.005, 1.0, 0.3)
    lean = rng.uniform(-0.5, 0.5, (count, 2))
    clean = paint * (1 + lean[:, :1, None] * x + lean[:, 1:, None] * y)
    clean += 0.002 * rng.standard_normal(clean.shape)
    hot = rng.random(clean.shape) < 0.002
    return clean, hot


def test_hot_pixels_are_told_from_specks_of_paint(rng):
    clean, hot = photographs(rng)
    mended, count = without_hot_pixels(np.where(hot, 1.5, clean))
    # One beside another, or beside a speck, is not told: some six of a hundred.
    assert 0.85 * hot.sum() < count <= hot.sum()
    assert np.array_equal(mended[~hot], clean[~hot])
    off = np.abs(mended - clean)[hot] / clean[hot]
    assert np.median(off) < 0.02


def test_photographs_are_mended_when_they_are_read_and_that_is_said(tmp_path, rng):
    clean, _ = photographs(rng)
    clean /= 3
    for number, image in enumerate(clean):
        write_image(tmp_path / f"{number}.png", image)
    assert read_capture([tmp_path]).notes == ()
    clean[3, 20, 30] = 1.0
    write_image(tmp_path / "3.png", clean[3])
    found = read_capture([tmp_path])
    assert found.notes[0].startswith("1 hot pixels")
    assert found.images[3, 20, 30] < 0.5
