"""
The nine harmonics on a sphere
==============================

Real, orthonormal, with the signs of RH01 eq. 3. The image of a white sphere under any distant light
is, to 99 % of the energy, a sum of these nine pictures, each weighted by how much of it the light
holds and by how much of that a diffuse surface lets through.
"""

import numpy as np

from harmface.rendering import harmonic_images
from harmface.viz import basis_figure

across = (np.arange(128) + 0.5) / 64 - 1
x, y = np.meshgrid(across, -across)
mask = x**2 + y**2 < 1
z = np.sqrt(np.where(mask, 1 - x**2 - y**2, 0))
normals = np.where(mask[..., None], np.stack([x, y, z], axis=-1), 0)

basis = harmonic_images(normals, mask.astype(float))
figure = basis_figure(basis, mask)

# %%
# Degree 3 and the other odd degrees above 1 vanish: diffuse surfaces cannot see them.
higher = basis_figure(harmonic_images(normals, mask.astype(float), 4), mask)
