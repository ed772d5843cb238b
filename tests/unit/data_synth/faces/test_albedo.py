import numpy as np
import pytest

from data_synth.faces import build_head, head, mean_head
from data_synth.faces.albedo import LUMINANCE, melanin_of_tone, skin

SMALL = 5_000


def forehead(subject):
    x, y, z = subject.vertices.T
    return subject.albedo[(np.abs(x) < 20) & (np.abs(y - 45) < 12) & (z > 60)].mean(axis=0)


def test_albedo_is_linear_rgb_in_range():
    for seed in range(12):
        albedo = head(seed, n_vertices=SMALL).albedo
        assert albedo.min() >= 0
        assert albedo.max() <= 1


def test_melanin_darkens_and_blood_reddens():
    melanin = np.linspace(0.01, 0.43, 20)
    assert (np.diff(skin(melanin, 0.05), axis=0) < 0).all()
    pale, flushed = skin(0.1, 0.02), skin(0.1, 0.1)
    assert flushed[0] / flushed[1] > pale[0] / pale[1]


def test_skin_is_red_over_green_over_blue():
    for melanin in (0.01, 0.2, 0.43):
        red, green, blue = skin(melanin, 0.05)
        assert red > green > blue


def test_tones_cover_the_human_range_evenly():
    root = np.sqrt([skin(melanin_of_tone(t), 0.048) @ LUMINANCE for t in np.linspace(-1, 1, 9)])
    assert root[0] ** 2 == pytest.approx(0.55, abs=0.03)
    assert root[-1] ** 2 == pytest.approx(0.08, abs=0.02)
    assert (np.diff(root) < 0).all()
    # The red decays less than the luminance, so that the steps are only roughly equal.
    assert np.diff(root).min() / np.diff(root).max() < 1.5


def test_drawn_foreheads_spread_over_the_range():
    luminance = np.array([forehead(head(s, n_vertices=SMALL)) @ LUMINANCE for s in range(40)])
    assert luminance.min() < 0.13
    assert luminance.max() > 0.45


def test_lips_are_redder_and_pupils_darker_than_skin():
    subject = mean_head(20_000)
    x, y, z = subject.vertices.T
    lips = subject.albedo[(np.abs(x) < 12) & (np.abs(y + 71) < 3) & (z > 80)].mean(axis=0)
    bare = forehead(subject)
    assert lips[0] / lips[1] > 1.15 * bare[0] / bare[1]
    reach = np.hypot(np.abs(x) - 31, y - 0.4)
    red = subject.albedo[:, 0]
    assert (
        red[(reach < 1.5) & (z > 70)].mean()
        < 0.6 * red[(np.abs(reach - 4) < 0.5) & (z > 70)].mean()
    )
    white = subject.albedo[(np.abs(np.abs(x) - 24) < 1.5) & (np.abs(y + 0.5) < 2) & (z > 65)]
    assert (white @ LUMINANCE).max() > 0.3


def test_luminance_albedo_is_rec_709():
    subject = build_head({"melanin": 0.2}, SMALL)
    expected = subject.albedo @ [0.2126, 0.7152, 0.0722]
    np.testing.assert_allclose(subject.luminance_albedo, expected, rtol=1e-14)
