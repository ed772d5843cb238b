"""DirectX (`D3DX`, DirectXMath) and Unreal: the Condon-Shortley phase, left-handed axes.

References
----------
.. [DXM] microsoft/DirectXMath, SHMath/DirectXSH.cpp: `sh_eval_basis_2`; each channel is an array.
.. [UE] Unreal's Engine/Source/Runtime/Engine/Public/SHMath.h, `TSHVector::SHBasisFunction` and
   `GetMaximumDirection` = (-V3, -V1, V2): the same basis. Its repository is open to registered
   users only; excerpts in public ones were read.
"""

import numpy as np

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import CONDON_SHORTLEY, NINE, TO_VIEWER

DIRECTX = Convention(
    name="directx",
    order=NINE,
    factors=CONDON_SHORTLEY,
    frame=TO_VIEWER,
    channels_first=True,
    stored="radiance, odd orders negative",
    source="microsoft/DirectXMath SHMath/DirectXSH.cpp",
)
"""x right, y up, z forward."""

UNREAL = Convention(
    name="unreal",
    order=NINE,
    factors=CONDON_SHORTLEY,
    frame=np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),
    channels_first=True,
    stored="radiance, odd orders negative",
    source="Unreal SHMath.h, by excerpts",
)
"""x forward, y right, z up: (y, z, -x) is ours."""
