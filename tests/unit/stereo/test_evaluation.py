import numpy as np
import pytest
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation
from scipy.stats import spearmanr

from harmface.errors import ArgumentError
from harmface.stereo import (
    angular_errors,
    summary,
    without_convexity,
    without_linear_map,
    without_lorentz,
    without_rotation,
)
from harmface.stereo.confidence import (
    ambiguity_error,
    beside_neighbours,
    confidence_of,
    noise_error,
)
from harmface.stereo.cues import Cues
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.light_models import PointLights
from harmface.stereo.lorentz import lorentz_transformation
from harmface.stereo.per_pixel import fit_normals

Z = np.array([[0.0, 0, 1]])


def tilted(degrees):
    a = np.radians(degrees)
    return np.stack([np.sin(a), np.zeros_like(a), np.cos(a)], axis=-1)


def test_angles_are_exact_even_when_small():
    angles = np.array([0.0, 1e-7, 1.0, 90.0, 179.0, 180.0])
    truth = np.repeat(Z, len(angles), axis=0)
    # Near 180 degrees the chord is flat: the root of eps, 1e-8 radians.
    assert np.allclose(angular_errors(tilted(angles), truth), angles, rtol=1e-8, atol=2e-6)
    assert angular_errors(tilted(angles[1:2]), Z)[0] == pytest.approx(1e-7, rel=1e-6)


def test_summary_is_mean_and_percentiles():
    found = summary(np.arange(101.0))
    assert (found.mean, found.median, found.p90, found.p99) == (50, 50, 90, 99)


def test_ambiguities_are_undone(hills):
    n = hills.normals
    turn = Rotation.from_rotvec([1, 2, 0.5]).as_matrix() @ np.diag([1, 1, -1])
    assert angular_errors(without_rotation(n @ turn, n), n).max() < 1e-6
    assert angular_errors(without_convexity(n * (-1, -1, 1), n), n).max() == 0
    null = np.concatenate([np.ones((len(n), 1)), n], axis=1)
    image = null @ lorentz_transformation(np.array([0.2, -0.3, 0.1, 1, 0, 2.0])).T
    moved = image[:, 1:] / image[:, :1]
    assert angular_errors(without_rotation(moved, n), n).mean() > 3
    assert angular_errors(without_lorentz(moved, n), n).max() < 1e-5


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: angular_errors(2 * Z, Z), "unit vectors"),
        (lambda: angular_errors(Z, 2 * Z), "unit vectors"),
        (lambda: angular_errors(Z, Z.repeat(2, axis=0)), "truth must match"),
        (lambda: summary(np.empty(0)), "at least one angle"),
    ],
)
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()


def test_noise_error_is_the_spread_of_repeated_fits(ball, single_lights):
    rng = np.random.default_rng(1)
    b = np.repeat(ball.b[500:501], 2000, axis=0)
    model = PointLights(1, ambient=False)
    images = model.predict(single_lights, b) + 0.01 * rng.standard_normal((24, 2000))
    found = fit_normals(images, model, single_lights, b)
    truth = np.repeat(ball.normals[500:501], 2000, axis=0)
    spread = np.sqrt(
        (angular_errors(found / np.linalg.norm(found, axis=1, keepdims=True), truth) ** 2).mean()
    )
    told = np.sqrt(
        (noise_error(images, model, single_lights, found, np.ones(images.shape)) ** 2).mean()
    )
    # 2000 draws know a root mean square to 1.6 %; dark observations carry noise but no slope, and
    # so do not enter the covariance.
    assert abs(told / spread - 1) < 0.1


@pytest.mark.parametrize("spread", [3.0, 6.0])
def test_neighbours_show_which_normals_noise_has_moved(hills, rng, spread):
    noise = np.full(len(hills.normals), spread)
    moved = directions_of(
        hills.normals + np.radians(spread / np.sqrt(2)) * rng.standard_normal(hills.normals.shape)
    )
    errors = angular_errors(moved, hills.normals)
    told = beside_neighbours(moved, hills.mask, noise)
    # Within the border four lines foretell a normal, with 0.94 / 4 of its variance: no more can be
    # told than draws of two components tell with such draws added.
    inner = binary_erosion(hills.mask, np.ones((5, 5)))[hills.mask]
    own, beside = rng.standard_normal((2, 20_000, 2))
    beside *= np.sqrt(0.94 / 4)
    best = spearmanr(np.linalg.norm(own, axis=1), np.linalg.norm(own + beside, axis=1)).statistic
    assert spearmanr(told[inner], errors[inner]).statistic == pytest.approx(best, abs=0.05)
    assert np.sqrt((told**2).mean()) == pytest.approx(np.sqrt((errors**2).mean()), rel=0.1)


def test_rough_surfaces_do_not_pass_for_noise(ball, rng):
    rough = directions_of(ball.normals + 0.1 * rng.standard_normal(ball.normals.shape))
    told = beside_neighbours(rough, ball.mask, np.full(len(rough), 0.2))
    assert told == pytest.approx(0.2, rel=0.05)
    assert not beside_neighbours(rough, ball.mask, np.zeros(len(rough))).any()


def test_a_pixel_without_neighbours_keeps_its_noise():
    mask = np.zeros((5, 5), bool)
    mask[2, [0, 4]] = True
    assert beside_neighbours(np.eye(3)[:2], mask, np.array([1.0, 2.0])) == pytest.approx([1, 2])


def test_cues_that_say_more_leave_less_open(ball, single_lights):
    structure = ball.b.T
    plain = ambiguity_error(Cues(structure, ball.mask), np.eye(3), structure)
    lights = Cues(structure, ball.mask, lights=single_lights)
    told = ambiguity_error(lights, np.eye(3), structure)
    assert (told <= plain + 1e-9).all()
    assert told.mean() < 0.8 * plain.mean()


def test_confidence_falls_with_the_error():
    assert np.allclose(confidence_of(np.array([0.0, 5.0, 45.0])), [1, 0.5, 0.1])


def test_oracle_is_not_drawn_to_faint_dimensions(hills, rng):
    seen = hills.normals + 0.01 * rng.standard_normal(hills.normals.shape)
    faint = 1e-4 * rng.standard_normal((len(seen), 3))
    structure = np.concatenate([seen, faint], axis=1)
    normals = without_linear_map(structure, hills.normals)
    # 0.01 across the normal, in two directions: 0.8 degrees.
    assert angular_errors(normals, hills.normals).mean() < 1
