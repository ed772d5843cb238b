"""Search of a group of linear maps for the member that fits the cues.

What a factorisation leaves open is a group: the Lorentz transformations of harmonic structure
(six numbers), or every linear map of scaled normals, which light that is general enough allows
(nine). The cost is not convex, so many members are tried and the best few are improved.

References
----------
.. [M78] Moré, The Levenberg-Marquardt Algorithm: Implementation and Theory, 1978.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation

from harmface import checks
from harmface.stereo.cues import Cues
from harmface.stereo.lorentz import lorentz_transformation

Rows = Float[np.ndarray, "3 d"]
Move = Callable[[Rows, Float[np.ndarray, "g"]], Rows]
"""From rows and a small step in the group's parameters to the rows nearby."""

TRIED = 300
"""Members tried at random: neighbours are about 25 degrees apart for rotations."""

IMPROVED = 4
"""Best members of those tried that are improved."""

RAPIDITY = 0.6
"""Spread of random boosts; 0.6 turns a normal across the boost by 33 degrees."""

STEPS = 40
TRIAL_STEPS = 15
"""Steps after which it shows which of several members will be the best."""

DIFFERENCE = 1e-6

CONCAVE = np.diag([-1.0, -1.0, 1.0])


def boosted(rows: Rows, step: Float[np.ndarray, "6"]) -> Rows:
    """Follow a small Lorentz transformation."""
    return rows @ lorentz_transformation(step)


def shifted(rows: Rows, step: Float[np.ndarray, "g"]) -> Rows:
    """Add a small matrix, relative to the size of the rows."""
    return rows + step.reshape(rows.shape) * (np.linalg.norm(rows) / 3)


def best_lorentz(cues: Cues, starts: Iterable[Rows], rng: np.random.Generator | int) -> Rows:
    """Return the last three rows of the Lorentz transformation that fits the cues.

    Parameters
    ----------
    cues
        Of null vectors (|b|, b).
    starts
        Rows of transformations to try too, from a closed form.
    rng
        Draws the members tried.
    """
    rng = checks.generator(rng)
    turns = Rotation.random(TRIED, random_state=rng).as_rotvec()
    parameters = np.concatenate([rng.normal(0, RAPIDITY, (TRIED, 3)), turns], axis=1)
    tried = [lorentz_transformation(each)[1:] for each in parameters]
    return best_of(cues, [*starts, *tried], boosted, 6)


def best_rotation(
    cues: Cues, frame: Float[np.ndarray, "3 3"], rng: np.random.Generator | int
) -> Rows:
    """Return the map that fits the cues, of those that turn or mirror a frame.

    Parameters
    ----------
    cues
        Of structure of three dimensions.
    frame
        A map that is right but for a rotation or reflection.
    rng
        Draws the rotations tried.
    """
    turns = Rotation.random(TRIED, random_state=checks.generator(rng)).as_matrix()
    return best_of(cues, [sign * turn @ frame for turn in turns for sign in (-1, 1)], shifted, 9)


def best_linear(cues: Cues, starts: Iterable[Rows]) -> Rows:
    """Return the linear map of structure that fits the cues, near some starts.

    Parameters
    ----------
    cues
        Of structure of three dimensions, or four.
    starts
        Maps to begin with; bas-relief transformations of each, and of its concave counterpart,
        are tried as well.
    """
    families = [reliefs(rows) for start in starts for rows in (start, CONCAVE @ start)]
    return best_of_families(cues, families, shifted, families[0][0].size)


def reliefs(rows: Rows) -> list[Rows]:
    """Return bas-relief transformations of rows that are known up to one."""
    return [
        sign * np.array([[1, 0, mu], [0, 1, nu], [0, 0, flatten]]) @ rows
        for flatten in (0.4, 0.7, 1.0, 1.5, 2.5)
        for mu in (-0.6, -0.3, 0.0, 0.3, 0.6)
        for nu in (-0.6, -0.3, 0.0, 0.3, 0.6)
        for sign in (-1, 1)
    ]


def best_of(cues: Cues, tried: list[Rows], move: Move, parameters: int) -> Rows:
    """Return the best of the members tried, the most promising ones improved."""
    return best_of_families(cues, [tried], move, parameters)


def best_of_families(cues: Cues, families: list[list[Rows]], move: Move, parameters: int) -> Rows:
    """Return the best member of all, the most promising ones of each family improved.

    The many of one family would crowd out the single one of another.
    """
    trials = [
        improved(cues, tried[k], move, parameters, TRIAL_STEPS)
        for tried in families
        for k in np.argsort(cues.costs(np.stack(tried)), kind="stable")[:IMPROVED]
    ]
    return improved(cues, min(trials, key=cues.cost), move, parameters)


def improved(cues: Cues, rows: Rows, move: Move, parameters: int, steps: int = STEPS) -> Rows:
    """Return the member that damped Gauss-Newton reaches ([M78]_), residuals reweighted."""
    damping, cost = 1e-2, cues.cost(rows)
    system = None
    for _ in range(steps):
        if system is None:
            near = linearized(cues, rows, move, parameters)
            system = near.curvature, near.slope @ near.pull
        normal, right = system
        ridge = damping * (np.diag(normal) + 1e-9 * np.trace(normal))
        step = np.linalg.solve(normal + np.diag(ridge), -right)
        # Steps of more than about 30 degrees leave the range of the linearisation.
        step *= min(1.0, 0.5 / max(np.linalg.norm(step), np.finfo(np.float64).tiny))
        trial = move(rows, step)
        trial_cost = cues.cost(trial)
        if trial_cost < cost:
            settled = cost - trial_cost < 1e-3
            rows, cost, system, damping = trial, trial_cost, None, max(damping / 5, 1e-9)
            if settled:
                break
        else:
            damping *= 6
            if damping > 1e9:
                break
    return rows


@dataclass(frozen=True, eq=False)
class Linearized:
    """Cues about a member, by the parameters of a move.

    Parameters
    ----------
    slope
        Derivatives of the residuals.
    pull
        Derivative of the cost by each residual: `w r / (1 + r^2)`.
    weight
        Of the squares that fall as the logarithms of the cost do: `w / (1 + r^2)`.
    region
        Where each residual comes from, see `Evidence`.
    """

    slope: Float[np.ndarray, "g r"]
    pull: Float[np.ndarray, "r"]
    weight: Float[np.ndarray, "r"]
    region: Int[np.ndarray, "r"]

    @property
    def curvature(self) -> Float[np.ndarray, "g g"]:
        """The second derivative of the cost, as Gauss and Newton have it."""
        return np.asarray((self.slope * self.weight) @ self.slope.T)


def linearized(cues: Cues, rows: Rows, move: Move, parameters: int) -> Linearized:
    """Return how the cues change with a move."""
    steps = DIFFERENCE * np.eye(parameters)
    said = cues.evidence(np.stack([rows, *(move(rows, step) for step in steps)]))
    residual = said.residual[0]
    slope = (said.residual[1:] - residual) / DIFFERENCE
    weight = said.weight / (1 + residual**2)
    return Linearized(slope, weight * residual, weight, said.region)
