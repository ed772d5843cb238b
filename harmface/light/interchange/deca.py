"""DECA (and EMOCA, and whoever took `add_SHlight` from it).

References
----------
.. [DECA] yfeng95/DECA, decalib/utils/renderer.py: `constant_factor`, whose first entry lacks pi,
   and `add_SHlight`, of normals in FLAME's world; decalib/deca.py: light is (9, 3).
"""

import numpy as np

from harmface.light.interchange.convention import Convention

DECA = Convention(
    name="deca",
    order=(0, 3, 1, 2, 4, 7, 5, 8, 6),
    factors=(np.pi, 1, 1, 1, 1, 1, 1, 1, 1),
    stored="radiance, the first times pi; in the order 1, x, y, z, xy, xz, yz, x2-y2, 3z2-1",
    source="yfeng95/DECA decalib/utils/renderer.py, decalib/deca.py",
)
"""FLAME's axes: x right in the picture, y up, z to the viewer of a frontal face."""
