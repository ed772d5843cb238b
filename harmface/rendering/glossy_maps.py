"""Environment maps prefiltered for a glossy material: what it shows in each mirrored direction.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
.. [KVHS00] Kautz, Vazquez, Heidrich and Seidel, A Unified Approach to Prefiltered Environment
   Maps, EGWR 2000.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.light import EnvironmentMap, layout_named, project, resample
from harmface.light.layouts import Layout
from harmface.reflectance import Material, Mirror, lobe_degree
from harmface.rendering.irradiance import harmonic_map


def reflection_map(
    environment: EnvironmentMap,
    material: Material,
    height: int,
    *,
    layout: str | Layout = "latlong",
    accuracy: float = 1e-3,
) -> Float[np.ndarray, "*channels_pixels"]:
    """Return the radiance that a material shows, as a map over the mirrored direction.

    Reflection scales the coefficients of each degree by the lobe's, `r_l L_lm` ([R05]_ eq. 39),
    for a lobe that is the same about every mirrored direction. Degrees are taken until the lobe
    passes no more than `accuracy` of the light, and a mirror shows the map itself.

    Parameters
    ----------
    environment
        Radiance from all sides.
    material
        Its `radial` factors are the lobe; one in colour needs a map with as many channels.
    height
        Rows of the result, or of a cube's face.
    layout
        Of the result.
    accuracy
        Greatest factor that is cut off, as a share of the greatest of all, see `lobe_degree`.

    Returns
    -------
    numpy.ndarray
        Radiance, `(*channels, *pixels)`. Series of sharp lights can dip below zero.

    Raises
    ------
    ArgumentError
        If the lobe is sharper than the map's pixels, or channels do not agree.
    """
    layout = layout_named(layout)
    if isinstance(material, Mirror):
        shown = resample(environment, layout, checks.positive_integer("height", height))
        return shown.radiance * material.share
    # A map of n rows holds waves of up to n / 2 of its own in half a turn.
    degree = lobe_degree(material, accuracy, most=_rows(environment) // 2)
    factors = material.radial(degree)
    light = project(environment, degree)
    if factors.ndim > 1 and factors.shape[:-1] != light.shape[:-1]:
        raise ArgumentError(
            f"a material of {factors.shape[0]} channels needs a map with as many, "
            f"got {light.shape[:-1]}"
        )
    return harmonic_map(light * factors[..., degrees(degree)], layout, height)


def _rows(environment: EnvironmentMap) -> int:
    """Return the rows of a lat-long map as fine as this one."""
    return int(np.sqrt(np.count_nonzero(environment.solid_angles) / 2))
