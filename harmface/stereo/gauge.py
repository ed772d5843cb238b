"""The gauge: which of the maps that images leave open gives the surface.

What a factorisation leaves open is a group: every linear map of scaled normals under point sources
(nine numbers), or the Lorentz transformations of harmonic structure (six). Cues choose among them,
see `cues`: the map is the one of least total cost. Integrability leaves a bas-relief family,
`(b_x + mu b_z, b_y + nu b_z, lambda b_z)` ([BKY99]_), over which the search begins; then all
numbers are improved together. A cue that does not hold at the result, by its own test, is left out
and the search repeated.

How far the answer is to be trusted is told twice, and the mean variance is taken: by the curvature
of the cost at the optimum, which is right if cues err as they are taken to; and by the answers
without each of the cues in turn, whose squared distances from the answer with all add up to its
variance whatever the cues' errors are, as far as a handful of cues can show it (the jackknife,
[ES81]_). Rival optima add theirs, each as far as its likelihood goes.

References
----------
.. [BKY99] Belhumeur, Kriegman and Yuille, The Bas-Relief Ambiguity, IJCV 1999.
.. [ES81] Efron and Stein, The Jackknife Estimate of Variance, Annals of Statistics 1981.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from harmface.stereo.cues import Cue, Integrability, Rows, cost_of, scale_of
from harmface.stereo.lorentz import lorentz_transformation

Move = Callable[[Rows, Float[np.ndarray, "g"]], Rows]
"""From rows and a small step in the group's numbers to the rows nearby."""

TILTS = np.linspace(-0.6, 0.6, 7)
STRETCHES = np.exp(np.linspace(-0.8, 0.6, 6))
"""Bas-relief transformations of a surface of mean slope zero and of spread one that are tried."""

STARTS = 3
"""Best members of a family that are improved."""

ALIKE = 0.05
"""Angle between maps, as vectors of their entries, below which one optimum is meant: 3 degrees."""

TRIED = 300
"""Random members of the Lorentz group that are tried: neighbours are some 25 degrees apart."""

PARTS = 5
"""Families that these members are parted into: three still miss the best optimum now and then."""

RAPIDITY = 0.6
"""Spread of random boosts; 0.6 turns a normal across the boost by 33 degrees."""

ROUNDS = 8
FEW_ROUNDS = 2
"""Times that scales and map are found in turn, and where a rough answer will do."""

EVALUATIONS = 4
"""Least-squares steps with the scales held."""

SETTLED = 0.01
"""Fall of the cost that makes no difference: a likelihood ratio of one percent."""

CONCAVE = np.diag([-1.0, -1.0, 1.0])
"""From a surface to its concave counterpart, which under light turned likewise looks the same."""

LAGGING = 3.0
"""Cost above the best, after a few rounds, from which a start is given up: an optimum there would
be as likely as one in twenty."""


@dataclass(frozen=True, eq=False)
class Belief:
    """What became of a cue.

    Parameters
    ----------
    name
        Of the cue.
    scale
        That was learned, in the unit of its residuals.
    accepted
        Whether its scale is one that it may have.
    """

    name: str
    scale: float
    accepted: bool


@dataclass(frozen=True, eq=False)
class Gauge:
    """The map that cues chose, and how sure it is.

    Parameters
    ----------
    rows
        T of `b = T v`.
    cost
        Of the accepted cues.
    beliefs
        What became of each cue.
    covariance
        Of a relative change of the entries of T, by the curvature of the cost.
    without
        Maps chosen without each of the cues in turn.
    rivals
        Maps at other optima, with their probabilities.
    """

    rows: Rows
    cost: float
    beliefs: tuple[Belief, ...]
    covariance: Float[np.ndarray, "n n"]
    without: tuple[Rows, ...]
    rivals: tuple[tuple[float, Rows], ...]


def boosted(rows: Rows, step: Float[np.ndarray, "6"]) -> Rows:
    """Follow a small Lorentz transformation."""
    return rows @ lorentz_transformation(step)


def shifted(rows: Rows, step: Float[np.ndarray, "g"]) -> Rows:
    """Add a small matrix, relative to the size of the rows."""
    return np.asarray(rows + step.reshape(rows.shape) * (np.linalg.norm(rows) / 3))


