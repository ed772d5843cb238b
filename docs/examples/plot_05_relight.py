"""
A head under six lights
=======================

`L @ S` is an image: lighting coefficients times harmonic images. Light changes for the price of nine
multiplications a pixel.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.faces import head
from harmface.conventions import light_direction, luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import ambient, disc, hemisphere, published_probe
from harmface.rendering import harmonic_images, relight
from harmface.reproduce.synthetic import mesh_of
from harmface.viz import show_linear

mesh = mesh_of(head(3, n_vertices=12000))
view = gbuffer(mesh, frame_orthographic(mesh, 160), supersampling=2)
basis = harmonic_images(view.normals, luminance(view.albedo))
lights = {
    "lamp at 40° right, 20° up": disc(light_direction(40, 20), np.radians(5), 1.0, 2),
    "lamp at 60° left": disc(light_direction(-60, 0), np.radians(5), 1.0, 2),
    "sky above": hemisphere(np.array([0.0, 1.0, 0.0]), 0.4, 2),
    "everywhere alike": ambient(0.25, 2),
    "Grace Cathedral": luminance(published_probe("grace").T),
    "Eucalyptus Grove": luminance(published_probe("eucalyptus").T),
}
figure = Figure(figsize=(10, 6.4), layout="constrained")
for axes, (name, light) in zip(figure.subplots(2, 3).flat, lights.items(), strict=True):
    image = np.maximum(relight(light, basis), 0)
    show_linear(axes, 0.95 * image / np.percentile(image[view.mask], 99.5), name)
