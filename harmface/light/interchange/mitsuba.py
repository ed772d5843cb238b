"""Mitsuba 3: coefficients for Dr.Jit's `sh_eval`.

References
----------
.. [DRJIT] mitsuba-renderer/drjit, include/drjit/sh.h: `sh_eval_2`, with the Condon-Shortley phase.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import CONDON_SHORTLEY, NINE

MITSUBA = Convention(
    name="mitsuba",
    order=NINE,
    factors=CONDON_SHORTLEY,
    channels_first=True,
    stored="radiance, odd orders negative",
    source="mitsuba-renderer/drjit include/drjit/sh.h",
)
"""World axes, right-handed, y up: ours."""
