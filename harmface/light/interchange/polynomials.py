"""The constants of the nine real harmonics as polynomials, and Lambert's factors: [RH01]_ eq. 3, 8.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import numpy as np

from harmface.conventions import orders

NINE = tuple(range(9))
"""The order 1, y, z, x, xy, yz, 3z2-1, xz, x2-y2."""

ONES = (1.0,) * 9

CONSTANTS = np.sqrt([1, 3, 3, 3, 15, 15, 5 / 4, 15, 15 / 4]) / np.sqrt(4 * np.pi)
"""Constant before each polynomial, in that order."""

CONDON_SHORTLEY = tuple(float((-1) ** (m % 2)) for m in orders(2))
"""The factor (-1)^m."""

IRRADIANCE = np.pi * np.repeat([1, 2 / 3, 1 / 4], [1, 3, 5])
"""A_l of each of the nine, [RH01]_ eq. 8."""

RADIOSITY = tuple(CONSTANTS * IRRADIANCE / np.pi)
"""Factors that leave `E / pi` as the plain sum of value times polynomial."""

TO_VIEWER = np.diag([1.0, 1.0, -1.0])
"""From a left-handed frame, x right, y up, z away from the viewer, to ours."""
