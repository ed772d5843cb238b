"""
From normals to depth
=====================

Two methods on the exact normals of a vase: Frankot and Chellappa's projection onto integrable
slopes, whose slopes are zero outside the mask, which bends the silhouette, and least squares inside
the mask.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.shapes import vase
from harmface.geometry import (
    depth_frankot_chellappa,
    depth_least_squares,
    frame_orthographic,
    gbuffer,
)
from harmface.reproduce.synthetic import mesh_of

mesh = mesh_of(vase())
camera = frame_orthographic(mesh, 128)
view = gbuffer(mesh, camera)
truth = -view.depth * 128 / camera.height  # height towards the viewer, in pixels
depths = {
    "truth": truth,
    "Frankot-Chellappa": depth_frankot_chellappa(view.normals, view.mask),
    "least squares": depth_least_squares(view.normals, view.mask),
}
figure = Figure(figsize=(10, 3.4), layout="constrained")
for axes, (name, depth) in zip(figure.subplots(1, 3), depths.items(), strict=True):
    height = np.where(view.mask, depth - np.median(depth[view.mask]), np.nan)
    shown = axes.imshow(height, vmin=-40, vmax=25)
    axes.set(xticks=[], yticks=[], title=name)
figure.colorbar(shown, label="height / pixels")
