"""
scikit-learn's tools: a confusion matrix
========================================

`SubjectClassifier` is a scikit-learn classifier. Ten heads are known by three photographs each under
lamps near the viewer, and asked for under lamps further and further away.
"""

import numpy as np
from matplotlib.figure import Figure
from sklearn.metrics import confusion_matrix

from data_synth.faces import head
from data_synth.lightings import uniform_directional
from harmface.recognition import SubjectClassifier
from harmface.reproduce.synthetic import mesh_of, probe_images

rng = np.random.default_rng(5)
meshes = [mesh_of(head(seed, n_vertices=5000)) for seed in range(10)]
known, asked = [], []
for mesh in meshes:
    known.append(probe_images(mesh, uniform_directional(3, rng, max_polar=30), 32, rng))
    asked.append(probe_images(mesh, uniform_directional(6, rng, max_polar=75), 32, rng))
names = np.array([f"{number}" for number in range(10)])
X, y = np.concatenate(known).reshape(30, -1), np.repeat(names, 3)
probes, truth = np.concatenate(asked).reshape(60, -1), np.repeat(names, 6)

figure = Figure(figsize=(9, 4), layout="constrained")
for axes, method in zip(figure.subplots(1, 2), ("eigenfaces", "local"), strict=True):
    classifier = SubjectClassifier(method=method, image_shape=(32, 32)).fit(X, y)
    found = classifier.predict(probes)
    shown = axes.imshow(confusion_matrix(truth, found), cmap="Blues", vmin=0, vmax=6)
    axes.set(title=f"{method}: {np.mean(found == truth):.0%} right", xlabel="named", ylabel="is")
figure.colorbar(shown, label="photographs")
