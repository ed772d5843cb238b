"""Unity: the 27 floats of `SphericalHarmonicsL2`, `sh[rgb, coefficient]`.

References
----------
.. [UNI] Unity-Technologies/Graphics, com.unity.render-pipelines.core/ShaderLibrary/
   EntityLighting.hlsl: `SHEvalLinearL0L1`, `SHEvalLinearL2`, with
   `SHA = (sh3, sh1, sh2, sh0 - sh6)`, `SHB = (sh4, sh5, 3 sh6, sh7)`, `SHC = sh8`;
   pema99/SHTools, SHTools.cs: values are multiplied by the harmonics' constants and over pi.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import NINE, RADIOSITY, TO_VIEWER

UNITY = Convention(
    name="unity",
    order=NINE,
    factors=RADIOSITY,
    frame=TO_VIEWER,
    channels_first=True,
    stored="E / pi as a polynomial",
    source="Unity-Technologies/Graphics EntityLighting.hlsl, pema99/SHTools SHTools.cs",
)
"""Left-handed: x right, y up, z forward, where a camera looks."""
