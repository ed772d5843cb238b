import numpy as np
import pytest
from scipy.optimize import minimize

from harmface.errors import ArgumentError
from harmface.recognition import (
    orthonormal_basis,
    pixel_blocks,
    robust_distances,
    subspace_distances,
)
from harmface.recognition.robust import FLOOR, SCALE

SHAPE = (36, 28)
BLOCKS = pixel_blocks(np.ones(SHAPE, bool))


@pytest.fixture
def bases(rng):
    return orthonormal_basis(rng.standard_normal((5, 4, 36 * 28)), 4)


def objective(light, probe, basis):
    """What is minimised, as the documentation has it."""
    own = [block[block >= 0] for block in BLOCKS]
    energies = [(probe[block] ** 2).sum() for block in own]
    left = [((probe[block] - light @ basis[:, block]) ** 2).sum() for block in own]
    tolerance = np.array(energies) + FLOOR * (probe**2).mean() * np.array(list(map(len, own)))
    share = tolerance @ np.log(1 + left / (SCALE**2 * tolerance)) / tolerance.sum()
    return SCALE * np.sqrt(share)


def test_distance_is_the_minimum_of_the_documented_sum(bases, rng, monkeypatch):
    monkeypatch.setattr("harmface.recognition.robust.STEPS", 300)
    light = 3 * rng.standard_normal((2, 4))
    probes = light @ bases[0] + 0.02 * rng.standard_normal((2, 36 * 28))
    probes[0, :100] = 0
    found = robust_distances(probes, bases[:1], BLOCKS)[:, 0]
    # The sum has several minima; light that nothing disturbs leads to the deepest here.
    best = [
        minimize(objective, own, (probe, bases[0]), tol=1e-10).fun
        for own, probe in zip(light, probes, strict=True)
    ]
    # Single precision, in a root of a difference of squares that cancel to a percent.
    assert found == pytest.approx(best, rel=2e-4)


def test_a_good_fit_is_as_far_as_by_the_plain_distance(bases, rng):
    probe = bases[:1, 0] + 1e-4 * rng.standard_normal((1, 36 * 28))
    plain = subspace_distances(probe, bases[:1])
    # The logarithm departs from its argument by half its square; the floor adds its share.
    assert robust_distances(probe, bases[:1], BLOCKS) == pytest.approx(plain, rel=0.02)


def test_a_shadow_over_half_of_the_probe_has_no_vote(bases, rng):
    light = rng.standard_normal((8, 4))
    probes = light @ bases[2] + 0.002 * rng.standard_normal((8, 36 * 28))
    probes[:, : 18 * 28] = 1e-6
    robust, plain = robust_distances(probes, bases, BLOCKS), subspace_distances(probes, bases)
    assert (robust.argmin(axis=1) == 2).all()
    assert (robust[:, 2] < 0.1).all()
    assert (plain[:, 2] > 0.4).all()


def test_pairs_are_treated_a_few_at_a_time_without_effect(bases, rng, monkeypatch):
    probes = rng.random((7, 36 * 28))
    together = robust_distances(probes, bases, BLOCKS)
    monkeypatch.setattr("harmface.recognition.robust.PROBES", 3)
    assert np.allclose(robust_distances(probes, bases, BLOCKS), together, atol=1e-5)


def test_a_subspace_of_lower_dimension_may_be_padded(bases, rng):
    probes = rng.random((3, 36 * 28))
    padded = np.pad(bases, ((0, 0), (0, 2), (0, 0)))
    plain, more = (robust_distances(probes, each, BLOCKS) for each in (bases, padded))
    assert np.allclose(plain, more, atol=1e-5)


def test_blocks_share_out_the_pixels_of_the_mask(rng):
    mask = rng.random((35, 20)) < 0.5
    blocks = pixel_blocks(mask)
    assert sorted(blocks[blocks >= 0]) == list(range(mask.sum()))
    rows, columns = np.nonzero(mask)
    for block in blocks:
        own = block[block >= 0]
        assert np.ptp(rows[own]) <= 2
        assert np.ptp(columns[own]) <= 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pixel_blocks(np.zeros((3, 3), bool)), "mask must leave some pixels"),
        (lambda: robust_distances(np.ones((1, 3)), np.ones((1, 1, 4)), BLOCKS[:1]), "4 pixels"),
        (lambda: robust_distances(np.zeros((1, 4)), np.ones((1, 1, 4)), BLOCKS[:1]), "all black"),
    ],
)
@pytest.mark.usefixtures("unchecked")
def test_nonsense_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
