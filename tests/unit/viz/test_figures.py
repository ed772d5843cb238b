from io import BytesIO

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from harmface.errors import FileError
from harmface.light import EnvironmentMap, project
from harmface.viz import (
    basis_figure,
    environment_figure,
    figure_bytes,
    modes_figure,
    spectrum_figure,
    write_figure,
)


def pixels(figure):
    return np.asarray(Image.open(BytesIO(figure_bytes(figure))).convert("RGB")).astype(int)


def test_the_same_figure_gives_the_same_bytes():
    def make():
        return spectrum_figure({"paper": [0.4, 0.3], "ours": [0.5, 0.2]})

    assert figure_bytes(make()) == figure_bytes(make())


def test_a_figure_is_written_whole_or_not_at_all(tmp_path):
    figure = Figure()
    with pytest.raises(FileError, match="cannot be written"):
        write_figure(tmp_path / "no" / "a.png", figure)
    with pytest.raises(FileError, match=r"ends in \.png"):
        write_figure(tmp_path / "a.pdf", figure)
    assert not list(tmp_path.iterdir())
    write_figure(tmp_path / "a.png", figure)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_positive_is_green_negative_blue_and_background_grey():
    images = np.zeros((4, 20, 20))
    images[1, :, :10], images[1, :, 10:] = 1, -1
    mask = np.ones((20, 20), bool)
    mask[0] = False
    found = pixels(basis_figure(images, mask))
    green = (found[..., 1] > found[..., 2] + 60).sum()
    blue = (found[..., 2] > found[..., 1] + 60).sum()
    assert green == pytest.approx(blue, rel=0.1)
    assert green > 100


def test_modes_are_grey_at_zero_and_named():
    mask = np.ones((8, 8), bool)
    mode = np.zeros((2, 8, 8))
    mode[:, :4] = 1
    mode[:, 4:] = -1
    found = pixels(modes_figure({"analytic": mode}, {"analytic": np.array([0.6, 0.4])}, mask))
    assert (found == 255).any()
    assert (found == 0).any()


def test_an_environment_is_brightest_where_its_lamp_is():
    radiance = np.full((3, 16, 32), 0.01)
    radiance[:, 4:8, 20:24] = 10
    environment = EnvironmentMap.from_image(np.moveaxis(radiance, 0, -1))
    found = pixels(environment_figure(environment, project(environment, 2)))
    columns = found.sum(axis=-1)[:, : found.shape[1] // 3]
    inside = columns[30:-10, 10:-10]
    assert inside[:, inside.shape[1] // 2 :].mean() > inside[:, : inside.shape[1] // 2].mean()
