"""Filament: `sh.txt` of cmgen.

References
----------
.. [FIL] google/filament, libs/ibl/src/CubemapSH.cpp: `computeShBasis` with the Condon-Shortley
   phase, `preprocessSHForShader`, `renderPreScaledSH3Bands`, `sincWindow`;
   tools/cmgen/src/cmgen.cpp: `--sh-window`.
"""

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import CONDON_SHORTLEY, NINE, RADIOSITY

FILAMENT = Convention(
    name="filament",
    order=NINE,
    factors=RADIOSITY,
    stored="E / pi as a polynomial: radiance x A_l / pi x the harmonics' constants",
    source="google/filament libs/ibl/src/CubemapSH.cpp, tools/cmgen/src/cmgen.cpp",
)
"""What `--sh-shader` and `--deploy` write, pre-scaled. Right-handed, y up; the phase cancels."""

FILAMENT_RADIANCE = Convention(
    name="filament-radiance",
    order=NINE,
    factors=CONDON_SHORTLEY,
    stored="radiance, odd orders negative",
    source="google/filament libs/ibl/src/CubemapSH.cpp",
)
"""What `--sh=3` writes without `--sh-irradiance`."""


def filament_window(cutoff: float, max_degree: int = 2) -> Float[np.ndarray, "degrees"]:
    """Return cmgen's window against ringing, `sinc(l / cutoff)**4` of each degree l.

    cmgen applies it by default, with a cutoff that leaves no negative irradiance; files do not say
    which. `light.windowed` applies it.

    Parameters
    ----------
    cutoff
        Degree from which the window is zero, above 0.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Factor of each degree, shape (max_degree + 1,).

    Raises
    ------
    ArgumentError
        If the cutoff is not a positive number.
    """
    if not (np.isfinite(cutoff) and cutoff > 0):
        raise ArgumentError(f"window must be a positive cutoff in degrees, got {cutoff}")
    degree = np.arange(max_degree + 1)
    return np.where(degree < cutoff, np.sinc(degree / cutoff) ** 4, 0)
