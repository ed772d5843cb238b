"""The light probes that RH01 figure 2 tabulates.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError

# As printed: a row for each of L00, L1-1, L10, L11, L2-2, L2-1, L20, L21, L22, the order of our
# flat index, and in it red, green and blue.
_TABLES = {
    "grace": """
         .79  .44  .54
         .39  .35  .60
        -.34 -.18 -.27
        -.29 -.06  .01
        -.11 -.05 -.12
        -.26 -.22 -.47
        -.16 -.09 -.15
         .56  .21  .14
         .21 -.05 -.30
    """,
    "eucalyptus": """
         .38  .43  .45
         .29  .36  .41
         .04  .03  .01
        -.10 -.10 -.09
        -.06 -.06 -.04
         .01 -.01 -.05
        -.09 -.13 -.15
        -.06 -.05 -.04
         .02 -.00 -.05
    """,
    "st-peters": """
         .36  .26  .23
         .18  .14  .13
        -.02 -.01 -.00
         .03  .02  .01
         .02  .01  .00
        -.05 -.03 -.01
        -.09 -.08 -.07
         .01  .00  .00
        -.08 -.06  .00
    """,
}

PUBLISHED_PROBES = tuple(_TABLES)
"""Grace Cathedral, Eucalyptus Grove and St. Peter's Basilica."""


def published_probe(name: str) -> Float[np.ndarray, "3 9"]:
    """Return the lighting coefficients of a light probe, [RH01]_ figure 2, to their two digits.

    Their frame is that of [RH01]_ figure 3, see `conventions.rh01_frame`, and their unit is
    arbitrary: the paper scaled each probe.

    Parameters
    ----------
    name
        "grace", "eucalyptus" or "st-peters".

    Returns
    -------
    numpy.ndarray
        Red, green and blue, shape (3, 9), float64; in the unit of the published tables.

    Raises
    ------
    ArgumentError
        If there is no such probe.

    Examples
    --------
    >>> published_probe("grace")[:, 0]
    array([0.79, 0.44, 0.54])
    """
    if name not in _TABLES:
        raise ArgumentError(f"name must be one of {', '.join(_TABLES)}, got {name!r}")
    rows = [[float(number) for number in row.split()] for row in _TABLES[name].split("\n")]
    return np.array([row for row in rows if row]).T.copy() + 0.0