def total_cost(cues: Sequence[Cue], rows: Rows) -> float:
    """Return the cost of a map: differences of a few units count."""
    return sum(cost_of(cue, rows) for cue in cues)


def choose_map(
    cues: Sequence[Cue], families: Sequence[Sequence[Rows]], move: Move = shifted
) -> Gauge:
    """Return the map of least cost near some starts.

    Parameters
    ----------
    cues
        What is known.
    families
        Members of the group to start from. The most promising of each family are improved: the many
        of one would crowd out the single one of another.
    move
        How the group is followed.
    """
    found, accepted = _believed(cues, families, move)
    cost, rows = found[0]
    likelihoods = np.exp([cost - other for other, _ in found])
    probabilities = likelihoods / likelihoods.sum()
    # What integrability says is not in question, and without it there is no surface.
    questioned = [cue for cue in accepted if not isinstance(cue, Integrability)]
    without = [
        improved([cue for cue in accepted if cue is not left_out], rows, move)[1]
        for left_out in questioned
        if len(questioned) > 1
    ]
    return Gauge(
        rows,
        cost,
        tuple(Belief(cue.name, _scale(cue, rows), cue in accepted) for cue in cues),
        _covariance(accepted, rows),
        tuple(without),
        tuple(
            (float(probability), other)
            for probability, (_, other) in zip(probabilities[1:], found[1:], strict=True)
        ),
    )


def rough_map(cues: Sequence[Cue], families: Sequence[Sequence[Rows]]) -> Rows:
    """Return the map that `choose_map` chooses, to begin a fit with: its doubts are not asked."""
    return _believed(cues, families, shifted, FEW_ROUNDS)[0][0][1]


def bas_reliefs(rows: Rows, structure: Float[np.ndarray, "p d"]) -> list[Rows]:
    """Return bas-relief transformations of a map.

    They are spread about the one whose slopes have mean zero and spread one, by medians.
    """
    b = structure @ rows.T
    rows = rows * np.array([1, 1, np.sign(b[:, 2].sum())])[:, None]
    b = structure @ rows.T
    towards = b[:, 2] > 1e-3 * np.linalg.norm(b, axis=1)
    slopes = b[towards, :2] / b[towards, 2:]
    middle = np.median(slopes, axis=0)
    # The median length of the slopes of a hemisphere is one.
    spread = np.median(np.linalg.norm(slopes - middle, axis=1))
    level = np.array([[1, 0, -middle[0]], [0, 1, -middle[1]], [0, 0, spread]]) @ rows
    return [
        np.array([[1, 0, mu], [0, 1, nu], [0, 0, stretch]]) @ level
        for stretch in STRETCHES
        for mu in TILTS
        for nu in TILTS
    ]


def lorentz_families(rng: np.random.Generator) -> list[list[Rows]]:
    """Return the last three rows of random Lorentz transformations, and of their negatives.

    The frame that null vectors come in is of unknown parity. Six numbers have many optima, so the
    members of each parity are several families, of each of which the best are followed.
    """
    turns = Rotation.random(TRIED, random_state=rng).as_rotvec()
    parameters = np.concatenate([rng.normal(0, RAPIDITY, (TRIED, 3)), turns], axis=1)
    members = [lorentz_transformation(each)[1:] for each in parameters]
    families = [members[k::PARTS] for k in range(PARTS)]
    return families + [[-rows for rows in family] for family in families]


def improved(
    cues: Sequence[Cue], rows: Rows, move: Move = shifted, rounds: int = ROUNDS
) -> tuple[float, Rows]:
    """Return the cost and map that descent from a start reaches.

    The scales, and the map for these scales, are found in turn: both lower the cost.
    """
    size = 6 if move is boosted else rows.size
    cost = total_cost(cues, rows)
    for _ in range(rounds):
        scales = [_scale(cue, rows) for cue in cues]

        def weighed(
            step: Float[np.ndarray, "g"], from_rows: Rows = rows, by: list[float] = scales
        ) -> Float[np.ndarray, "n"]:
            trial = move(from_rows, step)
            # The size of the map moves nothing, and is held.
            grown = np.log(np.linalg.norm(trial) / np.linalg.norm(from_rows))
            return np.concatenate([_flattened(cues, trial, by), [grown]])

        fit = least_squares(weighed, np.zeros(size), max_nfev=EVALUATIONS, xtol=1e-4)
        trial = move(rows, fit.x)
        trial_cost = total_cost(cues, trial)
        if not trial_cost < cost:
            break
        settled = cost - trial_cost < SETTLED
        rows, cost = trial, trial_cost
        if settled:
            break
    return cost, rows


