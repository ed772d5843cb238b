import numpy as np
import pytest

from harmface.reproduce import recognition
from harmface.reproduce.recognition import LHK05, light_grid


@pytest.fixture(scope="module")
def measured():
    with pytest.MonkeyPatch.context() as patch:
        # Heads so alike that there are errors on every subset.
        patch.setattr(recognition, "GRID_IDENTITY_SCALE", 0.1)
        return light_grid(subjects=3, size=24)


def cells(figure):
    """Return the table that a figure shows, by method."""
    (axes,) = figure.axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    values = np.array([text.get_text() for text in axes.texts]).reshape(len(names), -1)
    return dict(zip(names, values.tolist(), strict=True))


def test_every_recogniser_is_measured_on_every_subset(measured):
    ours = cells(next(iter(measured.figures.values())))
    assert set(ours) > set(LHK05)
    assert all(len(row) == 5 for row in ours.values())
    assert [float(ours[name][3]) for name in LHK05] == pytest.approx(measured.values, abs=0.05)
    assert "lbph" in measured.note.lower()


def test_the_published_table_stands_beside_ours(measured):
    ours, beside = (cells(figure) for figure in measured.figures.values())
    assert list(beside) == list(LHK05)
    assert beside["eigenfaces"][::2] == ["-", "-", "75.7"]
    assert beside["9-D harmonic"][::2] == ["0.0", "0.0", "3.6"]
    for name, row in beside.items():
        assert row[3::2] == ours[name][2:4]
        # 7 and 12 lights make up the first two subsets.
        first, second = map(float, ours[name][:2])
        assert float(row[1]) == pytest.approx((7 * first + 12 * second) / 19, abs=0.1)
    assert float(ours["eigenfaces"][1]) > float(ours["eigenfaces"][0])


def test_the_order_of_the_methods_is_told(measured):
    published = ("eigenfaces", "3-D linear", "9-D harmonic", "9-D with cast shadows")
    fourth = dict(zip(LHK05, measured.values, strict=True))
    errors = [fourth[name] for name in (*published, "nine points of light")]
    told = "is the published one" in measured.note
    assert told == (errors == sorted(errors, reverse=True))
    assert errors[0] > errors[-1]
