"""From a map's pixels to harmonic coefficients, RH01 eq. 10.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

from typing import Literal

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.environment_map import EnvironmentMap
from harmface.light.frames import transformed
from harmface.light.layouts import Layout, layout_named
from harmface.light.projection.latlong import project_latlong
from harmface.light.projection.pixels import project_pixels


def project(
    environment: EnvironmentMap, max_degree: int, rule: Literal["samples", "areas"] = "samples"
) -> Float[np.ndarray, "*channels K"]:
    """Return the lighting coefficients `L_lm` of an environment map, [RH01]_ eq. 10.

    Parameters
    ----------
    environment
        The map, of any layout, in any frame.
    max_degree
        Highest degree.
    rule
        What the pixels mean, see `project_map`.

    Returns
    -------
    numpy.ndarray
        Coefficients in the world's frame, in the map's precision.

    Examples
    --------
    The same radiance from everywhere has the one coefficient `sqrt(4 pi)`:

    >>> grey = EnvironmentMap.from_image(np.ones((8, 16)), "latlong")
    >>> bool(np.allclose(project(grey, 1), [np.sqrt(4 * np.pi), 0, 0, 0]))
    True
    """
    coefficients = project_map(environment.radiance, environment.layout, max_degree, rule)
    return transformed(coefficients, environment.frame)


def project_map(
    radiance: Float[np.ndarray, "*channels_pixels"],
    layout: str | Layout,
    max_degree: int,
    rule: Literal["samples", "areas"] = "samples",
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of any function that a map holds, negative values too.

    One pass is made over the pixels, in blocks: beside the map it takes less than 64 MB. Sums are
    in float64; only on a float32 lat-long map are up to 64 terms at a time added in float32.

    The default rule takes pixels for samples at their centres. On a lat-long map it weights rows
    by Fejer's rule, which is exact up to rounding for a map without degrees above
    `H - 1 - max_degree`, where solid angles at the same points err by about
    `(max_degree pi / H)**2 / 24`, 0.06 % for degree 20 on 512 rows. It is the default because no
    power is lost (the weights are positive and sum to 4 pi), a synthesised map gives its own
    coefficients back, and a photographed one, whose pixels are nearer to means, is off by that
    same small amount either way. "areas" takes pixels for means over their solid angle: exact for
    a map that is constant on each pixel. Other layouts have no exact rule for samples: there
    harmonics at the pixels' centres are weighted with exact solid angles, with an error of
    second order in the pixel's size.

    Parameters
    ----------
    radiance
        Finite values, `(*channels, *pixels)`, in any order in memory.
    layout
        A layout or its name; coefficients are in its frame.
    max_degree
        Highest degree.
    rule
        "samples" or, for lat-long maps only, "areas".

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`, in the precision of the map.

    Raises
    ------
    ArgumentError
        If the shape does not fit the layout, a value is NaN or infinite, the map has too few rows
        for the degree, or the layout has no such rule.
    """
    form = layout_named(layout)
    radiance = checks.floating("radiance", radiance)
    max_degree = checks.degree("max_degree", max_degree)
    height = form.height_of(radiance.shape[-form.axes :])
    if rule not in ("samples", "areas") or (rule == "areas" and form.name != "latlong"):
        raise ArgumentError(
            f"rule must be 'samples', or 'areas' on a lat-long map, got {rule!r} on {form.name}"
        )
    if form.name == "latlong":
        if rule == "samples" and max_degree >= height:
            raise ArgumentError(
                f"a map of {height} rows holds degrees below {height}, got max_degree {max_degree}"
            )
        coefficients = project_latlong(radiance, max_degree, rule)
    else:
        coefficients = project_pixels(radiance, form, max_degree)
    if not np.isfinite(coefficients).all():
        raise ArgumentError("radiance must be finite, got NaN, Inf or values that overflow in sums")
    return coefficients.astype(radiance.dtype)
