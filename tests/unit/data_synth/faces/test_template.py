import numpy as np
import pytest

from data_synth.faces.template import build_template


def dome(points):
    """Half an ellipsoid with a sharp ridge round the pole."""
    radius = np.hypot(points[:, 0], points[:, 1])
    height = np.cos(radius * np.pi / 2) + 0.2 * np.exp(-(((radius - 0.4) / 0.03) ** 2))
    return 100 * np.column_stack([points[:, 0], height, points[:, 1]])


@pytest.fixture(scope="module")
def template():
    return build_template(3_000, dome)


def whole(template):
    return np.concatenate([template.points, template.points[template.paired] * [-1, 1]])


@pytest.mark.parametrize("n_vertices", [500, 1_001, 3_000])
def test_has_the_vertices_asked_for(n_vertices):
    assert len(whole(build_template(n_vertices, dome))) in (n_vertices - 1, n_vertices)


def test_tiles_the_disc_once(template):
    points = whole(template)
    a, b, c = np.moveaxis(points[template.faces], 1, 0)
    # The face side (+y of the disc) is z in space: outward is clockwise in the disc.
    area = (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]) - (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1])
    assert area.min() > 0
    rim = points[np.isclose(np.hypot(*points.T), 1.0, atol=1e-12)]
    angle = np.sort(np.arctan2(rim[:, 0], rim[:, 1]))
    gaps = np.diff(angle, append=angle[0] + 2 * np.pi)
    assert area.sum() / 2 == pytest.approx(np.sin(gaps).sum() / 2, abs=1e-12)


def test_is_mirror_symmetric(template):
    points = whole(template)
    mirrored = {tuple(p) for p in points * [-1, 1] + 0.0}
    assert mirrored == {tuple(p) for p in points + 0.0}


def test_follows_the_ridge(template):
    radius = np.hypot(*template.points.T)
    on_ridge = np.mean(np.abs(radius - 0.4) < 0.08)
    by_area = 2 * 0.4 * 0.16  # of a uniform triangulation
    assert on_ridge > 3 * by_area
