"""Skies of the CIE over a diffuse ground.

References
----------
.. [CIE03] CIE S 011/E:2003 (ISO 15469:2004), "Spatial distribution of daylight: CIE standard
   general sky". The traditional overcast sky is its type 16, the clear sky its type 12.
"""

from functools import partial
from typing import Any

import numpy as np

from data_synth.environments.environment import Environment
from data_synth.environments.rules import sky_rule

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance of linear RGB with the primaries of ITU-R BT.709."""

SUN_RADIUS = np.radians(0.2665)
"""Mean angular radius of the sun's disc, in radians."""

# The limb is softened over this share of the radius to either side, so that a map or a rule
# that resolves it converges.
_LIMB = 0.2

GROUND_ALBEDO = np.array([0.22, 0.19, 0.15])
"""Of the diffuse ground below the horizon, linear RGB: dry soil."""

# Gradation a, b and indicatrix c, d, e of [CIE03]_ type 12, "CIE standard clear sky, low
# luminance turbidity".
_CLEAR = (-1.0, -0.32, 10.0, -3.0, 0.45)

DEFAULT_SUN = (-34.8046875, 39.7265625)
"""Azimuth and altitude in degrees: in the middle of a pixel of the 512 x 256 lat-long map."""


def overcast_sky(zenith: float = 1.0) -> Environment:
    """Build the CIE traditional overcast sky, `L = L_z (1 + 2 sin altitude) / 3` [CIE03]_.

    Below the horizon lies a diffuse ground, lit by the sky's `E = 7 pi L_z / 9`.

    Parameters
    ----------
    zenith : float
        Luminance of the zenith.
    """
    _require_zenith(zenith)
    tint = np.array([0.96, 1.0, 1.06])
    sky = zenith * tint / (LUMINANCE @ tint)
    ground = GROUND_ALBEDO * sky * 7.0 / 9.0

    def radiance(directions: np.ndarray) -> np.ndarray:
        sine = directions[..., 1:2]
        light: np.ndarray = np.where(sine > 0, (1.0 + 2.0 * sine) / 3.0 * sky, ground)
        return light

    up = np.array([0.0, 1.0, 0.0])
    return Environment("overcast_sky", radiance, partial(sky_rule, up, ()), nodes=12)


def clear_sky(
    sun: tuple[float, float] = DEFAULT_SUN,
    *,
    disc: bool = True,
    zenith: float = 1.0,
    sun_share: float = 4.0,
) -> Environment:
    """Build the CIE standard clear sky, with or without the sun's disc [CIE03]_.

    `L / L_z = f(chi) phi(Z) / (f(Z_sun) phi(0))` with the gradation
    `phi(Z) = 1 + a exp(b / cos Z)` and the indicatrix
    `f(chi) = 1 + c (exp(d chi) - exp(d pi / 2)) + e cos^2 chi`, chi the angle from the sun and
    Z that from the zenith. The standard gives luminance; the tint, blue away from the sun and
    white towards the horizon, leaves it unchanged.

    Parameters
    ----------
    sun : (azimuth, altitude)
        Degrees: azimuth from +z towards +x, altitude in (0, 90] above the horizon.
    disc : bool
        Whether the sun itself shines, or a tree hides it.
    zenith : float
        Luminance of the zenith.
    sun_share : float
        Illuminance of the ground by the disc over that by the sky.
    """
    _require_zenith(zenith)
    azimuth, altitude = np.radians(sun)
    if not (np.isfinite(azimuth) and 0 < altitude <= np.pi / 2):
        raise ValueError(
            f"sun must be a finite azimuth and an altitude in (0, 90] degrees, got {sun}: "
            "give a sun above the horizon"
        )
    if not (np.isfinite(sun_share) and sun_share > 0):
        raise ValueError(
            f"sun_share must be finite and above 0, got {sun_share}: use disc=False for no sun"
        )
    pole = np.array(
        [
            np.sin(azimuth) * np.cos(altitude),
            np.sin(altitude),
            np.cos(azimuth) * np.cos(altitude),
        ]
    )
    rings = tuple(SUN_RADIUS * np.array([1 - _LIMB, 1 + _LIMB])) if disc else ()
    rule = partial(sky_rule, pole, rings)
    sky = partial(_clear_radiance, pole=pole, scale=zenith)

    directions, weights = sky_rule(pole, (), 32)
    above = directions[:, 1] > 0
    lit = weights[above] * directions[above, 1]
    sky_irradiance = lit @ sky(directions[above])

    # The soft limb is a smoothstep: it adds the variance of its slope, the squared half width
    # over five, to the squared radius.
    solid_angle = np.pi * SUN_RADIUS**2 * (1.0 + _LIMB**2 / 5.0)
    sun_tint = np.array([1.1, 1.0, 0.8])
    sun_irradiance = sun_share * (LUMINANCE @ sky_irradiance) * sun_tint / (LUMINANCE @ sun_tint)
    sun_radiance = sun_irradiance / (np.sin(altitude) * solid_angle)
    ground = GROUND_ALBEDO * (sky_irradiance + (sun_irradiance if disc else 0.0)) / np.pi

    def radiance(directions: np.ndarray) -> np.ndarray:
        light = sky(directions)
        if disc:
            light = light + sun_radiance * _disc(directions, pole)[..., None]
        return np.where(directions[..., 1:2] > 0, light, ground)

    name = "clear_sky_sun" if disc else "clear_sky"
    return Environment(name, radiance, rule, nodes=24)


def _clear_radiance(directions: np.ndarray, pole: np.ndarray, scale: float) -> np.ndarray:
    a, b, c, d, e = _CLEAR
    cosine = np.clip(directions @ pole, -1.0, 1.0)
    # Below the horizon the formula does not hold and the ground covers it.
    height = np.maximum(directions[..., 1], 1e-6)

    def gradation(height: Any) -> Any:
        return 1.0 + a * np.exp(b / height)

    def indicatrix(cosine: Any) -> Any:
        angle = np.arccos(cosine)
        return 1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2)) + e * np.square(cosine)

    luminance = scale * indicatrix(cosine) / indicatrix(pole[1])
    luminance *= gradation(height) / gradation(1.0)
    blue = ((1.0 - np.exp(-4.0 * height)) * (1.0 - np.exp(-12.0 * (1.0 - cosine))))[..., None]
    tint = 1.0 + blue * (np.array([0.35, 0.75, 2.0]) - 1.0)
    radiance: np.ndarray = tint * (luminance / (tint @ LUMINANCE))[..., None]
    return radiance


def _disc(directions: np.ndarray, pole: np.ndarray) -> np.ndarray:
    """One on the sun's disc, falling smoothly to zero across its limb."""
    angle = 2.0 * np.arcsin(np.clip(np.linalg.norm(directions - pole, axis=-1) / 2.0, 0.0, 1.0))
    fraction: np.ndarray = np.clip((1.0 + _LIMB - angle / SUN_RADIUS) / (2.0 * _LIMB), 0.0, 1.0)
    return fraction**2 * (3.0 - 2.0 * fraction)


def _require_zenith(zenith: float) -> None:
    if not (np.isfinite(zenith) and zenith > 0):
        raise ValueError(f"zenith must be finite and above 0, got {zenith}: 1 is a usual value")