def spread_of_maps(gauge: Gauge) -> list[tuple[float, Rows]]:
    """Return maps whose weighted squared distances from the chosen one add up to its variance.

    One standard deviation along each axis of the covariance and the answers without each cue are
    two estimates of one variance, and weigh a half. Rivals weigh as much as they are probable.

    Parameters
    ----------
    gauge
        The chosen map and its doubts.
    """
    variances, axes = np.linalg.eigh(gauge.covariance)
    steps = (axes * np.sqrt(np.maximum(variances, 0))).T
    share = 0.5 if gauge.without else 1.0
    return [
        *((share, shifted(gauge.rows, step)) for step in steps),
        *((share, rows) for rows in gauge.without),
        *gauge.rivals,
    ]


def alike(rows: Rows, other: Rows) -> bool:
    """Return whether two maps are about the same, their size aside."""
    cosine = (rows * other).sum() / (np.linalg.norm(rows) * np.linalg.norm(other))
    return bool(cosine > np.cos(ALIKE))


def _believed(
    cues: Sequence[Cue], families: Sequence[Sequence[Rows]], move: Move, rounds: int = ROUNDS
) -> tuple[list[tuple[float, Rows]], list[Cue]]:
    """Return the optima by the cues that hold at the best of them, and these cues."""
    accepted = list(cues)
    while True:
        found = _optima(accepted, families, move, rounds)
        held = [cue for cue in accepted if _scale(cue, found[0][1]) <= cue.believable]
        if len(held) == len(accepted):
            return found, accepted
        accepted = held


def _optima(
    cues: Sequence[Cue], families: Sequence[Sequence[Rows]], move: Move, rounds: int
) -> list[tuple[float, Rows]]:
    """Return the optima reached from the most promising starts, the best first."""
    found = []
    for family in families:
        costs = np.array([total_cost(cues, rows) for rows in family])
        best = np.argsort(costs, kind="stable")[:STARTS]
        found += [improved(cues, family[k], move, FEW_ROUNDS) for k in best]
    found.sort(key=lambda each: each[0])
    optima: list[tuple[float, Rows]] = []
    for cost, rows in found:
        # Those that lag far behind will not catch up, and those beside an optimum lead there.
        if cost < found[0][0] + LAGGING and not any(alike(rows, other) for _, other in optima):
            optima.append(improved(cues, rows, move, rounds))
    return sorted(optima, key=lambda each: each[0])


def _scale(cue: Cue, rows: Rows) -> float:
    return scale_of(cue.residuals(rows), cue.floor)


def _flattened(cues: Sequence[Cue], rows: Rows, scales: Sequence[float]) -> Float[np.ndarray, "n"]:
    """Return numbers whose squares sum to the cost at fixed scales, but for a constant."""
    parts = []
    for cue, scale in zip(cues, scales, strict=True):
        residuals = cue.residuals(rows)
        ratio = residuals / scale
        root = np.sqrt(np.log1p(ratio**2) * (cue.votes / len(ratio)))
        parts.append(np.copysign(root, ratio))
    return np.concatenate(parts)


def _covariance(cues: Sequence[Cue], rows: Rows) -> Float[np.ndarray, "n n"]:
    """Return the covariance of a relative change of the rows' entries.

    Fisher's information of a Cauchy residual of scale s is `1 / (2 s^2)`. With the weights
    `w = 1 / (1 + (r / s)^2)`, whose mean is a half, it is `votes / (s^2 n) sum w dr dr'`, and its
    inverse is the covariance.
    """
    step = 1e-6
    moves = step * np.eye(rows.size)
    curvature = np.eye(rows.size)
    for cue in cues:
        here = cue.residuals(rows)
        scale = scale_of(here, cue.floor)
        slope = np.stack([cue.residuals(shifted(rows, move)) - here for move in moves]) / step
        weight = cue.votes / len(here) / scale**2 / (1 + (here / scale) ** 2)
        curvature += (slope * weight) @ slope.T
    return np.asarray(np.linalg.inv(curvature))
