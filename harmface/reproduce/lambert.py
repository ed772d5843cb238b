"""Claims on Lambert's transfer function: its coefficients, decay, energy and truncation error."""

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.special import eval_legendre

from harmface.reflectance import energy_by_degree, lambert_coefficients, mean_accuracy_bound
from harmface.reproduce.experiment import Measurement
from harmface.sphere import random_directions


def coefficients() -> Measurement:
    """Hold the closed form of A_l against `2 pi int_0^1 P_l(u) u du` (R05 eq. 26)."""
    closed = lambert_coefficients(6)
    numeric = np.array(
        [2 * np.pi * quad(lambda u, n=n: eval_legendre(n, u) * u, 0, 1)[0] for n in range(7)]
    )
    published = np.array([3.141593, 2.094395, 0.785398, 0.0, -0.130900, 0.0, 0.049087])
    # The worse of the two is what is judged, so that neither can be wrong unseen.
    worse = np.where(abs(closed - published) > abs(numeric - published), closed, numeric)
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    axes.axhline(0, color="0.7", lw=0.8)
    axes.stem(np.arange(21), lambert_coefficients(20), basefmt=" ")
    axes.set(xlabel="degree $l$", ylabel="$A_l$", xticks=range(0, 21, 2))
    return Measurement(
        worse.tolist(),
        "Closed form and adaptive quadrature differ by at most "
        f"{np.abs(closed - numeric).max():.1e}; the worse of the two is shown.",
        {"Lambert's transfer function by degree, as R05 figure 7.": figure},
    )


def decay() -> Measurement:
    """Fit the slope of log |A_l| over even degrees from 20 to 200."""
    degrees = np.arange(20, 201, 2)
    magnitude = np.abs(lambert_coefficients(200)[degrees])
    slope, offset = np.polyfit(np.log(degrees), np.log(magnitude), 1)
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    axes.loglog(degrees, magnitude, "o", ms=3, label="$|A_l|$, even $l$")
    axes.loglog(degrees, np.exp(offset) * degrees**slope, lw=1, label=f"slope {slope:.3f}")
    axes.set(xlabel="degree $l$")
    axes.legend(frameon=False)
    return Measurement(
        [float(slope)],
        "Least squares on logarithms, every even degree the same weight.",
        {"Decay of the transfer function.": figure},
    )


def energy() -> Measurement:
    """Sum the clamped cosine's energy over degrees."""
    cumulative = np.cumsum(energy_by_degree(4))[[0, 1, 2, 4]]
    return Measurement(
        cumulative.tolist(), "Energy of max(cos, 0) over the sphere is 2 pi / 3 in all."
    )


def worst_pixel() -> Measurement:
    """Search the largest error of the degree-2 clamped cosine over 200,001 angles."""
    cosine = np.linspace(-1, 1, 200_001)
    shares = lambert_coefficients(2) * (2 * np.arange(3) + 1) / (4 * np.pi)
    approximate = sum(share * eval_legendre(n, cosine) for n, share in enumerate(shares))
    error = approximate - np.maximum(cosine, 0)
    worst = np.abs(error).argmax()
    axes = (figure := Figure(figsize=(6, 3))).add_subplot()
    angle = np.degrees(np.arccos(cosine))
    axes.plot(angle, np.maximum(cosine, 0), label="clamped cosine")
    axes.plot(angle, approximate, label="degree 2")
    axes.plot(angle, error, label="error", lw=1)
    axes.set(xlabel="angle between normal and light, degrees")
    axes.legend(frameon=False)
    return Measurement(
        [float(np.abs(error[worst]))],
        f"Reached at {angle[worst]:.1f} degrees; a single directional light is the worst case.",
        {"The clamped cosine and its degree-2 approximation, as R05 figure 8.": figure},
    )


def non_negative_bound(lights: int = 10_000, seed: int = 0) -> Measurement:
    """Search 10,000 non-negative lights for the worst average accuracy of degree 2.

    A light of a few directions w_i with powers e_i has, in degree l, the energy
    `sum_ij e_i e_j (2l + 1) / (4 pi) P_l(w_i . w_j)` (addition theorem), which irradiance weighs
    by A_l^2. Half of the lights are random, and half nearly regular: the corners of a rotated
    octahedron or cube with jitter, which almost lack degrees 1 and 2 and come close to the bound.
    """
    degree = 80
    rng = np.random.default_rng(seed)
    weight = lambert_coefficients(degree) ** 2 * (2 * np.arange(degree + 1) + 1)
    corners = {
        6: np.concatenate([np.eye(3), -np.eye(3)]),
        8: np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T / np.sqrt(3),
    }
    least = 1.0
    for number in range(lights):
        if number % 2:
            count = int(rng.choice([6, 8]))
            directions = corners[count] + rng.uniform(0, 0.2) * rng.standard_normal((count, 3))
            directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
            power = 1 + rng.uniform(0, 0.3) * rng.random(count)
        else:
            count = int(rng.integers(1, 9))
            directions, power = random_directions(count, rng), rng.random(count)
        # The Gram matrix is all that matters, so no rotation is needed.
        cosines = np.clip(directions @ directions.T, -1, 1)
        per_degree = weight * np.einsum(
            "i,lij,j->l", power, _legendre(degree, cosines), power, optimize=True
        )
        least = min(least, float(per_degree[:3].sum() / per_degree.sum()))
    bound = mean_accuracy_bound(2)
    return Measurement(
        [least],
        f"The least accuracy seen over {lights:,} lights. The closed-form bound is "
        f"{bound:.6f} (48/49): it would take light with degree 0 and none of degrees 1 and 2, yet "
        "as much of the higher ones as a point light has, and no light has all of that.",
    )


def _legendre(degree: int, x: np.ndarray) -> np.ndarray:
    """Return P_l(x) for l = 0 .. degree, by the three-term recurrence."""
    values = np.empty((degree + 1, *x.shape))
    values[0], values[1] = 1, x
    for n in range(1, degree):
        values[n + 1] = ((2 * n + 1) * x * values[n] - n * values[n - 1]) / (n + 1)
    return values
