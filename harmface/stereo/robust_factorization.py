"""Factorisation that a few wrong observations (cast shadows, highlights) cannot bend.

References
----------
.. [HW77] Holland and Welsch, Robust Regression Using Iteratively Reweighted Least-Squares,
   Communications in Statistics 1977.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.factorization import factorize
from harmface.stereo.robust import point_source_weights

ROUNDS = 30
"""Times that observations are weighed anew; weights settle in ten, and
missing observations in thirty."""


COOLING = 0.7
"""Fall of the least scale with each round: strict at once, weights would lock in a poor start."""


@dataclass(frozen=True, eq=False)
class RobustFactorization:
    """`M ~ light @ structure` where the weights are high.

    Parameters
    ----------
    light, structure
        The factors.
    weights
        How much each observation counted, in [0, 1].
    """

    light: Float[np.ndarray, "F K"]
    structure: Float[np.ndarray, "K p"]
    weights: Float[np.ndarray, "F p"]


def factorize_robustly(
    values: Float[np.ndarray, "F p"], rank: int, usable: Bool[np.ndarray, "F p"] | None = None
) -> RobustFactorization:
    """Return `L S` that highlights and shadows do not bend ([HW77]_).

    Each round weighs every observation by its residual over a robust scale of all of them, see
    `point_source_weights`, and solves the weighted least squares for S and then for L: each is a
    small system a pixel or an image. Observations that are not usable have no weight at all.

    Parameters
    ----------
    values
        Images as rows of pixels.
    rank
        Dimensions to keep.
    usable
        Observations that may count; all if not given.

    Returns
    -------
    RobustFactorization
        Light (F, rank), structure (rank, p), and each observation's weight (F, p).

    Raises
    ------
    ArgumentError
        On NaN, or fewer images or pixels than dimensions.
    """
    lit = np.ones(values.shape, bool) if usable is None else usable
    start = factorize(values, rank)
    light, structure = start.light, start.structure
    weights = lit.astype(np.float64)
    least = float(np.std((values - light @ structure)[lit]))
    for _ in range(ROUNDS):
        weights = point_source_weights(values, light @ structure, lit, least=least)
        least *= COOLING
        structure = weighted_solve(light, weights, values)
        light = weighted_solve(structure.T, weights.T, values.T).T
    return RobustFactorization(light, structure, weights)


def weighted_solve(
    design: Float[np.ndarray, "n K"],
    weights: Float[np.ndarray, "n p"],
    values: Float[np.ndarray, "n p"],
) -> Float[np.ndarray, "K p"]:
    """Return for each column the x that minimises `sum_i w_i (v_i - design_i x)^2`.

    The K x K normal equations of all columns come from one matrix product; a trace of their
    mean on the diagonal keeps columns with too few observations solvable.
    """
    size = design.shape[1]
    squares = np.einsum("ni,nj->nij", design, design).reshape(len(design), -1)
    normal = (weights.T @ squares).reshape(-1, size, size)
    ridge = np.finfo(np.float64).eps * np.trace(normal.mean(axis=0)) + np.finfo(np.float64).tiny
    normal += ridge * np.eye(size)
    moments = (weights * values).T @ design
    return np.linalg.solve(normal, moments[..., None])[..., 0].T
