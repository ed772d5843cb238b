import cv2
import numpy as np
import pytest

from data_synth.faces import head
from harmface.conventions import light_direction
from harmface.enrollment import frame_to_photograph, in_frame, place_sitting
from harmface.enrollment.alignment import EYES
from harmface.errors import ArgumentError
from harmface.light import DistantLight
from harmface.recognition import subject_photographs
from harmface.reproduce.synthetic import mesh_of

SIZE = (96, 84)
LANDMARKS = np.array([[17.0, 26.0, 1], [67.0, 26.0, 1], [42.0, 70.0, 1]])


def moved(image, matrix):
    """Return a photograph in which what lies at p is what the image has at the inverse of p."""
    centred = matrix.copy()
    centred[:, 2] += matrix[:, :2] @ [0.5, 0.5] - 0.5
    return cv2.warpAffine(image, centred, image.shape[::-1], borderMode=cv2.BORDER_REPLICATE)


@pytest.fixture(scope="module")
def sitting():
    """One head with spots, the first photograph from the front."""
    lights = np.array([light_direction(a, 10) for a in (0, 20, -35, 50)])
    images = subject_photographs(
        mesh_of(head(3, n_vertices=5000)), DistantLight(lights, np.eye(len(lights))), 160
    )
    spots = cv2.GaussianBlur(np.random.default_rng(0).random((160, 160)), (0, 0), 2.5)
    # Some light from all around: a room is never black where the lamp does not reach.
    images = (images + 0.05 * images[0]) * np.where(spots > 0.53, 0.4, 1.0)
    return (images / images[0].max()).astype(np.float32)


def test_eyes_come_to_lie_where_they_should(rng):
    """Whatever their distance and tilt; against a picture of two dots."""
    eyes = np.array([[60.0, 90.0], [110.0, 75.0]])
    matrix = frame_to_photograph(eyes, SIZE)
    places = np.column_stack([EYES * SIZE[::-1], [1, 1]])
    assert np.allclose(places @ matrix.T, eyes)
    # A similarity: nothing is stretched.
    assert np.allclose(matrix[:, :2].T @ matrix[:, :2], np.eye(2) * np.linalg.det(matrix[:, :2]))
    rows, columns = np.mgrid[:160, :160] + 0.5
    dots = sum(np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 18) for x, y in eyes)
    seen = in_frame(dots, matrix, SIZE)
    half = SIZE[1] // 2
    for part, (x, y) in ((seen[:, :half], EYES[0]), (seen[:, half:], EYES[1])):
        row, column = np.mgrid[: part.shape[0], : part.shape[1]] + 0.5
        centre = [(part * column).sum() / part.sum(), (part * row).sum() / part.sum()]
        expected = np.array([x * SIZE[1], y * SIZE[0]])
        expected[0] -= 0 if x < 0.5 else half
        assert np.allclose(centre, expected, atol=0.15)


def test_photographs_of_a_sitting_follow_the_best_lit(sitting):
    """All but the first have eyes that are off by some pixels; the motion is known."""
    eyes = np.array([[52.0, 70.0], [108.0, 70.0]])
    rng = np.random.default_rng(1)
    truths, photographs, found = [], [], []
    for image in sitting:
        turn = cv2.getRotationMatrix2D((80, 80), rng.uniform(-3, 3), rng.uniform(0.97, 1.03))
        turn[:, 2] += rng.uniform(-3, 3, 2)
        photographs.append(moved(image, turn))
        own = np.column_stack([eyes, [1, 1]]) @ turn.T
        truths.append(frame_to_photograph(own, SIZE))
        found.append(own + (rng.uniform(-3, 3, (2, 2)) if len(found) else 0))
    start = [frame_to_photograph(own, SIZE) for own in found]
    placed = place_sitting(photographs, found, SIZE)

    def off(matrices):
        return [
            np.linalg.norm(LANDMARKS @ (a - b).T, axis=1).mean()
            for a, b in zip(matrices, truths, strict=True)
        ][1:]

    assert np.mean(off(placed)) < 0.5 * np.mean(off(start))
    certain = place_sitting(photographs, found, SIZE, [True] * len(found))
    assert np.allclose(certain, start)


def test_who_has_no_eyes_is_placed_as_the_best_lit_if_of_its_size(sitting):
    eyes = np.array([[52.0, 70.0], [108.0, 70.0]])
    photographs = [*sitting[:2], sitting[1][:150]]
    placed = place_sitting(photographs, [eyes, None, None], SIZE)
    assert np.allclose(placed[1] @ LANDMARKS.T, placed[0] @ LANDMARKS.T, atol=2)
    assert placed[2] is None
    assert place_sitting(photographs, [None] * 3, SIZE) == [None] * 3


def test_eyes_in_the_wrong_order_are_refused():
    with pytest.raises(ArgumentError, match="left one in the picture first"):
        frame_to_photograph(np.array([[50.0, 20.0], [20.0, 20.0]]), SIZE)
