"""DPR, Deep Single-Image Portrait Relighting: nine numbers, in grey.

References
----------
.. [DPR] zhhoper/DPR, utils/utils_SH.py: `SH_basis`, with pi (1, 2/3, 1/4);
   testNetwork_demo_512.py: the half sphere's x to the right, z up, y = -sqrt(1 - x2 - z2) towards
   the viewer, so +y points away. The demo scales the light by 0.7.
"""

import numpy as np

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import NINE, ONES

DPR = Convention(
    name="dpr",
    order=NINE,
    factors=ONES,
    frame=np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    grey=True,
    stored="radiance",
    source="zhhoper/DPR utils/utils_SH.py, testNetwork_demo_512.py",
)
"""x right, z up, y away from the viewer: (x, z, -y) is ours."""
