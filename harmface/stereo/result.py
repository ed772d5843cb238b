"""What photometric stereo returns."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from harmface.stereo.gauge import Belief
from harmface.stereo.uncertainty import MapError


@dataclass(frozen=True)
class StereoReport:
    """How a result came about.

    Parameters
    ----------
    method
        "4d", "9d", "refined" or "known-lights".
    energy
        Share of the images' energy in their best approximation of rank 4 and of rank 9.
    rank
        Dimensions of the images that stand out from noise.
    signature_held
        Whether the quadric of the first-order structure had the signature that it must have;
        None where it plays no part.
    convexity
        What decided between a surface and its concave counterpart: "light", "known normals",
        "outline", or "assumed" (the border of the mask leans outwards).
    light_model
        What light the structure has: "one point", "near points", "points and uniform" or
        "harmonic".
    residual
        Root mean square of the observations about the result's images, relative to their own.
    converged
        Whether the fit settled; None where there is nothing to settle.
    noise_error
        Median expected error of a normal by noise, degrees.
    map_error
        Median expected error by the linear map that all normals share, degrees; 0 under known
        light.
    tilt_error
        How far the whole surface may be tilted about the x and the y axis, degrees.
    stretch_error
        How far its depth may be stretched, relative.
    cues
        What became of each cue to the map.
    strengths
        Strength of the lamp of each image relative to their mean; None where light is not one
        point an image.
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
    noise_error: float
    map_error: float
    tilt_error: tuple[float, float]
    stretch_error: float
    cues: tuple[Belief, ...]
    strengths: tuple[float, ...] | None
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
    lamps
        Direction to the lamp of each image times its irradiance at albedo 1; None where light is
        not one point an image. Of near lamps, as the middle of the object sees them.
    confidence
        In (0, 1]; a half where the expected error is 5 degrees.
    expected_error
        Of each normal, degrees: by noise and by the map together.
    mask
        The pixels.
    report
        How it came about.
    """

    normals: Float[np.ndarray, "H W 3"]
    albedo: Float[np.ndarray, "H W"]
    lighting: Float[np.ndarray, "F 9"]
    lamps: Float[np.ndarray, "F 3"] | None
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
    noise
        Expected error of each normal by noise, degrees.
    of_map
        Expected error by the map; None under known light.
    beliefs
        What became of the cues.
    lamps
        See `StereoResult`, for b.
    """

    method: str
    b: Float[np.ndarray, "p 3"]
    noise: Float[np.ndarray, "p"]
    of_map: MapError | None
    convexity: str
    beliefs: tuple[Belief, ...] = ()
    signature_held: bool | None = None
    light_model: str | None = None
    converged: bool | None = None
    lamps: Float[np.ndarray, "F 3"] | None = None
    warnings: tuple[str, ...] = ()
