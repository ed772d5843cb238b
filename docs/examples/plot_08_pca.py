"""
Principal components without images
===================================

R02: the components of all images of an object under one moving lamp follow from its normals. They are
compared with a PCA of 600 images.
"""

import numpy as np

from data_synth.faces import head
from harmface.geometry import frame_orthographic, gbuffer
from harmface.pca import analytic_pca, attached_shadow_pca, compare
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions
from harmface.viz import modes_figure

mesh = mesh_of(head(3, n_vertices=12000))
view = gbuffer(mesh, frame_orthographic(mesh, 96))
theory = analytic_pca(view.normals)
images = attached_shadow_pca(view.normals, fibonacci_directions(600))
signs = np.sign(compare(theory, images).correlations)[:, None, None]
figure = modes_figure(
    {"analytic": theory.modes(5), "600 images": images.modes[:5] * signs},
    {"analytic": theory.fractions, "600 images": images.fractions},
    view.mask,
)
