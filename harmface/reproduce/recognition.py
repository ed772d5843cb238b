"""Claims on recognition by distance to a subspace."""

import numpy as np
from matplotlib.figure import Figure

from data_synth.faces import head
from data_synth.lightings import mixed, nine_points, yale64, yale_subset
from harmface.conventions import linear_to_srgb
from harmface.recognition import (
    HarmonicSubspaceClassifier,
    enroll,
    non_negative_distances,
    orthonormal_basis,
    subspace_distances,
)
from harmface.recognition.baselines import recognizer
from harmface.recognition.evaluation import errors_by_subset
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


GRID_IDENTITY_SCALE = 0.5
"""Ten real people resemble each other more than as many procedural ones."""

LHK05 = {
    "3-D linear": (0.0, 0.0, 15.0),
    "eigenfaces": (None, None, 75.7),
    "9-D harmonic": (0.0, 0.0, 3.57),
    "9-D with cast shadows": (0.0, 0.0, 2.7),
    "nine points of light": (0.0, 0.0, 0.0),
}
"""Errors in per cent on subsets 1-2, 3 and 4, LHK05 table 2: Yale B, ten people."""


def light_grid(subjects: int = 20, size: int = 48, seed: int = 2005) -> Measurement:
    """Put every recogniser to the 64 lights of the Yale grid, cast shadows and noise on.

    Harmonic subspaces are enrolled from meshes; the others from photographs, seven frontal ones of
    each subject or the nine points of light.
    """
    meshes = {
        f"subject {number:02d}": mesh_of(
            head(subject_seed(seed, number), identity_scale=GRID_IDENTITY_SCALE)
        )
        for number in range(subjects)
    }
    grid = yale64()
    subset = yale_subset(grid.directions)
    rng = np.random.default_rng(seed)
    photographs = np.stack([probe_images(mesh, grid, size, rng) for mesh in meshes.values()])
    nine = np.stack([probe_images(mesh, nine_points(), size, rng) for mesh in meshes.values()])
    galleries = {shadows: enroll(meshes, size, cast_shadows=shadows) for shadows in (False, True)}
    mask = galleries[False].mask
    truth = np.repeat(np.arange(subjects), len(subset))
    probes = photographs.reshape(-1, size, size)
    pixels = probes[:, mask]
    frontal = photographs[:, subset == 1]

    def by_subspace(images: np.ndarray, dimension: int) -> np.ndarray:
        return subspace_distances(pixels, orthonormal_basis(images[..., mask], dimension))

    def by_photographs(method: str, gallery: np.ndarray) -> np.ndarray:
        each = gallery.shape[1]
        found = recognizer(method, (size, size), each)
        found.fit(gallery.reshape(subjects * each, -1), np.repeat(np.arange(subjects), each))
        return found[-1].distances(probes.reshape(len(probes), -1))

    distances = {
        "3-D linear": by_subspace(frontal, 3),
        "eigenfaces": by_photographs("eigenfaces", frontal),
        "correlation": by_photographs("correlation", frontal),
        "fisherfaces": by_photographs("fisherfaces", frontal),
        "gradient direction": by_photographs("gradient-direction", frontal),
        "LBPH": by_photographs("lbph", frontal),
        "9-D harmonic": by_subspace(galleries[False].images, 9),
        "9-D with cast shadows": by_subspace(galleries[True].images, 9),
        "9-D, non-negative light": non_negative_distances(
            pixels, galleries[True].images[..., mask].astype(np.float64)
        ),
        "nine points of light": by_subspace(nine, 9),
        "local, seven frontal": by_photographs("local", frontal),
        "local, nine points": by_photographs("local", nine),
    }
    rates = {
        name: [
            100 * rate.rate
            for rate in errors_by_subset(each, truth, np.tile(subset, subjects)).values()
        ]
        for name, each in distances.items()
    }
    listed = "; ".join(
        f"{name} {' / '.join(f'{value:.1f}' for value in values)}" for name, values in rates.items()
    )
    published = "; ".join(
        f"{name} {' / '.join('-' if value is None else f'{value:g}' for value in values)}"
        for name, values in LHK05.items()
    )
    return Measurement(
        [rates[name][3] for name in LHK05],
        f"Errors in per cent on subset 4 in the order {', '.join(LHK05)}. All methods, subsets 1 "
        f"to 5, {subjects} synthetic subjects at identity scale {GRID_IDENTITY_SCALE}: {listed}. "
        f"LHK05 table 2, Yale B, subsets 1-2 / 3 / 4: {published}. Subset 1 is in the frontal "
        "galleries, so its errors there are of the gallery itself.",
        {"Errors by lighting subset.": _rates_figure(rates)},
    )


def _rates_figure(rates: dict[str, list[float]]) -> Figure:
    figure = Figure(figsize=(8, 0.33 * len(rates) + 1))
    axes = figure.add_subplot()
    table = np.array(list(rates.values()))
    axes.imshow(np.sqrt(table), cmap="Reds", vmin=0, vmax=10, aspect="auto")
    for (row, column), value in np.ndenumerate(table):
        axes.text(column, row, f"{value:.1f}", ha="center", va="center", fontsize=8)
    axes.set(
        xticks=range(5),
        xticklabels=[f"subset {k}" for k in range(1, 6)],
        yticks=range(len(rates)),
        yticklabels=list(rates),
    )
    axes.tick_params(length=0, labelsize=8)
    return figure
