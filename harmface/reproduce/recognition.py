"""Claims on recognition by distance to a subspace."""

import numpy as np
from matplotlib.figure import Figure

from data_synth.faces import head
from data_synth.lightings import mixed
from harmface.conventions import linear_to_srgb
from harmface.recognition import HarmonicSubspaceClassifier, enroll
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import mesh_of, probe_images, subject_seed


def small_set(
    subjects: int = 42,
    probes_each: int = 6,
    size: int = 64,
    seed: int = 2005,
    identity_scale: float = 1.0,
) -> Measurement:
    """Recognise 42 subjects, enrolled as meshes, from photographs under light never seen before.

    Probes come from the oracle, with cast shadows and camera noise; their lights are mixtures of
    ambient, area and point lights. [R05 0.4.1]
    """
    meshes = {
        f"subject {number:02d}": mesh_of(
            head(subject_seed(seed, number), identity_scale=identity_scale)
        )
        for number in range(subjects)
    }
    gallery = enroll(meshes, size)
    rng = np.random.default_rng(seed)
    photographs = np.stack(
        [
            probe_images(mesh, mixed(probes_each, rng, directions=256), size, rng)
            for mesh in meshes.values()
        ]
    )
    probes = photographs.reshape(-1, size, size)[:, gallery.mask]
    truth = np.repeat(list(meshes), probes_each)
    rates = {
        method: float(HarmonicSubspaceClassifier.from_gallery(gallery, method).score(probes, truth))
        for method in ("3d", "4d", "9d")
    }
    figure = Figure(figsize=(9, 3.2))
    for column, images in enumerate(photographs[:: max(1, subjects // 6)][:6]):
        for row, image in enumerate(images[:2]):
            axes = figure.add_subplot(2, 6, 1 + column + 6 * row)
            axes.imshow(linear_to_srgb(image), cmap="gray", vmin=0, vmax=1)
            axes.axis("off")
    figure.subplots_adjust(wspace=0.03, hspace=0.03)
    return Measurement(
        [rates["9d"]],
        f"{len(truth)} probes of {size} x {size} pixels; rank-1 of the 3-D subspace "
        f"{rates['3d']:.1%}, 4-D {rates['4d']:.1%}, 9-D {rates['9d']:.1%}.",
        {"Two probes each of six of the subjects.": figure},
    )
