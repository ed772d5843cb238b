"""Light near a few points of space: coefficients with their gradients, and what lies between.

References
----------
.. [AKDS04] Annen, Kautz, Durand and Seidel, Spherical Harmonic Gradients for Mid-Range
   Illumination, EGSR 2004.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError

EXPONENT = 4.0
"""Of the distance, in the weights of several probes; [AKDS04]_ leaves it open. Above 3, as the
number of probes within a distance grows with its cube: then those far away do not outweigh the
near ones however many there are."""


@dataclass(frozen=True, eq=False)
class Probes:
    """Lighting coefficients at points, and how they change from there.

    Parameters
    ----------
    positions
        Where each of `P` probes stands.
    coefficients
        Lighting coefficients of each.
    gradients
        Their derivatives by x, y and z of the place.

    Raises
    ------
    ArgumentError
        If a shape is another, or a value is not finite.
    """

    positions: Float[np.ndarray, "P 3"]
    coefficients: Float[np.ndarray, "P *channels_K"]
    gradients: Float[np.ndarray, "P *channels_K_3"]

    def __post_init__(self) -> None:
        positions = checks.finite("positions", checks.vectors("positions", self.positions))
        coefficients = checks.finite("coefficients", self.coefficients)
        gradients = checks.finite("gradients", self.gradients)
        if (
            positions.ndim != 2
            or coefficients.ndim < 2
            or len(positions) != len(coefficients)
            or gradients.shape != (*coefficients.shape, 3)
        ):
            raise ArgumentError(
                "positions (P, 3), coefficients (P, ..., K) and gradients (P, ..., K, 3) must "
                f"agree, got shapes {positions.shape}, {coefficients.shape} and {gradients.shape}"
            )
        max_degree_of(coefficients.shape[-1])
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "coefficients", coefficients)
        object.__setattr__(self, "gradients", gradients)

    def __add__(self, other: "Probes") -> "Probes":
        """Return the light of both together, at the same points."""
        if not np.array_equal(self.positions, other.positions):
            raise ArgumentError("positions of light that is added must be the same")
        return Probes(
            self.positions,
            self.coefficients + other.coefficients,
            self.gradients + other.gradients,
        )

    def at(
        self,
        points: Float[np.ndarray, "N 3"],
        *,
        gradient: bool = True,
        exponent: float = EXPONENT,
    ) -> Float[np.ndarray, "N *channels_K"]:
        """Return the coefficients at other points, [AKDS04]_ eq. 14-16.

        Each probe is carried to a point by its gradient, `c + grad c . d`, and those of several
        are weighted by `1 / distance**exponent`; a point where a probe stands has that probe's.

        Parameters
        ----------
        points
            Where.
        gradient
            Without it probes are as they stand, as before that paper.
        exponent
            Above 0: small for smooth mixtures, large for the nearest probe alone.

        Returns
        -------
        numpy.ndarray
            Coefficients of radiance, `(N, *channels, K)`.

        Raises
        ------
        ArgumentError
            If a point is not finite or the exponent not positive.
        """
        points = checks.finite("points", checks.vectors("points", points))
        if not exponent > 0:
            raise ArgumentError(f"exponent must be above 0, got {exponent}")
        offsets = points[:, None] - self.positions
        weights = inverse_distance_weights(np.linalg.norm(offsets, axis=-1), exponent)
        result = np.tensordot(weights, self.coefficients, axes=1)
        if gradient:
            steps = (weights[..., None] * offsets).reshape(len(points), -1)
            slopes = np.moveaxis(self.gradients, -1, 1)
            result += np.tensordot(steps, slopes.reshape(-1, *slopes.shape[2:]), axes=1)
        return result

    def thinned(self, count: int, *, exponent: float = EXPONENT) -> "Probes":
        """Return the few probes that tell the light at the places of all best, the best first.

        Each new one is that with which the squared error of `at`, over all places, becomes least:
        the first ones of a longer choice are a shorter choice.

        Parameters
        ----------
        count
            How many, at most all.
        exponent
            Of the distance, as for `at`.

        Returns
        -------
        Probes
            Some of these.

        Raises
        ------
        ArgumentError
            If the count is not from 1 to the number of probes, or the exponent not positive.
        """
        if checks.positive_integer("count", count) > len(self.positions):
            raise ArgumentError(
                f"count must be at most the {len(self.positions)} probes there are, got {count}"
            )
        chosen: list[int] = []
        for _ in range(count):
            others = [i for i in range(len(self.positions)) if i not in chosen]
            errors = [
                np.square(
                    self._some([*chosen, i]).at(self.positions, exponent=exponent)
                    - self.coefficients
                ).sum()
                for i in others
            ]
            chosen.append(others[int(np.argmin(errors))])
        return self._some(chosen)

    def _some(self, which: list[int]) -> "Probes":
        return Probes(self.positions[which], self.coefficients[which], self.gradients[which])


def inverse_distance_weights(
    distances: Float[np.ndarray, "N P"], exponent: float
) -> Float[np.ndarray, "N P"]:
    """Return the weights of [AKDS04]_ eq. 16, which sum to 1; all for a probe at distance 0."""
    nearest = distances.min(axis=1, keepdims=True)
    # Over the nearest's distance no power overflows; there 0 / 0 counts 1.
    ratios = np.divide(nearest, distances, out=np.ones_like(distances), where=distances > 0)
    weights = ratios**exponent
    return weights / weights.sum(axis=1, keepdims=True)


def farthest_points(candidates: Float[np.ndarray, "N 3"], count: int) -> Float[np.ndarray, "P 3"]:
    """Return places for probes: each new one is the candidate farthest from those before.

    Parameters
    ----------
    candidates
        Points of the object, such as its vertices.
    count
        Number of probes; the first stands at the candidates' mean.

    Returns
    -------
    numpy.ndarray
        Shape (count, 3).

    Raises
    ------
    ArgumentError
        If the count is below 1 or a candidate not finite.

    Examples
    --------
    >>> farthest_points(np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0]]), 2)
    array([[2., 0., 0.],
           [5., 0., 0.]])
    """
    candidates = checks.finite("candidates", checks.vectors("candidates", candidates))
    chosen = [candidates.mean(axis=0)]
    nearest = np.full(len(candidates), np.inf)
    for _ in range(checks.positive_integer("count", count) - 1):
        nearest = np.minimum(nearest, np.linalg.norm(candidates - chosen[-1], axis=1))
        chosen.append(candidates[nearest.argmax()])
    return np.stack(chosen)
