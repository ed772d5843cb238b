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
from harmface.inverse.least_squares import BLOCKS, Information, Pixels, gather
from harmface.inverse.prior import LightPrior
from harmface.inverse.result import LightEstimate
from harmface.light.non_negative import nearest_in_cone, sampled_light

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
        Standard deviation of the noise: one number, or with the shape of the image. The covariance
        is then that of independent noise of at least that size. Without it residuals tell the
        covariance, those of each of 16 x 16 blocks as one, so that what the model misses counts.
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
    >>> from harmface.sphere import real_harmonics
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
    normals = checks.vectors("normals", normals)
    pixels = normals.shape[:-1]
    image = checks.intensities("image", image)
    values = _flat("image", image, pixels)
    shade = _flat("albedo", checks.non_negative("albedo", albedo), pixels)
    count = harmonic_count(checks.degree("degree", degree))
    grid = (normals != 0).any(axis=-1)
    if mask is not None:
        grid &= checks.mask("mask", mask, pixels)
    inside = grid.reshape(-1)
    if not inside.any():
        raise ArgumentError("mask must show some of the surface, got none")
    flat = normals.reshape(-1, 3)
    checks.unit_vectors("normals", flat if inside.all() else flat[inside])
    votes = _votes(believed, shade, values.shape, pixels)
    deviations = None
    if noise is not None:
        deviations = _flat("noise", checks.non_negative("noise", noise), pixels)
        if not (deviations > 0).all():
            raise ArgumentError("noise must be positive everywhere")
    voting = inside if votes is None else votes & inside
    for own, seen in zip(np.broadcast_to(voting, values.shape), values, strict=True):
        number = int(own.sum())
        if number < count:
            raise ArgumentError(
                f"image must have at least {count} pixels that may vote, as many as there are "
                f"coefficients, got {number}; lower the degree, or check mask, albedo and clipping"
            )
        if not seen[own].any():
            raise ArgumentError("image must not be black everywhere on the surface")
    known = Pixels(
        blocks=_blocks(grid),
        normals=flat,
        degree=degree,
        irradiances=None if visibility is None else _irradiances(visibility, count, pixels),
        values=values,
        albedo=shade,
        votes=votes,
        deviations=deviations,
    )
    told = gather(known, robust)
    light, precision, determined = _posterior(told, degree, prior, non_negative)
    grey = image.ndim == len(pixels)
    first = 0 if grey else slice(None)
    return LightEstimate(
        least_norm=light[first],
        precision=precision[first],
        determined=determined,
        noise=np.asarray(np.array([each.noise for each in told])[first]),
        residual=np.asarray(np.array([each.residual for each in told])[first]),
        pixels=known,
        shape=pixels,
        robust=robust,
    )


def _posterior(
    told: list[Information], degree: int, prior: LightPrior | None, non_negative: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coefficients, their precision and what is determined, from what each channel says."""
    count = harmonic_count(degree)
    light, precisions = np.zeros((len(told), count)), np.empty((len(told), count, count))
    determined = np.ones(count, bool)
    for channel, each in enumerate(told):
        gram, right = each.gram, each.right
        if prior is not None:
            precision, pull = prior.precision(1.0, degree)
            scale = _scale(gram, right, prior.mean[:count])
            for _ in range(PRIOR_ROUNDS):
                precision, pull = prior.precision(scale, degree)
                scale = float(np.linalg.solve(gram + precision, right + pull)[0]) or scale
                scale = abs(scale)
            gram, right = gram + precision, right + pull
        kept, own = told_directions(gram)
        determined &= own
        precisions[channel] = gram
        light[channel] = kept @ np.linalg.solve(kept.T @ gram @ kept, kept.T @ right)
        if non_negative:
            rays = sampled_light(degree)
            light[channel] = nearest_in_cone(right[None], gram[None], rays)[0]
    return light, precisions, determined


def _scale(
    gram: Float[np.ndarray, "K K"], right: Float[np.ndarray, "K"], mean: Float[np.ndarray, "K"]
) -> float:
    """Return the factor with which the prior's mean explains the photograph best."""
    return max(float(mean @ right) / max(float(mean @ gram @ mean), 1e-300), 1e-300)


def _flat(name: str, array: np.ndarray, pixels: tuple[int, ...]) -> np.ndarray:
    """Return an array of pixels, or of pixels and channels, or one number, with channels first."""
    array = np.asarray(array)
    if array.ndim == 0:
        return array.reshape(1, 1)
    if array.shape == pixels:
        return array.reshape(1, -1)
    if array.shape[:-1] == pixels:
        return np.ascontiguousarray(array.reshape(-1, array.shape[-1]).T)
    raise ArgumentError(
        f"{name} must have the size of the normals {pixels}, in grey or with channels last, "
        f"got shape {array.shape}"
    )


def _votes(
    believed: Bool[np.ndarray, "..."] | None,
    shade: Float[np.ndarray, "..."],
    shape: tuple[int, ...],
    pixels: tuple[int, ...],
) -> Bool[np.ndarray, "channels p"] | None:
    """Return which values may vote; None if all of them may."""
    reflects = shade > 0
    if believed is None and reflects.all():
        return None
    votes = np.broadcast_to(reflects, shape)
    if believed is not None:
        believed = checks.array_of("believed", believed)
        if believed.dtype != np.bool_:
            raise ArgumentError(f"believed must be true or false, got dtype {believed.dtype}")
        votes = votes & _flat("believed", believed, pixels)
    return votes


def _irradiances(
    visibility: Float[np.ndarray, "K *pixels"], count: int, pixels: tuple[int, ...]
) -> Float[np.ndarray, "K p"]:
    visibility = checks.finite("visibility", visibility)
    if visibility.shape != (count, *pixels):
        raise ArgumentError(
            f"visibility must have shape {(count, *pixels)}, an image for each harmonic, "
            f"got {visibility.shape}"
        )
    return visibility.reshape(count, -1).astype(np.float64, copy=False)


def _blocks(grid: Bool[np.ndarray, "*pixels"]) -> list[np.ndarray]:
    """Return the numbers of the surface's pixels in each of `BLOCKS x BLOCKS` parts of its box.

    Pixels that form no picture count as neighbours by their order.
    """
    number = np.arange(grid.size).reshape(grid.shape)
    if grid.ndim != 2:
        return [part for part in np.array_split(number[grid], BLOCKS**2) if part.size]
    rows, columns = (np.flatnonzero(grid.any(axis=axis)) for axis in (1, 0))
    found = []
    for band in np.array_split(np.arange(rows[0], rows[-1] + 1), BLOCKS):
        for part in np.array_split(np.arange(columns[0], columns[-1] + 1), BLOCKS):
            if band.size and part.size:
                place = slice(band[0], band[-1] + 1), slice(part[0], part[-1] + 1)
                own = number[place][grid[place]]
                if own.size:
                    found.append(own)
    return found
