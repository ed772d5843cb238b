from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from harmface.conventions import light_direction
from harmface.sphere import real_harmonics
from harmface.viz import Explanation, evaluation_figure, explanation_figure, figure_bytes
from harmface.viz.recognition import lit_sphere

MASK = np.ones((12, 10), bool)
MASK[:2] = False
PROBE = np.tile(np.linspace(0, 1, 10), (12, 1))


def pixels(figure):
    return np.asarray(Image.open(BytesIO(figure_bytes(figure))).convert("RGB")).astype(int)


@pytest.mark.parametrize(
    ("azimuth", "elevation", "row", "column"), [(50, 0, 0, 1), (-50, 0, 0, -1), (0, 50, -1, 0)]
)
def test_the_sphere_is_brightest_towards_the_light(azimuth, elevation, row, column):
    light = real_harmonics(light_direction(azimuth, elevation), 2)
    image, inside = lit_sphere(light)
    assert image.max() == 1
    assert image[~inside].max() == 0
    centre = (len(image) - 1) / 2
    at = np.argwhere(image == 1).mean(axis=0) - centre
    # A sphere shows the direction whose normal it is at sin 50 degrees of its radius.
    expected = np.array([row, column]) * np.sin(np.radians(50)) * len(image) / 2
    assert at == pytest.approx(expected, abs=3)


def test_negative_light_leaves_the_sphere_black():
    image, _ = lit_sphere(np.array([-1.0, 0, 0, 0]))
    assert image.max() == 0


def test_a_row_shows_probe_light_and_the_two_subjects():
    light = real_harmonics(light_direction(20, 10), 1)
    subjects = [("ann (0.1)", PROBE), ("bob (0.3)", PROBE[:, ::-1])]
    rows = [
        Explanation("one.png", PROBE, subjects, light),
        Explanation("two.png", PROBE, subjects[:1], light),
    ]
    figure = explanation_figure(rows, MASK)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [
        *("one.png", "light", "ann (0.1)", "probe less it", "bob (0.3)", "probe less it"),
        *("two.png", "light", "ann (0.1)", "probe less it", "", ""),
    ]
    differences = [figure.axes[k].images[0].get_array() for k in (3, 5)]
    assert np.ptp(differences[0].compressed()) == 0
    assert differences[1].compressed() == pytest.approx(
        ((PROBE - PROBE[:, ::-1]) / np.percentile(PROBE[MASK], 99.5))[MASK]
    )
    shown = pixels(figure)
    red = (shown[..., 0] > shown[..., 2] + 60).sum()
    blue = (shown[..., 2] > shown[..., 0] + 60).sum()
    assert red == pytest.approx(blue, rel=0.3)
    assert red > 100


def test_without_a_known_light_no_sphere_is_shown():
    figure = explanation_figure([Explanation("a", PROBE, [("ann", PROBE)], None)], MASK)
    assert [axes.get_title() for axes in figure.axes] == ["a", "ann", "probe less it"]


def found(errors):
    rate = {"errors": errors, "probes": 10, "interval": [0.0, errors / 5]}
    return {
        "subsets": {"1": rate, "5": rate},
        "cumulative_match": [1 - errors / 10, 1.0],
        "roc": {
            "false_accepts": [1e-4, 1.0],
            "true_accepts": [0.1, 1.0],
            "true_accepts_relative": [0.5, 1.0],
        },
        "reliability": {"claimed": [0.0, 0.95], "right": [0.0, 0.9], "count": [0, 7]},
    }


def test_an_evaluation_shows_every_method_in_every_panel():
    figure = evaluation_figure({"local": found(1), "lbph": found(4)})
    bars, match, roc, trust = figure.axes
    heights = [round(patch.get_height()) for patch in bars.patches]
    assert heights == [10, 10, 40, 40]
    intervals = [line[:, 1].tolist() for each in bars.collections for line in each.get_segments()]
    assert np.allclose(intervals, [[0, 20], [0, 20], [0, 80], [0, 80]])
    assert [label.get_text() for label in bars.get_xticklabels()] == [
        "subset 1\n10 probes",
        "subset 5\n10 probes",
    ]
    assert [line.get_ydata().tolist() for line in match.lines] == [[90, 100], [60, 100]]
    assert [line.get_ydata()[0] for line in roc.lines] == [50, 10, 50, 10]
    drawn = [line.get_xydata().tolist() for line in trust.lines]
    assert drawn == [[[95, 90]], [[95, 90]], [[0, 0], [100, 100]]]
    assert pixels(figure).min() == 0


def test_without_probabilities_no_reliability_is_shown():
    figure = evaluation_figure({"local": {**found(1), "reliability": None}})
    assert len(figure.axes[3].lines) == 1


def test_probes_of_no_known_subset_are_one_group():
    each = found(1)
    each["subsets"] = {"0": each["subsets"]["1"]}
    labels = evaluation_figure({"local": each}).axes[0].get_xticklabels()
    assert [label.get_text() for label in labels] == ["all\n10 probes"]
