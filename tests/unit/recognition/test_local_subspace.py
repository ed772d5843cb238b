import numpy as np
import pytest

from harmface.errors import ArgumentError
from harmface.recognition import Windows, local_basis, local_distances, log_intensity
from harmface.recognition.local_subspace import CONTRAST_NOISE, DIMENSION, RIDGE

SHAPE = (16, 12)
NOISE = 0.005
WINDOWS = Windows(np.ones(SHAPE, bool))


def photographs(rng, count):
    return 0.2 + rng.random((count, *SHAPE))


def distance(probe, images):
    basis = local_basis(log_intensity(images, NOISE), WINDOWS)[None]
    return local_distances(log_intensity(probe[None], NOISE), basis, WINDOWS)[0, 0]


def test_windows_are_a_quarter_high_overlap_by_half_and_reach_every_edge():
    assert Windows(np.ones((48, 42), bool)).side == (12, 12)
    assert Windows(np.ones((48, 42), bool)).shift == 1
    corners = Windows(np.ones((48, 42), bool)).corners
    assert sorted({top for top, _ in corners}) == [0, 6, 12, 18, 24, 30, 36]
    assert sorted({left for _, left in corners}) == [0, 6, 12, 18, 24, 30]


def test_the_last_window_ends_where_the_image_ends():
    assert max(left for _, left in Windows(np.ones((48, 40), bool)).corners) == 28


def test_a_window_that_is_mostly_outside_the_mask_is_left_out():
    mask = np.ones(SHAPE, bool)
    mask[:, :6] = False
    assert {left for _, left in Windows(mask).corners} == {4, 6, 8}


def test_windows_are_cut_from_the_moved_image(rng):
    image = rng.random((1, *SHAPE))
    moved = np.roll(image, (1, -1), axis=(1, 2))
    inner = WINDOWS.corners.index((4, 4))
    assert np.allclose(WINDOWS.cut(image, (1, -1))[inner], WINDOWS.cut(moved)[inner])
    edge = WINDOWS.cut(image, (1, 0))[0, 0].reshape(WINDOWS.side)
    assert np.array_equal(edge[0], edge[1])


def test_light_on_a_whole_window_is_taken_off(rng):
    image = rng.random((1, *SHAPE))
    assert np.allclose(WINDOWS.cut(image + 3), WINDOWS.cut(image))


def test_pixels_outside_the_mask_play_no_part(rng):
    mask = np.ones(SHAPE, bool)
    mask[:5, :5] = False
    image = rng.random((1, *SHAPE))
    other = np.where(mask, image, rng.random(image.shape))
    assert np.allclose(Windows(mask).cut(image), Windows(mask).cut(other))


@pytest.mark.parametrize("count", [1, 4])
def test_distance_is_that_of_ridge_regression_on_the_moved_images(rng, count):
    images, probe = photographs(rng, count), photographs(rng, 1)[0]
    logs = np.log(images + 3 * NOISE)
    x = WINDOWS.cut(np.log(probe + 3 * NOISE)[None])[:, 0]
    step = WINDOWS.shift
    moves = [(0, 0), (step, 0), (-step, 0), (0, step), (0, -step)]
    terms = []
    for j in range(len(x)):
        A = np.concatenate([WINDOWS.cut(logs, move)[j] for move in moves])
        _, values, rows = np.linalg.svd(A, full_matrices=False)
        A = values[:DIMENSION, None] * rows[:DIMENSION]
        ridge = RIDGE * values[0] ** 2
        stacked = np.concatenate([A.T, np.sqrt(ridge) * np.eye(len(A))])
        target = np.concatenate([x[j], np.zeros(len(A))])
        left = np.linalg.lstsq(stacked, target, rcond=None)[1][0]
        noise = x.shape[1] * CONTRAST_NOISE**2
        terms.append(np.sqrt((left + noise) / (x[j] @ x[j] + noise)))
    # Single precision, of residuals about as large as the energy they are taken from.
    assert distance(probe, images) == pytest.approx(np.mean(terms), abs=1e-4)


def test_an_aligned_gallery_knows_no_movement(rng):
    images = log_intensity(photographs(rng, 2), NOISE)
    still = local_basis(images, WINDOWS, aligned=True)
    assert still.shape == local_basis(images, WINDOWS).shape
    assert not still[:, 2:].any()


def test_a_movement_by_a_pixel_is_absorbed(rng):
    smooth = np.repeat(np.repeat(rng.random((1, 8, 6)), 2, axis=1), 2, axis=2) + 0.2
    other = photographs(rng, 1)
    moved = np.pad(smooth[0], ((1, 0), (0, 0)), mode="edge")[:-1]
    assert distance(moved, smooth) < 0.2 < distance(moved, other)


def test_a_shadow_spoils_only_the_windows_it_meets(rng):
    images = photographs(rng, 3)
    shadowed = images[0].copy()
    shadowed[:4, :4] = 0
    spoilt = sum(top < 4 and left < 4 for top, left in WINDOWS.corners) / len(WINDOWS.corners)
    added = distance(shadowed, images) - distance(images[0], images)
    assert 0 < added <= spoilt


def test_a_probe_without_contrast_beyond_the_noise_says_nothing(rng):
    faint = 0.5 + 1e-4 * rng.random(SHAPE)
    assert distance(faint, photographs(rng, 2)) > 0.99


def test_all_pairs_at_once_are_as_one_by_one(rng, monkeypatch):
    galleries = [log_intensity(photographs(rng, 2), NOISE) for _ in range(3)]
    probes = log_intensity(photographs(rng, 4), NOISE)
    bases = np.stack([local_basis(images, WINDOWS) for images in galleries])
    together = local_distances(probes, bases, WINDOWS)
    monkeypatch.setattr("harmface.recognition.local_subspace.CHUNK", 1)
    assert np.allclose(together, local_distances(probes, bases, WINDOWS), atol=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Windows(np.zeros(SHAPE, bool)), "leaves none"),
        (lambda: log_intensity(-np.ones(SHAPE), NOISE), "negative"),
        (lambda: log_intensity(np.full(SHAPE, np.nan), NOISE), "finite"),
        (lambda: log_intensity(np.ones(SHAPE), 0.0), "noise must be above 0"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
