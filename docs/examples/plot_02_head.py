"""
The harmonic images of a head
=============================

The same nine functions, looked up at the normals of a head and multiplied by its albedo. Attached
shadows are contained; cast shadows are not.
"""

from data_synth.faces import head
from harmface.conventions import luminance
from harmface.geometry import frame_orthographic, gbuffer
from harmface.rendering import harmonic_images
from harmface.reproduce.synthetic import mesh_of
from harmface.viz import basis_figure

mesh = mesh_of(head(3, n_vertices=12000))
view = gbuffer(mesh, frame_orthographic(mesh, 160), supersampling=2)
basis = harmonic_images(view.normals, luminance(view.albedo))
figure = basis_figure(basis, view.mask)
