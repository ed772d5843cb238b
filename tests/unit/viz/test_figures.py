from io import BytesIO

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh, depth_to_mesh
from harmface.light import EnvironmentMap, project
from harmface.rendering import harmonic_images
from harmface.viz import (
    basis_figure,
    environment_figure,
    figure_bytes,
    modes_figure,
    spectrum_figure,
    stereo_figure,
    write_figure,
)
from harmface.viz.stereo import mesh_picture


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
    with pytest.raises(FileError, match=r"ends in \.png, \.svg, \.pdf"):
        write_figure(tmp_path / "a.gif", figure)
    with pytest.raises(ArgumentError, match="dpi"):
        write_figure(tmp_path / "a.png", figure, dpi=0)
    assert not list(tmp_path.iterdir())
    write_figure(tmp_path / "a.png", figure)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize(("name", "start"), [("a.svg", b"<?xml"), ("a.pdf", b"%PDF-1")])
def test_the_ending_says_the_format(tmp_path, name, start):
    figure = spectrum_figure({"ours": [0.5, 0.2]})
    write_figure(tmp_path / name, figure)
    first = (tmp_path / name).read_bytes()
    assert first.startswith(start)
    write_figure(tmp_path / name, figure)
    assert (tmp_path / name).read_bytes() == first


def test_dots_per_inch():
    figure = spectrum_figure({"ours": [0.5, 0.2]})
    small, large = (Image.open(BytesIO(figure_bytes(figure, dpi=dpi))).size[0] for dpi in (50, 200))
    assert large == pytest.approx(4 * small, rel=0.02)


def test_notebooks_show_a_figure_without_being_told():
    figure = spectrum_figure({"ours": [0.5, 0.2]})
    assert figure._repr_png_() == figure_bytes(figure)


def test_panels_of_degrees_that_vanish_say_so():
    y, x = np.mgrid[1:-1:24j, -1:1:24j]
    mask = x**2 + y**2 < 0.95
    normals = np.where(
        mask[..., None], np.dstack([x, y, np.sqrt(np.where(mask, 1 - x**2 - y**2, 0))]), 0
    )
    figure = basis_figure(harmonic_images(normals, mask.astype(float), 3), mask)
    panels = {axes.get_title(): axes for axes in figure.axes if axes.get_title()}
    zero = [title for title, axes in panels.items() if [t.get_text() for t in axes.texts]]
    assert len(panels) == 16
    assert zero == [title for title in panels if title.startswith("$A_{3}")]
    # Each of the other degrees has a scale, which is symmetric about zero.
    bars = [image for axes in panels.values() for image in axes.images if image.colorbar]
    assert [bar.norm.vmin for bar in bars] == [-bar.norm.vmax for bar in bars]
    assert len(bars) == 3
    assert all(bar.colorbar.ax.get_ylabel().startswith("irradiance") for bar in bars)


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


def test_photometric_stereo_shows_what_came_in_and_what_came_out():
    y, x = np.mgrid[1:-1:40j, -1:1:40j]
    mask = x**2 + y**2 < 0.9
    z = np.sqrt(np.where(mask, 1 - x**2 - y**2, 1))
    normals = np.where(mask[..., None], np.stack([x, y, z], axis=-1), 0.0)
    depth = np.where(mask, 20 * z, 0)
    images = np.arange(1, 10)[:, None, None] * mask.astype(float)
    figure = stereo_figure(
        images, normals, mask.astype(float), depth, mask, depth_to_mesh(depth, mask)
    )
    titles = [axes.get_title() for axes in figure.axes]
    assert titles[:5] == ["image 1", "image 3", "image 5", "image 7", "image 9"]
    assert {"depth", "albedo", "lit from the left", "mesh, from the right"} < set(titles)
    left, right = (
        np.asarray(figure.axes[titles.index(f"lit from the {side}")].images[0].get_array())
        for side in ("left", "right")
    )
    assert left[20, 5] > 0.5 > left[20, 34]
    assert right[20, 34] > 0.5 > right[20, 5]


def test_a_mesh_is_seen_from_the_side_that_was_asked_for():
    # A square in the plane z = 0 with a fin that stands out of it at its right edge.
    vertices = np.array(
        [
            [-1, -1, 0],
            [1, -1, 0],
            [1, 1, 0],
            [-1, 1, 0],
            [1, 0.6, 0],
            [1.2, 0.6, 0.9],
            [1.2, 1, 0.9],
        ],
        dtype=float,
    )
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 2]])[:, ::1]
    normals = np.tile([0.0, 0, 1], (7, 1))
    mesh = Mesh(vertices, np.concatenate([faces, faces[2:, ::-1]]), normals, np.ones((7, 3)))
    above, below = (mesh_picture(mesh, 0, elevation) < 1 for elevation in (40, -40))
    # From above the fin, which is nearer, hangs lower in the picture; from below it stands higher.
    assert (
        np.flatnonzero(above[:, -20:].any(axis=1)).mean()
        > np.flatnonzero(below[:, -20:].any(axis=1)).mean()
    )
