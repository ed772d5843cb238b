"""
Normals from photographs under unknown light
============================================

Twelve photographs of a bumpy sphere, each under another lamp that nobody measured. What is found is the
surface, its albedo, and how far each normal may be off.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.lightings import uniform_directional
from data_synth.shapes import bumpy_sphere
from harmface.conventions import luminance
from harmface.geometry import depth_least_squares, depth_to_mesh, frame_orthographic, gbuffer
from harmface.rendering import render
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.stereo import angular_errors, photometric_stereo
from harmface.viz import stereo_figure

mesh = mesh_of(bumpy_sphere())
view = gbuffer(mesh, frame_orthographic(mesh, 80))
lights = light_of(uniform_directional(12, 0, max_polar=60))
images = render(view, lights, albedo=luminance(view.albedo), caster=mesh)
images = images / images.max()

found = photometric_stereo(images, view.mask)
depth = depth_least_squares(found.normals, found.mask)
surface = depth_to_mesh(depth, found.mask, found.albedo)
figure = stereo_figure(images, found.normals, found.albedo, depth, found.mask, surface)

# %%
# The true normals are known here, so that the error can be shown beside what was expected of it.
error = np.full(view.mask.shape, np.nan)
error[found.mask] = angular_errors(found.normals[found.mask], view.normals[found.mask])
errors = Figure(figsize=(7, 3), layout="constrained")
for axes, (name, values) in zip(
    errors.subplots(1, 2),
    {
        "error of the normals": error,
        "expected error": np.where(found.mask, found.expected_error, np.nan),
    }.items(),
    strict=True,
):
    shown = axes.imshow(values, vmin=0, vmax=6, cmap="magma")
    axes.set(xticks=[], yticks=[], title=name)
errors.colorbar(shown, label="degrees")
print(f"mean error {error[found.mask].mean():.2f} degrees")
