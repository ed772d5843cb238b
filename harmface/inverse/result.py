"""The light that a photograph tells, with what it does not tell."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from harmface.conventions import LUMINANCE, degree_order, harmonic_count, max_degree_of
from harmface.inverse.conditioning import told_directions
from harmface.inverse.least_squares import Pixels, biweight
from harmface.rendering import harmonic_irradiance
from harmface.sphere import fibonacci_directions, real_harmonics

INTERVAL = 1.96
"""Half of a 95 % interval, in standard deviations."""

FAINT = 1e-3
"""Even light, as a share of all, below which a light counts as having that much."""


@dataclass(frozen=True, eq=False)
class LightEstimate:
    """Light from a photograph: coefficients, their covariance, and what stays open.

    The leading axes, `*channels`, are those of the photograph's colours. The unit is the
    photograph's: with an albedo of 1 a pixel is the irradiance itself.

    Parameters
    ----------
    least_norm
        Coefficients, all finite. Where the pixels leave some open they are the least that
        explain the photograph as well as any.
    precision
        What is known of them: the inverse of their covariance where that exists.
    determined
        Whether the pixels, or a prior, tell a coefficient at all. Odd degrees above 1 of a convex
        matte object are not told, nor are coefficients that the visible normals cannot separate.
    noise
        Standard deviation of a voting pixel, over what was said of it if anything was.
    residual
        What is left of the photograph's voting pixels, relative to their root mean square.
    pixels, shape, robust
        What the light was estimated from: `fit` and `weights` are computed when asked for.
    """

    least_norm: Float[np.ndarray, "*channels K"]
    precision: Float[np.ndarray, "*channels K K"]
    determined: Bool[np.ndarray, "K"]
    noise: Float[np.ndarray, "*channels"]
    residual: Float[np.ndarray, "*channels"]
    pixels: Pixels
    shape: tuple[int, ...]
    robust: bool

    @property
    def coefficients(self) -> Float[np.ndarray, "*channels K"]:
        """Lighting coefficients, NaN where they are not determined."""
        return np.where(self.determined, self.least_norm, np.nan)

    @cached_property
    def covariance(self) -> Float[np.ndarray, "*channels K K"]:
        """Covariance of the coefficients' errors, NaN in rows and columns not determined."""
        each = self.precision.reshape(-1, *self.precision.shape[-2:])
        found = np.empty_like(each)
        for own, inverse in zip(each, found, strict=True):
            kept, _ = told_directions(own)
            inverse[:] = kept @ np.linalg.inv(kept.T @ own @ kept) @ kept.T
        found[:, ~self.determined] = np.nan
        found[:, :, ~self.determined] = np.nan
        return found.reshape(self.precision.shape)

    @property
    def degree(self) -> int:
        """Highest degree."""
        return max_degree_of(self.least_norm.shape[-1])

    @property
    def standard_errors(self) -> Float[np.ndarray, "*channels K"]:
        """Standard deviation of the coefficients' errors; infinite where not determined."""
        variances = np.einsum("...kk->...k", self.covariance)
        return np.where(self.determined, np.sqrt(np.maximum(variances, 0)), np.inf)

    @property
    def vague(self) -> Bool[np.ndarray, "*channels K"]:
        """Whether a coefficient's 95 % interval says no more than that light is not negative.

        Light of mean radiance `L_00 / sqrt(4 pi)` that is nowhere negative has coefficients of at
        most `L_00 sqrt(4 pi) max |Y_lm|`.
        """
        largest = np.abs(real_harmonics(fibonacci_directions(4000), self.degree)).max(axis=1)
        bound = np.sqrt(4 * np.pi) * largest * np.abs(self.least_norm[..., :1])
        return np.asarray(INTERVAL * self.standard_errors > bound)

    @cached_property
    def fit(self) -> Float[np.ndarray, "*channels_pixels"]:
        """The photograph that the light gives, `(*channels, *pixels)`, 0 off the surface."""
        own = np.zeros(self.pixels.values.shape)
        light = np.atleast_2d(self.least_norm)
        for block in self.pixels.blocks:
            shade = self.pixels.albedo
            shade = shade[:, block] if shade.shape[1] > 1 else shade
            own[:, block] = shade * (light @ self.pixels.basis(block))
        return own.reshape(*self.least_norm.shape[:-1], *self.shape)

    @cached_property
    def weights(self) -> Float[np.ndarray, "*channels_pixels"]:
        """Vote of every pixel, from 0 to 1: `(*channels, *pixels)`."""
        own = np.zeros(self.pixels.values.shape)
        light = np.atleast_2d(self.least_norm)
        for block in self.pixels.blocks:
            values, factor = self.pixels.scaled(block)
            left = (values - factor * (light @ self.pixels.basis(block))).T / self.noise
            votes = biweight(left.T) if self.robust else np.ones_like(left.T)
            own[:, block] = votes * (factor > 0)
        return own.reshape(*self.least_norm.shape[:-1], *self.shape)

    @cached_property
    def singular_values(self) -> Float[np.ndarray, "n"]:
        """As `inverse.singular_values` has them, of the pixels by their votes.

        Degrees that no pixel tells are left out.
        """
        each = self.weights.reshape(-1, self.pixels.values.shape[-1]).mean(axis=0)
        gram = np.zeros((self.determined.size, self.determined.size))
        for block in self.pixels.blocks:
            basis = self.pixels.basis(block)
            gram += (basis * each[block]) @ basis.T
        told = np.diagonal(gram) > 0
        values = np.linalg.eigvalsh(gram[np.ix_(told, told)] / each.sum())
        return np.sqrt(np.maximum(values[::-1], 0))

    @property
    def condition(self) -> float:
        """How much worse the worst combination of coefficients is told than the best."""
        with np.errstate(divide="ignore"):
            return float(self.singular_values[0] / self.singular_values[-1])

    @cached_property
    def first_degree(self) -> tuple[Float[np.ndarray, "4"], Float[np.ndarray, "4 4"]]:
        """Luminance of the light of degrees 0 and 1 under a bound on the higher ones, and errors.

        Light that is nowhere negative has no more than `L_00` in any higher coefficient, as a root
        mean square over the orders of its degree; a lamp has that. So much is expected of them
        here. It takes nothing from what is told well, and holds what is not: a frontal view hardly
        tells degree 1 from degree 2, and what the model misses would go to their difference.
        """
        light, covariance = np.zeros(4), np.zeros((4, 4))
        own = self.precision.reshape(-1, *self.precision.shape[-2:])
        share = LUMINANCE if len(own) == 3 else np.full(len(own), 1 / len(own))
        count = min(4, own.shape[-1])
        for part, gram, found in zip(share, own, np.atleast_2d(self.least_norm), strict=True):
            right = gram @ found
            kept, _ = told_directions(gram[:count, :count])
            low = kept @ np.linalg.solve(
                kept.T @ gram[:count, :count] @ kept, kept.T @ right[:count]
            )
            bound = max(low[0], FAINT * np.linalg.norm(low))
            full = gram + np.diag(np.where(np.arange(len(gram)) < 4, 0, bound**-2.0))
            kept, determined = told_directions(full)
            inverse = kept @ np.linalg.inv(kept.T @ full @ kept) @ kept.T
            light[:count] += part * (inverse @ right)[:count]
            covariance[:count, :count] += part**2 * inverse[:count, :count]
            if not determined[:4].all() or count < 4:
                covariance[:] = np.nan
        return light, covariance

    @property
    def direction(self) -> Float[np.ndarray, "3"]:
        """Unit vector to where most light comes from, that of `first_degree`."""
        first = self.first_degree[0][[3, 1, 2]]
        length = np.linalg.norm(first)
        return first / length if length > 0 else np.array([0.0, 0.0, 1.0])

    @property
    def direction_error(self) -> float:
        """Standard deviation of that direction across itself, in degrees; NaN if not told."""
        light, covariance = self.first_degree
        length = float(np.linalg.norm(light[1:4]))
        if length == 0:
            return float("nan")
        order = [3, 1, 2]
        own = covariance[np.ix_(order, order)]
        along = self.direction
        across = np.trace(own) - along @ own @ along
        return float(np.degrees(np.sqrt(np.maximum(across, 0)) / length))

    @property
    def ambient_share(self) -> float:
        """Share of even light if the rest were one lamp, `1 - |L_1| / (sqrt 3 L_0)`.

        A single lamp has 0, and what is more directed (see `negative`); light that is the same from
        opposite sides has 1. It is that of `first_degree`.
        """
        light = self.first_degree[0]
        if light[0] <= 0:
            return 0.0
        return float(max(1 - np.linalg.norm(light[1:4]) / (np.sqrt(3) * light[0]), 0.0))

    @property
    def negative(self) -> bool:
        """Whether the light is more directed than a lamp, which only negative light can be.

        So it is where a lamp's own shadows were left out as shadows; `non_negative` forbids it.
        """
        light = self.first_degree[0]
        return bool(np.linalg.norm(light[1:4]) > np.sqrt(3) * light[0])

    def up_to(self, degree: int) -> "LightEstimate":
        """Return the estimate without its higher degrees, which stay open.

        Where cast shadows are known, higher degrees of the light are told, too. They would pass for
        lower ones if they were not fitted: so light is best estimated to a degree or two more than
        are wanted. Votes, fit and noise of the result are those of its own degrees.

        Parameters
        ----------
        degree
            Highest degree that is kept.

        Returns
        -------
        LightEstimate
            Of that degree; this one if it has no higher.
        """
        count = harmonic_count(degree)
        if count >= self.least_norm.shape[-1]:
            return self
        each = self.precision.reshape(-1, *self.precision.shape[-2:])
        kept = np.empty((len(each), count, count))
        for own, left in zip(each, kept, strict=True):
            # The Schur complement: what is known of the lower degrees whatever the higher are.
            mixed, high = own[:count, count:], own[count:, count:]
            left[:] = own[:count, :count] - mixed @ np.linalg.pinv(high, hermitian=True) @ mixed.T
        pixels = self.pixels
        if pixels.irradiances is not None:
            pixels = replace(pixels, irradiances=pixels.irradiances[:count])
        return replace(
            self,
            least_norm=self.least_norm[..., :count],
            precision=kept.reshape(*self.precision.shape[:-2], count, count),
            determined=self.determined[:count],
            pixels=replace(pixels, degree=degree),
        )

    def irradiance(self, normals: Float[np.ndarray, "*pixels 3"]) -> Float[np.ndarray, "..."]:
        """Return the irradiance of normals under the light, see `rendering.harmonic_irradiance`.

        Parameters
        ----------
        normals
            Unit normals.

        Returns
        -------
        numpy.ndarray
            Irradiance in the photograph's unit, `(*channels, *pixels)`.

        Raises
        ------
        ArgumentError
            If a normal is not of unit length.
        """
        return harmonic_irradiance(self.least_norm, normals)

    def __str__(self) -> str:
        """Return a table of the coefficients and what the photograph says of the whole."""
        light, errors = np.atleast_2d(self.coefficients), np.atleast_2d(self.standard_errors)
        vague = np.atleast_2d(self.vague)
        lines = ["l  m   coefficient ± standard error"]
        for k in range(light.shape[1]):
            l, m = degree_order(k)  # noqa: E741 - the field's name for it
            told = [
                f"{value:9.4f} ± {error:.4f}{' (vague)' if open_ else ''}"
                for value, error, open_ in zip(light[:, k], errors[:, k], vague[:, k], strict=True)
            ]
            lines.append(
                f"{l}  {m:+d}  " + ("  ".join(told) if self.determined[k] else "unobserved")
            )
        x, y, z = self.direction
        lines += [
            f"dominant direction ({x:.3f}, {y:.3f}, {z:.3f}) ± {self.direction_error:.1f} degrees",
            f"ambient share {self.ambient_share:.0%}, residual {self.residual.max():.1%}, "
            f"condition number {self.condition:.3g}",
        ]
        return "\n".join(lines)
