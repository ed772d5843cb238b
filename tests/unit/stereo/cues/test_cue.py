"""The scale of a cue against a direct search for the likeliest one."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from harmface.stereo.cues import Cue, cost_of, scale_of


@dataclass(frozen=True)
class Given:
    """A cue whose residuals do not depend on the map."""

    values: np.ndarray
    floor: float = 0.0
    votes: float = 7.0
    believable: float = 1.0
    name: str = "given"

    def residuals(self, rows):
        return self.values


def cost_at(scale, residuals):
    return np.log(scale) + np.log1p((residuals / scale) ** 2).mean()


def likeliest(residuals):
    return np.exp(
        minimize_scalar(
            lambda log: cost_at(np.exp(log), residuals), bracket=(-3, 1), options={"xtol": 1e-10}
        ).x
    )


@pytest.mark.parametrize("true", [1e-3, 0.2, 30.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_scale_is_the_likeliest(true, seed):
    residuals = true * np.random.default_rng(seed).standard_cauchy(500)
    found = scale_of(residuals, 0.0)
    # Each step takes half of what is missing, and the median misses a tenth: 10 % / 2^5.
    assert found == pytest.approx(likeliest(residuals), rel=0.1 / 2**5)
    # 500 draws know the scale to sqrt(2 / 500).
    assert found == pytest.approx(true, rel=3 * np.sqrt(2 / 500))


def test_the_scale_of_other_residuals_is_not_their_median(rng):
    """Uniform ones, with none in the tails, are likeliest at a scale of 0.43, not 0.5."""
    residuals = rng.uniform(-1, 1, 4000)
    best = likeliest(residuals)
    assert abs(np.median(np.abs(residuals)) - best) > 0.04
    # The steps halve what the median misses, or better.
    assert scale_of(residuals, 0.0) == pytest.approx(best, rel=0.15 / 2**3)


def test_the_scale_stays_above_its_floor(rng):
    residuals = 0.01 * rng.standard_cauchy(200)
    assert scale_of(residuals, 0.5) == 0.5
    assert scale_of(np.zeros(9), 0.25) == 0.25
    assert scale_of(np.zeros(9), 0.0) > 0


def test_the_cost_is_that_of_the_likeliest_scale(rng):
    cue = Given(0.3 * rng.standard_cauchy(300))
    assert isinstance(cue, Cue)
    best = cost_at(likeliest(cue.values), cue.values)
    # The cost is flat at the likeliest scale: second order in what the scale misses.
    assert cost_of(cue, np.eye(3)) == pytest.approx(7 * best, abs=7 * 1e-4)
    assert cost_of(Given(cue.values, votes=14.0), np.eye(3)) == pytest.approx(14 * best, abs=2e-3)


def test_beyond_its_floor_a_cue_cannot_gain():
    near, nearer = Given(np.full(9, 1e-6), floor=0.1), Given(np.full(9, 1e-9), floor=0.1)
    assert cost_of(near, np.eye(3)) == pytest.approx(7 * np.log(0.1), abs=1e-8)
    assert cost_of(near, np.eye(3)) == pytest.approx(cost_of(nearer, np.eye(3)), abs=1e-8)
