"""Reflectance from the field that it reflects, the light being known.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
.. [RH01b] Ramamoorthi and Hanrahan, A Signal-Processing Framework for Inverse Rendering,
   SIGGRAPH 2001.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import degrees, max_degree_of
from harmface.errors import ArgumentError
from harmface.light import DistantLight
from harmface.reflectance import Lambert, Material
from harmface.rendering.reference import clamped_cosines, shown_by
from harmface.sphere import energy_per_degree, mixed_functions
from harmface.summaries import summary


def reflected_field(
    light: Float[np.ndarray, "K"], rho: Float[np.ndarray, "L P Q"]
) -> Float[np.ndarray, "K P Q"]:
    """Return `B_lmpq = L_lm rho_lpq`, the reflected field's coefficients.

    In the mixed functions `D^l_mq Y_pq` without the norm `sqrt((2l + 1) / (4 pi))` of [R05]_
    eq. 38, hence without the `Lambda_l` of eq. 39.

    Parameters
    ----------
    light
        Coefficients of radiance.
    rho
        Coefficients of the material, of as many degrees, see `Material.coefficients`.

    Returns
    -------
    numpy.ndarray
        Shape `(K, P, Q)`.
    """
    return light[:, None, None] * rho[degrees(max_degree_of(len(light)))]


def field_from_samples(
    radiance: Float[np.ndarray, "N"],
    frames: Float[np.ndarray, "N 3 3"],
    outgoing: Float[np.ndarray, "N 3"],
    max_l: int,
    max_p: int,
) -> Float[np.ndarray, "K P Q"]:
    """Return the field's coefficients from radiance seen at many normals from many sides.

    Parameters
    ----------
    radiance
        What was seen; zero below the surface, which has to be among the samples.
    frames
        Rotations whose third column is the normal.
    outgoing
        Unit directions to the viewer, in these frames.
    max_l, max_p
        Greatest degrees that the field has.

    Returns
    -------
    numpy.ndarray
        Least-squares coefficients, shape `(K, P, Q)`.

    Raises
    ------
    ArgumentError
        If the samples do not determine every coefficient.
    """
    functions = mixed_functions(frames, outgoing, max_l, max_p)
    used = np.abs(functions).max(axis=-1) > 0
    design = functions[used].T
    found, _, rank, _ = np.linalg.lstsq(design, checks.finite("radiance", radiance), rcond=1e-8)
    if rank < design.shape[1]:
        raise ArgumentError(
            f"{len(radiance)} samples determine {rank} of {design.shape[1]} coefficients; see "
            "more normals from more sides, or take lower degrees"
        )
    field = np.zeros(functions.shape[:-1])
    field[used] = found
    return field


@dataclass(frozen=True, eq=False)
class ReflectanceEstimate:
    """Coefficients of a material, and how far they are to be trusted.

    Parameters
    ----------
    rho
        Coefficients `rho_lpq`; zero in degrees that are not determined.
    standard_errors
        Of each, infinite in these degrees.
    determined
        Whether the light has anything in a degree.
    """

    rho: Float[np.ndarray, "L P Q"]
    standard_errors: Float[np.ndarray, "L P Q"]
    determined: Bool[np.ndarray, "L"]

    __repr__ = summary


def estimate_reflectance(
    field: Float[np.ndarray, "..."],
    light: Float[np.ndarray, "..."],
    *,
    noise: float = 0.0,
    least: float = 1e-6,
) -> ReflectanceEstimate:
    """Return a material by dividing the light out of what it reflects, [R05]_ eq. 39.

    Of the orders of a degree each tells `rho_lpq = B_lmpq / L_lm`, the better the brighter its
    light: least squares weighs them into `sum_m L_lm B_lmpq / sum_m L_lm^2`. The standard error is
    `noise / |L_l|`: a lamp's light has all degrees alike and determines all, soft light only the
    low ones.

    Parameters
    ----------
    field
        Coefficients of the reflected field, `(K, P, Q)`, see `reflected_field`.
    light
        Coefficients of radiance, `(K,)`.
    noise
        Standard deviation of the field's coefficients.
    least
        Share of the brightest degree, root mean square an order, below which light counts as none.

    Returns
    -------
    ReflectanceEstimate
        With infinite errors in degrees that the light does not have.

    Raises
    ------
    ArgumentError
        If shapes do not agree, or the light is dark.
    """
    field, light = checks.finite("field", field), checks.finite("light", light)
    if light.ndim != 1 or field.ndim != 3 or len(field) != len(light):
        raise ArgumentError(
            f"field must have shape (K, P, Q) with K of light, got {field.shape}, {light.shape}"
        )
    degree = degrees(max_degree_of(len(light)))
    power = energy_per_degree(light)
    brightness = np.sqrt(power / (2 * np.arange(len(power)) + 1))
    if not brightness.max() > 0:
        raise ArgumentError("light must not be dark: nothing can be divided by it")
    determined = brightness > least * brightness.max()
    numerator = np.zeros((len(power), *field.shape[1:]))
    np.add.at(numerator, degree, light[:, None, None] * field)
    inverse = np.divide(1, power, out=np.zeros_like(power), where=determined)
    errors = np.where(determined, noise * np.sqrt(inverse), np.inf)
    return ReflectanceEstimate(
        numerator * inverse[:, None, None],
        np.broadcast_to(errors[:, None, None], numerator.shape).copy(),
        determined,
    )


@dataclass(frozen=True)
class MaterialFit:
    """A material's parameter from images.

    Parameters
    ----------
    value
        Least-squares value.
    interval
        All values whose residual is not significantly larger: bounds, at the asked confidence.
        One at an end of the range that was searched is not bounded there.
    diffuse, specular
        Albedo of the matte ground, and factor of the lobe.
    residual
        Root mean square residual over root mean square radiance.
    """

    value: float
    interval: tuple[float, float]
    diffuse: float
    specular: float
    residual: float


def fit_material(
    make: Callable[[float], Material],
    bounds: tuple[float, float],
    normals: Float[np.ndarray, "P 3"],
    to_camera: Float[np.ndarray, "P 3"],
    radiance: Float[np.ndarray, "P"],
    light: DistantLight,
    *,
    confidence: float = 0.95,
    steps: int = 40,
) -> MaterialFit:
    """Fit a lobe on a matte ground to an image of a known shape in known light.

    For each value of the parameter the two factors follow by non-negative least squares; the
    value with the least residual is found by scan and refinement, and its interval is that of the
    likelihood ratio (F test) with as many degrees of freedom as pixels.

    Parameters
    ----------
    make
        Makes the lobe from its exponent or roughness, such as `Phong` or `GGX`.
    bounds
        Range that is searched, logarithmically; both above 0.
    normals, to_camera
        Unit normals of pixels, and unit directions to the camera.
    radiance
        Of each pixel, not cast in shadow.
    light
        In one channel.
    confidence
        Of the interval.
    steps
        Of the scan.

    Returns
    -------
    MaterialFit
        The parameter, its interval, and both factors.

    Raises
    ------
    ArgumentError
        If there are too few pixels, bounds are no range, or all is dark.
    """
    from scipy.optimize import brentq, minimize_scalar, nnls
    from scipy.stats import f as f_distribution

    radiance = checks.finite("radiance", radiance)
    low, high = bounds
    if not 0 < low < high:
        raise ArgumentError(f"bounds must be 0 < low < high, got {bounds}")
    if len(radiance) < 10 or not np.abs(radiance).max() > 0:
        raise ArgumentError(
            f"images show {len(radiance)} lit pixels; at least ten that are not all dark are needed"
        )
    cosines = clamped_cosines(normals, light.directions)

    def seen(material: Material) -> np.ndarray:
        pairs = shown_by(material, normals, to_camera, light.directions, cosines)
        return light.irradiances @ pairs / np.pi

    ground = seen(Lambert())
    kept: dict[float, tuple[np.ndarray, float]] = {}

    def solve(position: float) -> tuple[np.ndarray, float]:
        if position not in kept:
            design = np.stack([ground, seen(make(float(np.exp(position))))], axis=1)
            factors, norm = nnls(design, radiance)
            kept[position] = factors, norm**2
        return kept[position]

    scan = np.linspace(np.log(low), np.log(high), steps)
    squares = np.array([solve(each)[1] for each in scan])
    middle = int(squares.argmin())
    around = scan[max(middle - 1, 0)], scan[min(middle + 1, steps - 1)]
    refined = minimize_scalar(
        lambda x: solve(float(x))[1], bounds=around, method="bounded", options={"xatol": 1e-5}
    )
    best = float(refined.x) if refined.fun < squares[middle] else float(scan[middle])
    factors, least = solve(best)
    freedom = len(radiance) - 3
    limit = least * (1 + f_distribution.ppf(confidence, 1, freedom) / freedom)
    limit += 1e-14 * float(radiance @ radiance)

    def end(side: int) -> float:
        """Return where the residual leaves the limit on one side."""
        inner = best
        for outer in scan[scan > best] if side > 0 else scan[scan < best][::-1]:
            if solve(float(outer))[1] > limit:
                return float(brentq(lambda x: solve(float(x))[1] - limit, inner, outer, xtol=1e-6))
            inner = float(outer)
        return float(scan[-1] if side > 0 else scan[0])

    return MaterialFit(
        float(np.exp(best)),
        (float(np.exp(end(-1))), float(np.exp(end(1)))),
        float(factors[0]),
        float(factors[1]),
        float(np.sqrt(least / (radiance @ radiance))),
    )
