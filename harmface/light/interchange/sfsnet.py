"""SfSNet: 27 numbers, nine of red, of green, of blue.

References
----------
.. [SFS] senguptaumd/SfSNet, functions/normal_harmonics.m: order and constants;
   functions/lambertian_attenuation.m: pi (1, 2/3, 1/4); functions/create_shading_recon.m: channels.
"""

from harmface.light.interchange.convention import Convention
from harmface.light.interchange.polynomials import ONES

SFSNET = Convention(
    name="sfsnet",
    order=(0, 2, 3, 1, 6, 7, 5, 8, 4),
    factors=ONES,
    channels_first=True,
    stored="radiance, in the order 1, z, x, y, 2z2-x2-y2, xz, yz, x2-y2, xy",
    source="senguptaumd/SfSNet functions/normal_harmonics.m, functions/create_shading_recon.m",
)
"""Axes are those of its normal maps: x right, y up, z to the viewer."""
