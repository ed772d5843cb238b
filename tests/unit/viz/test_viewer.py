import json
import re
from html import unescape

import numpy as np
import pytest

from data_synth.faces import head
from data_synth.shapes import sphere
from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh
from harmface.light import EnvironmentMap
from harmface.reproduce.synthetic import mesh_of
from harmface.viz import decimated, viewer
from harmface.viz.viewer import scene
from harmface.viz.viewer.scene import (
    coarse_faces,
    light_entry,
    map_texture,
    shared_exponents,
)


@pytest.fixture(scope="module")
def ball():
    return mesh_of(sphere(32))


def decoded(codes):
    """Return what OpenGL makes of RGB9_E5."""
    exponents = (codes >> 27).astype(float) - 15 - 9
    mantissas = np.stack([(codes >> shift) & 511 for shift in (0, 9, 18)], axis=-1)
    return mantissas * np.exp2(exponents)[..., None]


def test_shared_exponents_keep_nine_bits(rng):
    rgb = np.exp(rng.uniform(-8, 11, size=(5000, 3)))
    found = decoded(shared_exponents(rgb))
    # Half a step, which is at most a 256th of the brightest channel.
    assert (np.abs(found - rgb) <= rgb.max(axis=-1, keepdims=True) / 512).all()
    exact = np.array([[0.0, 0, 0], [1, 0.5, 0], [511, 1, 2], [65408, 0, 0]])
    np.testing.assert_array_equal(decoded(shared_exponents(exact)), exact)
    np.testing.assert_array_equal(decoded(shared_exponents(np.array([[1e9, 0.0, 0.0]]))), exact[3:])
    # The next exponent, not a mantissa of 512.
    np.testing.assert_allclose(decoded(shared_exponents(np.array([[0.9999, 0, 0]]))), [[1, 0, 0]])


def test_a_page_holds_all_it_needs_and_stays_small():
    mesh = mesh_of(head(0))
    environment = EnvironmentMap.from_image(np.ones((512, 1024, 3), np.float32))
    page = viewer(mesh, environment)
    assert len(mesh.vertices) > 19_000
    arrays = 4 / 3 * (24 * len(mesh.vertices) + 12 * len(mesh.faces))
    assert len(page.html) < arrays + 2e6
    assert not re.search(r"https?:", page.html)


def test_a_notebook_gets_the_page_in_a_frame(ball):
    page = viewer(ball, title='a "ball"')
    frame = page._repr_html_()
    assert unescape(re.search(r'srcdoc="([^"]*)"', frame)[1]) == page.html
    assert repr(page).startswith("Viewer('a \"ball\"', 2143 vertices, ")


def test_a_page_is_written_whole_or_not_at_all(ball, tmp_path):
    page = viewer(ball)
    page.write(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text() == page.html
    with pytest.raises(FileError, match=r"ends in \.html"):
        page.write(tmp_path / "a.png")
    with pytest.raises(FileError, match="cannot be written"):
        page.write(tmp_path / "no" / "a.html")
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


def test_a_grey_light_has_three_channels():
    found = np.array(light_entry("grey", np.array([1.0, 2, 3, 4]))["coefficients"])
    assert found.shape == (3, 25)
    np.testing.assert_array_equal(found[:, :5], [[1, 2, 3, 4, 0]] * 3)
    grey = EnvironmentMap.from_image(np.full((8, 16), 2.0))
    assert (
        map_texture(grey)["texels"]
        == map_texture(EnvironmentMap.from_image(np.full((8, 16, 3), 2.0)))["texels"]
    )


def test_nonsense_is_refused(ball, monkeypatch, unchecked):
    count = len(ball.vertices)
    with pytest.raises(ArgumentError, match="one channel or three"):
        viewer(ball, np.ones((2, 9)))
    with pytest.raises(ArgumentError, match="number of harmonics must be a square"):
        viewer(ball, np.ones((3, 8)))
    with pytest.raises(ArgumentError, match="a vector for each vertex"):
        viewer(ball, transfer=np.ones((9, 5)))
    with pytest.raises(ArgumentError, match="a vector for each vertex"):
        viewer(ball, transfer=np.ones(count))
    with pytest.raises(ArgumentError, match="number of harmonics must be a square"):
        viewer(ball, transfer=np.ones((8, count)))
    with pytest.raises(ArgumentError, match="transfer must be given"):
        viewer(ball, flat=True)
    with pytest.raises(ArgumentError, match="light must be given"):
        viewer(ball, reference=np.ones(count))
    with pytest.raises(ArgumentError, match="reference must have shape"):
        viewer(ball, np.ones(9), reference=np.ones(5))
    with pytest.raises(ArgumentError, match="lie in"):
        viewer(ball, colours={"a": np.full((count, 3), 1.1)})
    with pytest.raises(ArgumentError, match="must not be negative"):
        viewer(ball, colours={"a": np.full((count, 3), -0.1)})
    point = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), ball.normals[:3], ball.albedo[:3])
    with pytest.raises(ArgumentError, match="extent"):
        viewer(point)
    monkeypatch.setattr(scene, "MAX_VERTICES", 1000)
    with pytest.raises(ArgumentError, match=r"at most 1000 vertices .* got 2143; .*--decimate 500"):
        viewer(ball)


def test_transfer_beyond_the_degree_of_the_light_is_left_out(ball):
    transfer = np.ones((36, len(ball.vertices)))
    text = re.search(r'id="scene">(.*?)</script>', viewer(ball, transfer=transfer).html)[1]
    assert len(json.loads(text)["transfer"]["scales"]) == 25


def test_decimation_keeps_the_surface(ball):
    fine = mesh_of(sphere(64))
    few = decimated(fine, 500)
    assert 400 < len(few.vertices) < 550
    assert np.abs(np.linalg.norm(few.vertices, axis=1) - 1).max() < 0.02
    # Seen from outside, faces still run counter-clockwise.
    a, b, c = (few.vertices[corner] for corner in few.faces.T)
    assert (np.einsum("fi,fi->f", np.cross(b - a, c - a), a) > 0).all()
    assert decimated(ball, 5000) is ball
    with pytest.raises(ArgumentError, match="vertices must be 4 or more"):
        decimated(ball, 3)


def test_coarse_faces_lie_on_the_surface():
    fine = mesh_of(sphere(150))
    assert len(fine.faces) > scene.MANY_FACES
    faces = coarse_faces(fine)
    assert 10_000 < len(faces) < 30_000
    a, b, c = (fine.vertices[corner] for corner in faces.T)
    across = np.cross(b - a, c - a)
    areas = np.linalg.norm(across, axis=1) / 2
    np.testing.assert_allclose(areas.sum(), 4 * np.pi, rtol=0.02)
    outwards = np.einsum("fi,fi->f", across, a + b + c) > 0
    assert areas[outwards].sum() > 0.995 * areas.sum()
    text = re.search(r'id="scene">(.*?)</script>', viewer(fine).html)[1]
    assert json.loads(text)["coarseFaces"]
    assert (
        json.loads(re.search(r'id="scene">(.*?)</script>', viewer(mesh_of(sphere(32))).html)[1])[
            "coarseFaces"
        ]
        is None
    )
