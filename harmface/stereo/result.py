"""What photometric stereo returns."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float


@dataclass(frozen=True)
class StereoReport:
    """How a result came about.

    Parameters
    ----------
    method
        "known directions", "known coefficients", "first order", "second order" or "refined".
    energy
        Share of the images' energy in their best approximation of rank 4 and of rank 9.
    rank
        Dimensions of the images that stand out from noise.
    signature_held
        Whether the quadric of the first-order structure had the signature that it must have;
        None if light was known.
    convexity
        What decided between a surface and its concave counterpart: "light", "known normals",
        "outline", or "assumed" (the rim of the mask leans outwards).
    light_model
        What light the refinement found, or chose the linear map of the second order: "one point",
        "points and uniform" or "harmonic"; None where harmonics alone decided.
    residual
        Root mean square of the observations about the result's images, relative to their own.
    converged
        Whether the refinement settled; None without it.
    warnings
        What to know before trusting the result.
    """

    method: str
    energy: tuple[float, float]
    rank: int
    signature_held: bool | None
    convexity: str
    light_model: str | None
    residual: float
    converged: bool | None
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class StereoResult:
    """Surface and light recovered from photographs; the background holds zeros.

    Parameters
    ----------
    normals
        Unit normals, x right, y up, z towards the viewer.
    albedo
        Albedo; its scale is that of the light, and if light was unknown its largest value is 1.
    lighting
        Harmonic coefficients of radiance of each image to degree 2, for this albedo.
    confidence
        In (0, 1]; a half where the expected error is 5 degrees.
    expected_error
        Of each normal, degrees.
    mask
        The pixels.
    report
        How it came about.
    """

    normals: Float[np.ndarray, "H W 3"]
    albedo: Float[np.ndarray, "H W"]
    lighting: Float[np.ndarray, "F 9"]
    confidence: Float[np.ndarray, "H W"]
    expected_error: Float[np.ndarray, "H W"]
    mask: Bool[np.ndarray, "H W"]
    report: StereoReport


@dataclass(frozen=True, eq=False)
class Recovered:
    """Structure on the pixels, before it becomes pictures.

    Parameters
    ----------
    method, convexity, signature_held, light_model, converged, warnings
        See `StereoReport`.
    b
        Scaled normals.
    expected
        Expected error of each normal, degrees.
    """

    method: str
    b: Float[np.ndarray, "p 3"]
    expected: Float[np.ndarray, "p"]
    convexity: str
    signature_held: bool | None = None
    light_model: str | None = None
    converged: bool | None = None
    warnings: tuple[str, ...] = ()
