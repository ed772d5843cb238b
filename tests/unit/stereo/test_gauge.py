"""The choice of a map by cues, on ellipsoids of which everything is known."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from harmface.stereo import angular_errors
from harmface.stereo.cues import (
    Albedo,
    DiffuseMaxima,
    Facing,
    Integrability,
    Rim,
    Strengths,
    TypicalShape,
    cost_of,
)
from harmface.stereo.gauge import (
    Gauge,
    bas_reliefs,
    boosted,
    choose_map,
    improved,
    lorentz_families,
    shifted,
    spread_of_maps,
    total_cost,
)
from harmface.stereo.lorentz import METRIC, lorentz_transformation
from tests.unit.stereo.conftest import bas_relief, front_lights

BENT = bas_relief(0.4, -0.3, 0.5)
LAMPS = front_lights(24)


@dataclass(frozen=True, eq=False)
class Planted:
    """Residuals whose distance to a target is told by numbers that are linear in the map."""

    design: np.ndarray
    target: np.ndarray
    noise: np.ndarray
    votes: float
    floor: float = 1e-6
    believable: float = np.inf
    name: str = "planted"

    def residuals(self, rows):
        return self.design @ (rows - self.target).ravel() + self.noise


def unit(b):
    return b / np.linalg.norm(b, axis=1, keepdims=True)


def cues_of(shape, frame, strengths=None):
    """Return what tells the map of `v = frame b` exactly."""
    seen = shape.field(frame)
    lamps = LAMPS if strengths is None else strengths[:, None] * LAMPS
    lamps = lamps @ np.linalg.inv(frame)
    return [
        Integrability.of(seen),
        Albedo.of(seen),
        Facing.of(seen),
        Rim.of(seen),
        TypicalShape.of(seen),
        Strengths.of(lamps, np.ones(len(lamps))),
    ]


def error(rows, frame, shape):
    return angular_errors(unit(shape.normals @ (rows @ frame).T), shape.normals)


def test_improvement_never_costs_more(egg):
    rng = np.random.default_rng(0)
    cues = cues_of(egg, BENT)
    for _ in range(8):
        start = np.linalg.inv(BENT) + 0.3 * rng.standard_normal((3, 3))
        cost, rows = improved(cues, start)
        assert cost <= total_cost(cues, start)
        assert cost == pytest.approx(total_cost(cues, rows))
        # The size of a map is no part of it.
        assert np.linalg.norm(rows) == pytest.approx(np.linalg.norm(start), rel=0.05)


def test_nothing_is_gained_at_the_optimum(egg):
    cues = cues_of(egg, BENT)
    gauge = choose_map(cues, [bas_reliefs(np.eye(3), egg.normals @ BENT.T)])
    accepted = [cue for cue, told in zip(cues, gauge.beliefs, strict=True) if told.accepted]
    assert gauge.cost == pytest.approx(total_cost(accepted, gauge.rows))
    rng = np.random.default_rng(1)
    for size in (0.003, 0.03, 0.3):
        tried = [shifted(gauge.rows, size * rng.standard_normal(9)) for _ in range(20)]
        assert min(total_cost(accepted, rows) for rows in tried) > gauge.cost - 0.02


def test_a_bas_relief_is_undone(egg):
    gauge = choose_map(cues_of(egg, BENT), [bas_reliefs(np.eye(3), egg.normals @ BENT.T)])
    assert error(np.eye(3), BENT, egg).mean() > 10
    assert error(gauge.rows, BENT, egg).mean() < 1
    assert all(told.accepted for told in gauge.beliefs)


def test_a_bas_relief_is_undone_by_maxima_if_lamps_differ(egg):
    strengths = np.exp(0.5 * np.random.default_rng(3).standard_normal(24))
    cues = cues_of(egg, BENT, strengths)
    lamps = strengths[:, None] * LAMPS @ np.linalg.inv(BENT)
    cues.append(DiffuseMaxima.of(egg.field(BENT), lamps))
    gauge = choose_map(cues, [bas_reliefs(np.eye(3), egg.normals @ BENT.T)])
    believed = {told.name: told.accepted for told in gauge.beliefs}
    assert not believed.pop("equal lamps")
    assert all(believed.values())
    # Maxima are found to half a pixel.
    assert error(gauge.rows, BENT, egg).mean() < 2


def test_a_cue_that_is_wrong_is_left_out_and_the_others_kept(egg, rng):
    cues = cues_of(egg, BENT)
    turned = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]])
    wide = Planted(
        rng.standard_normal((40, 9)), turned, 3 * rng.standard_normal(40), 10.0, believable=1.0
    )
    start = bas_relief(0.1, 0.1, 0.8) @ np.linalg.inv(BENT)
    gauge = choose_map([*cues, wide], [[start]])
    assert [told.accepted for told in gauge.beliefs] == [True] * len(cues) + [False]
    assert gauge.beliefs[-1].name == "planted"
    assert gauge.beliefs[-1].scale > 1
    assert error(gauge.rows, BENT, egg).mean() < 1
    # A cue that is allowed to be as wide is believed.
    allowed = choose_map([*cues, replace(wide, believable=np.inf)], [[start]])
    assert all(told.accepted for told in allowed.beliefs)


def test_answers_without_each_cue_are_kept(egg):
    cues = cues_of(egg, BENT)
    gauge = choose_map(cues, [[np.linalg.inv(BENT)]])
    # All but integrability.
    assert len(gauge.without) == len(cues) - 1
    for left_out, rows in zip(cues[1:], gauge.without, strict=True):
        others = [cue for cue in cues if cue is not left_out]
        assert total_cost(others, rows) <= total_cost(others, gauge.rows)
    # One cue beside integrability has nothing to be compared with.
    assert choose_map([cues[0], cues[-1]], [[np.linalg.inv(BENT)]]).without == ()


def test_answers_without_each_cue_spread_as_answers_do():
    """Cues that err ten times as far as their residuals tell: curvature cannot know, these do."""
    rng = np.random.default_rng(7)
    truth, count = np.linalg.inv(BENT), 12
    size = np.linalg.norm(truth) / 3
    along = (truth / np.linalg.norm(truth)).ravel()
    across = np.eye(9) - np.outer(along, along)
    moved, by_curvature, by_leaving_out = [], [], []
    for _ in range(20):
        cues = [
            Planted(
                rng.standard_normal((60, 9)),
                truth + 0.02 * rng.standard_normal((3, 3)),
                0.002 * rng.standard_normal(60),
                60.0,
                floor=0.02,
            )
            for _ in range(count)
        ]
        gauge = choose_map(cues, [[truth]])
        moved.append(across @ (gauge.rows - truth).ravel() / size)
        by_curvature.append(np.trace(across @ gauge.covariance @ across))
        steps = [across @ (rows - gauge.rows).ravel() / size for rows in gauge.without]
        by_leaving_out.append(sum((step**2).sum() for step in steps))
    spread = np.mean([(step**2).sum() for step in moved])
    assert np.mean(by_curvature) < spread / 4
    assert 0.5 < np.mean(by_leaving_out) / spread < 2


def test_another_optimum_is_a_rival_as_far_as_it_is_likely(egg):
    """Without outline, facing or typical shape, a surface and its concave counterpart are alike."""
    cues = [cue for cue in cues_of(egg, BENT) if cue.name in ("integrability", "equal lamps")]
    truth = np.linalg.inv(BENT)
    concave = np.diag([-1.0, -1.0, 1.0]) @ truth
    gauge = choose_map(cues, [[truth], [concave]])
    ((probability, rival),) = gauge.rivals
    assert probability == pytest.approx(0.5, abs=0.01)
    found = unit(egg.normals @ (rival @ BENT).T)
    chosen = unit(egg.normals @ (gauge.rows @ BENT).T)
    assert angular_errors(found, chosen * (-1, -1, 1)).max() < 0.5
    # Something that tells them apart makes the worse one less likely.
    told = [*cues, Planted(np.eye(9)[[0] * 5], truth, np.zeros(5), 1.0, floor=1.0)]
    gauge = choose_map(told, [[concave], [truth]])
    ((probability, rival),) = gauge.rivals
    apart = total_cost(told, rival) - gauge.cost
    assert 0.3 < apart < 2
    assert probability == pytest.approx(np.exp(-apart) / (1 + np.exp(-apart)))
    # Nor does any other cue tell: that is decided apart.
    every = cues_of(egg, BENT)
    assert total_cost(every, concave) == pytest.approx(total_cost(every, truth))
    sheared = bas_relief(0.2, 0.1, 0.8) @ truth
    assert choose_map(every[1:], [[truth], [sheared]]).cost < total_cost(every[1:], sheared)


def test_the_scale_of_a_structure_changes_nothing(egg):
    found = []
    for scale in (1.0, 1000.0, 1e-3):
        frame = scale * BENT
        start = bas_relief(0.1, 0.1, 0.8) @ np.linalg.inv(frame)
        gauge = choose_map(cues_of(egg, frame), [[start]])
        found.append(unit(egg.normals @ (gauge.rows @ frame).T))
        costs = [told.scale for told in gauge.beliefs]
    assert angular_errors(found[1], found[0]).max() < 0.01
    assert angular_errors(found[2], found[0]).max() < 0.01
    assert costs == pytest.approx(
        [told.scale for told in choose_map(cues_of(egg, BENT), [[np.linalg.inv(BENT)]]).beliefs],
        rel=0.05,
    )


@pytest.mark.parametrize("kind", ["cauchy", "normal"])
def test_the_covariance_is_the_spread_of_maps_over_noise(kind):
    """With a vote for each residual, as those of the planted cue err independently."""
    rng = np.random.default_rng(5)
    truth, count = np.linalg.inv(BENT), 400
    design = rng.standard_normal((count, 9))
    size = np.linalg.norm(truth) / 3
    # Its own size is held: what is found is compared across it.
    along = (truth / np.linalg.norm(truth)).ravel()
    across = np.eye(9) - np.outer(along, along)
    moved, told = [], []
    for _ in range(30):
        draws = rng.standard_cauchy(count) if kind == "cauchy" else rng.standard_normal(count)
        cue = Planted(design, truth, 0.02 * draws, count)
        gauge = choose_map([cue], [[truth]])
        moved.append(across @ (gauge.rows - truth).ravel() / size)
        told.append(across @ gauge.covariance @ across)
    spread = np.sqrt(np.trace(np.mean([np.outer(each, each) for each in moved], axis=0)))
    expected = np.sqrt(np.trace(np.mean(told, axis=0)))
    assert 0.5 < expected / spread < 2


def test_weighted_squares_of_maps_are_the_covariance(rng):
    root = 0.05 * rng.standard_normal((9, 9))
    rows = np.linalg.inv(BENT)
    covariance = root @ root.T
    gauge = Gauge(rows, 0.0, (), covariance, (), ())

    def total(maps):
        steps = [((other - rows) / (np.linalg.norm(rows) / 3)).ravel() for _, other in maps]
        return sum(
            weight * np.outer(step, step) for (weight, _), step in zip(maps, steps, strict=True)
        )

    assert np.allclose(total(spread_of_maps(gauge)), covariance)
    # Two estimates of one variance weigh a half each, and rivals as much as they are probable.
    without = tuple(rows + each for each in 0.1 * rng.standard_normal((4, 3, 3)))
    rivals = ((0.2, rows + 1.0), (0.05, rows - 1.0))
    expected = covariance / 2 + total([(0.5, each) for each in without]) + total(rivals)
    both = spread_of_maps(Gauge(rows, 0.0, (), covariance, without, rivals))
    assert np.allclose(total(both), expected)


def test_bas_reliefs_are_about_a_level_surface_of_usual_depth(egg):
    v = egg.normals @ BENT.T
    reliefs = bas_reliefs(-np.eye(3), v)
    sizes = []
    for rows in reliefs:
        b = v @ rows.T
        slopes = b[:, :2] / b[:, 2:]
        middle = np.median(slopes, axis=0)
        sizes.append((*middle, np.median(np.linalg.norm(slopes - middle, axis=1))))
        # A bas-relief of the first, which looked away.
        left = rows / rows[0, 0]
        assert left[0, :2] == pytest.approx((1, 0))
        assert left[1, :2] == pytest.approx((0, 1))
        assert left[2, :2] == pytest.approx((0, 0))
        assert b[:, 2].sum() > 0
    lean_x, lean_y, spread = np.transpose(sizes)
    assert lean_x.min() < -0.2 < 0.2 < lean_x.max()
    assert lean_y.min() < -0.2 < 0.2 < lean_y.max()
    assert spread.min() < 0.6 < 1.8 < spread.max()
    assert len(reliefs) == len({rows.tobytes() for rows in reliefs})


def test_moves_follow_their_groups(rng):
    step = 0.1 * rng.standard_normal(6)
    rows = lorentz_transformation(np.array([0.3, 0.1, -0.2, 0.5, 0.4, 1.0]))[1:]
    moved = boosted(rows, step)
    assert np.allclose(moved @ -METRIC @ moved.T, np.eye(3))
    assert np.array_equal(boosted(rows, np.zeros(6)), rows)
    assert np.array_equal(shifted(rows, np.zeros(12)), rows)
    small = shifted(rows, np.full(12, 1e-3))
    assert np.allclose(small - rows, 1e-3 * np.linalg.norm(rows) / 3)


def test_members_of_the_lorentz_group(rng):
    families = np.array(lorentz_families(rng))
    members, negatives = np.split(families, 2)
    for rows in members.reshape(-1, 3, 4):
        assert np.allclose(rows @ -METRIC @ rows.T, np.eye(3))
    assert np.array_equal(negatives, -members)
    again = lorentz_families(np.random.default_rng(20240711))
    assert np.array_equal(families, again)


def test_total_cost_is_the_sum(egg):
    cues = cues_of(egg, BENT)
    rows = np.linalg.inv(BENT)
    assert total_cost(cues, rows) == pytest.approx(sum(cost_of(cue, rows) for cue in cues))
    assert total_cost([], rows) == 0


def test_a_single_start_is_not_crowded_out(egg):
    """A family with one member is improved beside one with many."""
    truth = np.linalg.inv(BENT)
    many = [np.eye(3) + 0.01 * k * np.ones((3, 3)) for k in range(10)]
    gauge = choose_map(cues_of(egg, BENT), [many, [truth]])
    assert error(gauge.rows, BENT, egg).mean() < 1
