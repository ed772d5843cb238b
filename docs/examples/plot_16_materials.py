"""
Materials as filters
====================

What surfaces of more and more gloss show of the same light, indexed by the mirrored direction.
"""

import matplotlib.pyplot as plt
import numpy as np

from harmface.light import EnvironmentMap
from harmface.reflectance import GGX, Lambert, Mirror, Phong
from harmface.rendering import reflection_map
from harmface.viz import show_linear

# %%
# A sky with a window of light, as a lat-long map.

rows, columns = np.mgrid[:128, :256]
radiance = 0.2 + 0.3 * (rows < 64)
radiance[30:50, 90:120] = 8
environment = EnvironmentMap.from_image(radiance)

# %%
# A sharper lobe keeps higher degrees of the light.

materials = {
    "matte": Lambert(),
    "Phong, exponent 20": Phong(20),
    "GGX, roughness 0.2": GGX(0.2),
    "mirror": Mirror(),
}
figure, axes = plt.subplots(2, 4, figsize=(11, 4))
for column, (name, material) in zip(axes.T, materials.items(), strict=True):
    show_linear(column[0], reflection_map(environment, material, 64, accuracy=1e-2), name)
    column[1].plot(material.radial(30), ".-")
    column[1].set(xlabel="degree", ylim=(-0.1, 1.1))
axes[1, 0].set_ylabel("factor $r_l$")
figure.tight_layout()
