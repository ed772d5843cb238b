"""three.js: `LightProbe` and `SphericalHarmonics3`.

References
----------
.. [3js] mrdoob/three.js, src/math/SphericalHarmonics3.js: basis, `getIrradianceAt`, `toArray`;
   src/lights/LightProbe.js: JSON with `sh` and `intensity`.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import NINE, ONES

THREE_JS = Convention(
    name="three.js",
    order=NINE,
    factors=ONES,
    stored="radiance; the shader applies A_l",
    source="mrdoob/three.js src/math/SphericalHarmonics3.js, src/lights/LightProbe.js",
)
"""Right-handed, y up, the camera looking along -z: ours."""
