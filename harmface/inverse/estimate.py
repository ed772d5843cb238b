"""Light from one photograph of a known surface.

References
----------
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, section
   0.4.3.
.. [RH01s] Ramamoorthi and Hanrahan, A Signal-Processing Framework for Inverse Rendering,
   SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.inverse.conditioning import told_directions
from harmface.inverse.least_squares import Information, gather, weights_of
from harmface.inverse.prior import LightPrior
from harmface.inverse.result import LightEstimate
from harmface.light.non_negative import nearest_in_cone, sampled_light
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics

PRIOR_ROUNDS = 3
"""Times that the scale of the light is taken from the estimate before."""


def estimate_light(
    image: Float[np.ndarray, "..."],
    normals: Float[np.ndarray, "*pixels 3"],
    albedo: Float[np.ndarray, "..."] | float = 1.0,
    *,
    degree: int = 2,
    mask: Bool[np.ndarray, "*pixels"] | None = None,
    believed: Bool[np.ndarray, "..."] | None = None,
    visibility: Float[np.ndarray, "K *pixels"] | None = None,
    noise: Float[np.ndarray, "..."] | float | None = None,
    prior: LightPrior | None = None,
    non_negative: bool = False,
    robust: bool = True,
) -> LightEstimate:
    """Return the light under which a surface looks as it does in a photograph.

    The photograph is `b = L S` with the harmonic images `S_k = albedo A_l Y_k(n)` ([BJ03]_), so

        L = (S W S^T + P^-1)^-1 (S W b + P^-1 mu),

    with weights `W` the inverse variances of the pixels' noise and a prior of mean `mu` and
    covariance `P`, if there is one; the first inverse is the covariance of the result. Shadows,
    highlights and whatever else the model does not hold for lose their vote, see
    `least_squares.gather`. Degrees 0 to 2 are told well, odd ones above 1 never ([RH01s]_, [R05]_),
    the rest badly: give a prior for those.

    Parameters
    ----------
    image
        Linear photograph, `(*pixels)` in grey or `(*pixels, channels)` in colour.
    normals
        Unit normals; where nothing is to be believed they may be zero vectors.
    albedo
        One number, or of every pixel, in grey or with the photograph's channels. Photograph and
        albedo tell the light only up to one factor: with 1 the result is the light times the
        albedo that the surface has. Pixels of albedo 0 have no vote.
    degree
        Highest degree of the light.
    mask
        Where the surface is; where there are normals if not given.
    believed
        Which values may vote, with the shape of the mask or of the image: not those that are
        clipped.
    visibility
        Irradiance of every pixel under each harmonic of the light, cast shadows included, in place
        of `A_l Y_lm(n)`: `rendering.shadowed_harmonic_images` with an albedo of 1.
    noise
        Standard deviation of the noise: one number, or with the shape of the image. It is found
        from the residuals if it is not given, or if they are larger.
    prior
        What light is like; its scale is left to the photograph.
    non_negative
        Whether to return the best light that is nowhere negative. Its covariance is told as that
        of the free solution.
    robust
        Whether to look for pixels that the model does not hold for.

    Returns
    -------
    LightEstimate
        In double precision.

    Raises
    ------
    ArgumentError
        If shapes differ, something is not finite, normals are not of unit length, fewer pixels
        may vote than there are coefficients, or all of them are black.

    Examples
    --------
    A white sphere seen from the front, under a lamp from the right:

    >>> from harmface.rendering import harmonic_irradiance
    >>> y, x = np.mgrid[1:-1:64j, -1:1:64j]
    >>> inside = x**2 + y**2 < 0.95
    >>> normals = np.stack([x, y, np.sqrt(np.where(inside, 1 - x**2 - y**2, 0))], axis=-1)
    >>> normals[~inside] = 0
    >>> light = real_harmonics(np.array([0.6, 0.0, 0.8]), 2)
    >>> image = np.zeros((64, 64))
    >>> image[inside] = harmonic_irradiance(light, normals[inside])
    >>> found = estimate_light(image, normals)
    >>> found.direction.round(6) + 0.0
    array([0.6, 0. , 0.8])
    """
    normals = checks.finite("normals", checks.vectors("normals", normals))
    pixels = normals.shape[:-1]
    values = _channels_first("image", checks.intensities("image", image), pixels)
    reflected = _channels_first("albedo", checks.non_negative("albedo", albedo), pixels)
    degree = checks.degree("degree", degree)
    count = harmonic_count(degree)
    inside = (normals != 0).any(axis=-1)
    if mask is not None:
        inside = inside & checks.mask("mask", mask, pixels)
    votes = np.broadcast_to(inside, values.shape) & (reflected > 0)
    if believed is not None:
        votes = votes & _channels_first("believed", believed, pixels)
    deviations = None
    if noise is not None:
        deviations = np.broadcast_to(
            _channels_first("noise", checks.non_negative("noise", noise), pixels), values.shape
        )
        if not (deviations[votes] > 0).all():
            raise ArgumentError("noise must be positive where the photograph is believed")
    flat = normals[inside]
    unit = checks.unit_vectors("normals", flat).astype(np.float64, copy=False)
    if visibility is None:
        basis = real_harmonics(unit, degree)
        basis *= lambert_per_coefficient(degree)[:, None]
    else:
        basis = _irradiances(visibility, count, pixels)[:, inside]
    told: list[Information] = []
    for channel, own in enumerate(votes):
        some = own[inside]
        if some.sum() < 1:
            raise ArgumentError("image must have pixels that may vote, got none; check the mask")
        shade = np.broadcast_to(reflected, values.shape)[channel][inside][some]
        seen = values[channel][inside][some].astype(np.float64)
        if not seen.any():
            raise ArgumentError("image must not be black everywhere on the surface")
        factor = shade if deviations is None else shade / deviations[channel][inside][some]
        if deviations is not None:
            seen = seen / deviations[channel][inside][some]
        if count > seen.size:
            raise ArgumentError(
                f"image must have at least {count} pixels that may vote, as many as there are "
                f"coefficients, got {seen.size}; lower the degree"
            )
        chosen = basis if some.all() else basis[:, some]
        told.append(gather(chosen * factor, seen, None if noise is None else 1.0, robust))
    light, covariance, determined = _posterior(told, degree, prior, non_negative)
    fitted = np.zeros(values.shape)
    weights = np.zeros(values.shape)
    residual = np.empty(len(told))
    for channel, each in enumerate(told):
        shade = np.broadcast_to(reflected, values.shape)[channel][inside]
        fitted[channel][inside] = shade * (light[channel] @ basis)
        left = (values[channel] - fitted[channel])[inside]
        own = votes[channel][inside].astype(np.float64)
        if robust:
            scale = each.noise * (1 if deviations is None else deviations[channel][inside])
            own *= weights_of(left / scale, 1.0)
        weights[channel][inside] = own
        power = float(own @ values[channel][inside] ** 2)
        residual[channel] = np.sqrt(own @ left**2 / power) if power > 0 else np.nan
    grey = image.ndim == len(pixels)
    singular = _singular_values(basis, reflected, weights, inside, degree)
    return LightEstimate(
        least_norm=light[0] if grey else light,
        covariance=covariance[0] if grey else covariance,
        determined=determined,
        singular_values=singular,
        noise=np.array([each.noise for each in told])[0 if grey else slice(None)],
        weights=weights[0] if grey else weights,
        fit=fitted[0] if grey else fitted,
        residual=residual[0] if grey else residual,
    )


def _posterior(
    told: list[Information], degree: int, prior: LightPrior | None, non_negative: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coefficients, covariance and what is determined, from what each channel says."""
    count = harmonic_count(degree)
    light, covariance = np.zeros((len(told), count)), np.empty((len(told), count, count))
    determined = np.ones(count, bool)
    for channel, each in enumerate(told):
        gram, right = each.gram, each.right
        if prior is not None:
            scale = _scale(gram, right, prior.mean[:count])
            for _ in range(PRIOR_ROUNDS):
                precision, pull = prior.precision(scale, degree)
                scale = float(np.linalg.solve(gram + precision, right + pull)[0]) or scale
                scale = abs(scale)
            gram, right = gram + precision, right + pull
        kept, own = told_directions(gram)
        determined &= own
        inverse = kept @ np.linalg.inv(kept.T @ gram @ kept) @ kept.T
        light[channel], covariance[channel] = inverse @ right, inverse
        if non_negative:
            rays = sampled_light(degree)
            light[channel] = nearest_in_cone(right[None], gram[None], rays)[0]
    covariance[:, ~determined] = np.nan
    covariance[:, :, ~determined] = np.nan
    return light, covariance, determined


