"""
Whose face is this?
===================

Six heads are enrolled as meshes; probes come from the brute-force renderer, with cast shadows and
camera noise, under light never seen before.
"""

import numpy as np

from data_synth.faces import head
from data_synth.lightings import mixed
from harmface.recognition import SubjectClassifier, enroll
from harmface.reproduce.synthetic import mesh_of, probe_images
from harmface.viz import Explanation, explanation_figure

rng = np.random.default_rng(7)
meshes = {f"head {seed}": mesh_of(head(seed, n_vertices=6000)) for seed in range(6)}
gallery = enroll(meshes, size=48, cast_shadows=False)
classifier = SubjectClassifier.from_gallery(gallery, "9d")
probes = np.concatenate(
    [probe_images(meshes[name], mixed(1, rng), 48, rng) for name in ("head 1", "head 4")]
)
distances = classifier.distances(probes.reshape(len(probes), -1))
nearest = distances.argsort(axis=1)[:, :2]
looks = [classifier.explained(probes, column) for column in nearest.T]
figure = explanation_figure(
    [
        Explanation(
            f"probe {row + 1}",
            probe,
            [
                (f"{classifier.classes_[who]} ({distances[row, who]:.3f})", pictures[row])
                for who, (pictures, _) in zip(nearest[row], looks, strict=True)
            ],
            looks[0][1][row],
        )
        for row, probe in enumerate(probes)
    ],
    gallery.mask,
)
