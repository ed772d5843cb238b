"""
Cast shadows and reflected light
================================

What a point receives is linear in the light even where the head hides the sky or reflects light to
itself. Transfer takes the place of the harmonics of the normal; an image is still `L @ S`.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.environments import ENVIRONMENTS, rasterise
from data_synth.faces import head
from harmface.conventions import luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import EnvironmentMap
from harmface.rendering import harmonic_images, reflected, relight, render, transfer
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import real_harmonics
from harmface.viz import show_linear

DEGREE = 4
mesh = mesh_of(head(3, n_vertices=6000))
view = gbuffer(mesh, frame_orthographic(mesh, 128))
sky = EnvironmentMap.from_image(luminance(rasterise(ENVIRONMENTS["clear_sky"](), 64)))
lights = sky.as_distant_light(600)
coefficients = lights.irradiances @ real_harmonics(lights.directions, DEGREE).T
albedo = luminance(view.albedo)

truth = render(view, lights, caster=mesh) + albedo * reflected(mesh, view, lights, 2, rays=64)
bases = {
    "attached shadows only": harmonic_images(view.normals, albedo, DEGREE),
    "cast shadows": albedo * transfer(mesh, DEGREE, view=view, samples=1024).coefficients,
    "cast shadows, two bounces": albedo
    * transfer(mesh, DEGREE, view=view, bounces=2, samples=1024).coefficients,
}
images = {name: relight(coefficients, basis) for name, basis in bases.items()}
images["brute force"] = truth

figure = Figure(figsize=(11, 3.2), layout="constrained")
white = np.percentile(truth[view.mask], 99.5)
for axes, (name, image) in zip(figure.subplots(1, 4), images.items(), strict=True):
    error = np.linalg.norm(image - truth) / np.linalg.norm(truth)
    show_linear(axes, 0.95 * image / white, name + (f", error {error:.1%}" if error else ""))
