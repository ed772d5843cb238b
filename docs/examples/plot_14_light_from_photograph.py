"""
Light from a photograph, and other light
========================================

A head is photographed in a room: rendered by brute force, with cast shadows, by a method that knows
nothing of harmonics. Its normals tell the light, and the ratio of two irradiances takes the photograph
to a studio.
"""

import numpy as np
from matplotlib.figure import Figure

from data_synth.environments import ENVIRONMENTS, rasterise
from data_synth.faces import head
from harmface.geometry import frame_orthographic
from harmface.inverse import PhotographedSurface, estimate_light, relight_photograph
from harmface.light import EnvironmentMap
from harmface.rendering import render
from harmface.reproduce.synthetic import mesh_of
from harmface.viz import light_figure, show_linear

mesh = mesh_of(head(3, n_vertices=12000))
surface = PhotographedSurface.of_mesh(mesh, frame_orthographic(mesh, 128))
colours = np.moveaxis(surface.view.albedo, -1, 0)
room, studio = (
    EnvironmentMap.from_image(rasterise(ENVIRONMENTS[name](), 64)) for name in ("room", "studio")
)
photo, wanted = (
    np.moveaxis(
        render(surface.view, place.as_distant_light(600), albedo=colours, caster=mesh), 0, -1
    )
    for place in (room, studio)
)

# %%
# Cast shadows tell of higher degrees, so four are fitted and two kept. The figure shows how much of the
# photograph is left, which pixels had no vote, and each coefficient with its error bar.

found = estimate_light(
    photo,
    surface.normals,
    surface.albedo,
    degree=4,
    mask=surface.inner,
    visibility=surface.harmonic_irradiances(4),
)
figure = light_figure(photo, found.up_to(2), surface.inner)
print("residual", found.residual.round(3), "towards the light", found.direction.round(2))

# %%
# The new light here is known. The last picture is what a photograph taken in it would be.

before = surface.irradiance(found.least_norm)
relit = relight_photograph(photo, before, surface.irradiance(studio), surface.mask)
figure = Figure(figsize=(9, 3.4), layout="constrained")
pictures = {"photograph": photo, "relit": relit, "brute force in the new light": wanted}
for axes, (name, image) in zip(figure.subplots(1, 3), pictures.items(), strict=True):
    white = np.percentile(image[surface.mask], 99.5)
    show_linear(axes, 0.95 * np.moveaxis(image, -1, 0) / white, name)
