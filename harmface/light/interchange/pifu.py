"""PIFu: one light of `env_sh.npy`.

References
----------
.. [PIFU] shunsukesaito/PIFu, apps/prt_util.py: transfer without a phase in (x, y, z) of the mesh;
   lib/renderer/gl/data/prt.fs: `evaluateH`, the polynomial of RH01 eq. 13. The shading is put to
   the power 1 / 2.2 before it meets the texture; apps/render_data.py: a subject that stands along
   z is turned by a quarter about x, then all are turned about y, so that y is up.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import NINE, ONES

PIFU = Convention(
    name="pifu",
    order=NINE,
    factors=ONES,
    stored="radiance",
    source="shunsukesaito/PIFu apps/prt_util.py, lib/renderer/gl/data/prt.fs",
)
"""OpenGL's eye space: x right, y up, z to the viewer."""
