"""NVIDIA Kaolin's `sh9`, and what PyTorch code took from it.

References
----------
.. [KAO] NVIDIAGameWorks/kaolin, kaolin/render/lighting/sh.py: `project_onto_sh9` with the
   Condon-Shortley phase, `sh9_irradiance` with pi, 2 pi / 3, pi / 4; kaolin/render/camera/
   coordinates.py: right-handed, y up, z out of the screen.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import CONDON_SHORTLEY, NINE

KAOLIN = Convention(
    name="kaolin",
    order=NINE,
    factors=CONDON_SHORTLEY,
    channels_first=True,
    stored="radiance, odd orders negative",
    source="NVIDIAGameWorks/kaolin kaolin/render/lighting/sh.py",
)
"""Axes are those of the normals given to it; in its own frame they are ours."""