def _scale(
    gram: Float[np.ndarray, "K K"], right: Float[np.ndarray, "K"], mean: Float[np.ndarray, "K"]
) -> float:
    """Return the factor with which the prior's mean explains the photograph best."""
    return max(float(mean @ right) / max(float(mean @ gram @ mean), 1e-300), 1e-300)


def _singular_values(
    basis: Float[np.ndarray, "K p"],
    reflected: Float[np.ndarray, "..."],
    weights: Float[np.ndarray, "..."],
    inside: Bool[np.ndarray, "*pixels"],
    degree: int,
) -> Float[np.ndarray, "n"]:
    """Return the singular values of irradiance over the pixels that voted."""
    told = lambert_per_coefficient(degree) != 0
    if (basis[~told] != 0).any():
        told[:] = True  # cast shadows tell of odd degrees, too
    each = weights.mean(axis=0)[inside]
    gram = (basis[told] * (each / each.sum())) @ basis[told].T
    return np.sqrt(np.maximum(np.linalg.eigvalsh(gram)[::-1], 0))


def _channels_first(
    name: str, array: np.ndarray, pixels: tuple[int, ...]
) -> Float[np.ndarray, "channels *pixels"]:
    """Return an array of pixels, or of pixels and channels, or one number, with channels first."""
    array = np.asarray(array)
    if array.ndim == 0:
        return array.reshape(1, *[1] * len(pixels))
    if array.shape == pixels:
        return array[None]
    if array.shape[:-1] == pixels:
        return np.moveaxis(array, -1, 0)
    raise ArgumentError(
        f"{name} must have the size of the normals {pixels}, in grey or with channels last, "
        f"got shape {array.shape}"
    )


def _irradiances(
    visibility: Float[np.ndarray, "K *pixels"], count: int, pixels: tuple[int, ...]
) -> Float[np.ndarray, "K *pixels"]:
    visibility = checks.finite("visibility", visibility)
    if visibility.shape != (count, *pixels):
        raise ArgumentError(
            f"visibility must have shape {(count, *pixels)}, an image for each harmonic, "
            f"got {visibility.shape}"
        )
    return visibility.astype(np.float64, copy=False)
