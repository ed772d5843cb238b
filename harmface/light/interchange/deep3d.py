"""Deep3DFaceRecon: the 27 numbers `gamma`, nine of red, of green, of blue.

References
----------
.. [D3D] sicxu/Deep3DFaceRecon_pytorch, models/bfm.py: `SH`, with pi, 2 pi / sqrt 3, 2 pi / sqrt 8;
   `compute_color`, which adds `init_lit`, 0.8, to the first; `to_camera`, which turns z away.
"""

import numpy as np

from harmface.conventions import degrees
from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import CONDON_SHORTLEY, NINE

_PER_DEGREE = np.array([1.0, np.sqrt(3), 2 * np.sqrt(2)])

DEEP3D = Convention(
    name="deep3d",
    order=NINE,
    factors=tuple(np.array(CONDON_SHORTLEY) / _PER_DEGREE[degrees(2)]),
    offsets=(-0.8, 0, 0, 0, 0, 0, 0, 0, 0),
    channels_first=True,
    stored="radiance over 1, sqrt 3, 2 sqrt 2 by degree, odd orders negative, 0.8 off the first",
    source="sicxu/Deep3DFaceRecon_pytorch models/bfm.py",
)
"""Normals are rotated before z is turned away: x right, y up, z to the viewer."""
