"""Photometric stereo when the light is known: one direction an image, or harmonics.

References
----------
.. [W80] Woodham, Photometric Method for Determining Surface Orientation from Multiple Images,
   Optical Engineering 1980.
.. [BJ03] Basri and Jacobs, Lambertian Reflectance and Linear Subspaces, PAMI 2003.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.stereo.light_models import HarmonicLight, LightModel, PointLights
from harmface.stereo.per_pixel import fit_normals
from harmface.stereo.robust import point_source_weights
from harmface.stereo.robust_factorization import weighted_solve

ROUNDS = 10
"""Reweightings of the robust fit, in which residuals settle."""

JUDGED = 6
"""Observations of a pixel from which outliers among them can be told: twice the unknowns. With
fewer a robust fit goes through three of them, and would take the noise to be none."""

UNKNOWNS = 3
"""Components of a scaled normal."""

EQUAL = "three images do not tell the lamps' strengths: taken as equal"

MANY = 0.01
"""Share of the pixels of which too little is known that is worth a word."""


def normals_from_directions(
    values: Float[np.ndarray, "F p"],
    lights: Float[np.ndarray, "F 3"],
    *,
    usable: Bool[np.ndarray, "F p"] | None = None,
    robust: bool = False,
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals b = albedo n under known directional light ([W80]_).

    Without attached shadow an image is `I = b . l`, three unknowns a pixel. `robust` weighs the
    observations of each pixel against the noise of all, see `point_source_weights`, so that
    shadows and highlights lose their say.

    Parameters
    ----------
    values
        Images as rows of pixels.
    lights
        Unit direction to the light of each image, times its irradiance.
    usable
        Observations that may count: leave out the dark ones, which say `b . l <= 0` only. A pixel
        with fewer than three is left open by them, see `normals_from_few`.
    robust
        Whether outliers are to be expected among the others.

    Returns
    -------
    numpy.ndarray
        Albedo times normal, shape (p, 3).

    Raises
    ------
    ArgumentError
        If lights and images differ in number, or the directions all lie in one plane.
    """
    lights = checks.vectors("lights", checks.finite("lights", lights)).astype(np.float64)
    require_light_for_each("lights", len(lights), len(values))
    singular = np.linalg.svd(lights, compute_uv=False)
    if len(lights) < 3 or singular[2] < 1e-3 * singular[0]:
        raise ArgumentError(
            "lights must span three dimensions, but all directions lie in one plane; "
            "add a photograph with light from outside it"
        )
    allowed = np.ones(values.shape) if usable is None else usable.astype(np.float64)
    b = weighted_solve(lights, allowed, values)
    if not robust:
        return b.T
    for _ in range(ROUNDS):
        b = weighted_solve(lights, robust_weights(values, lights @ b, allowed > 0), values)
    return b.T


def robust_weights(
    values: Float[np.ndarray, "F p"],
    predicted: Float[np.ndarray, "F p"],
    usable: Bool[np.ndarray, "F p"],
) -> Float[np.ndarray, "F p"]:
    """Return what observations count in a robust fit under one known source each.

    They are those of `point_source_weights` at pixels with `JUDGED` usable observations or more;
    elsewhere three unknowns fit any outlier, and all that is usable counts alike.

    Parameters
    ----------
    values, predicted
        Images as rows of pixels, and what was expected of them.
    usable
        Observations that may count.
    """
    judged = usable.sum(axis=0) >= JUDGED
    return np.where(judged, point_source_weights(values, predicted, usable & judged), usable)


def normals_from_few(
    values: Float[np.ndarray, "F p"],
    lights: Float[np.ndarray, "F 3"],
    usable: Bool[np.ndarray, "F p"],
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals where fewer than three observations are lit: guesses, of low trust.

    What is dark helps: Gauss-Newton on `|M - max(b . l, 0)|^2` keeps b from the lights that do not
    show.

    Parameters
    ----------
    values, lights
        As in `normals_from_directions`.
    usable
        Observations that may count, lit or dark: leave out the saturated ones.
    """
    weights = usable.astype(np.float64)
    start = weighted_solve(lights, weights, values).T
    return fit_normals(values, PointLights(1, ambient=False), lights, start, weights=weights)


def normals_from_coefficients(
    values: Float[np.ndarray, "F p"],
    coefficients: Float[np.ndarray, "F K"],
    *,
    usable: Bool[np.ndarray, "F p"] | None = None,
) -> Float[np.ndarray, "p 3"]:
    """Return scaled normals under known general light, given as harmonic coefficients.

    The harmonic images S = L^+ M of the linear least squares ([BJ03]_) hold albedo n in their
    rows of degree 1, but need K images and obey no constraint. Gauss-Newton on
    `|M - L S(b)|^2`, three unknowns a pixel, uses what the other rows say too.

    Parameters
    ----------
    values
        Images as rows of pixels.
    coefficients
        Coefficients of radiance of each image, to degree 1 or higher.
    usable
        Observations that may count, lit or dark: leave out the saturated ones.

    Returns
    -------
    numpy.ndarray
        Albedo times normal in float64, shape (p, 3).

    Raises
    ------
    ArgumentError
        If a coefficient is not finite, degree 1 is missing, or images and light differ in number.
    """
    coefficients = checks.finite("coefficients", coefficients).astype(np.float64)
    if coefficients.shape[1] < 4:
        raise ArgumentError(
            f"coefficients must reach degree 1 at least (K = 4), got K = {coefficients.shape[1]}"
        )
    require_light_for_each("coefficients", len(coefficients), len(values))
    model: LightModel = HarmonicLight(max_degree_of(coefficients.shape[1]))
    weights = np.ones(values.shape) if usable is None else usable.astype(np.float64)
    # Degree 1 leads the irradiance, so a fit of four rows places b well enough to start.
    linear = weighted_solve(coefficients[:, :4], weights, values)
    start = np.stack([linear[3], linear[1], linear[2]], axis=1)
    return fit_normals(values, model, coefficients, start, weights=weights)


def few_seen(few: Bool[np.ndarray, "p"]) -> tuple[str, ...]:
    """Return what to say of pixels with fewer than three observations to go by."""
    if few.mean() <= MANY:
        return ()
    return (
        f"{few.mean():.0%} of the pixels are seen in fewer than three photographs, neither "
        "dark nor saturated: their normals are guesses",
    )


def require_light_for_each(name: str, lights: int, images: int) -> None:
    """Refuse light that is not given once for each image."""
    if lights != images:
        raise ArgumentError(
            f"{name} must have a row for each of the {images} images, got {lights} rows"
        )
