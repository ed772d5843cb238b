"""Claims on photometric stereo under unknown light."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from matplotlib.figure import Figure

from data_synth.faces import head
from data_synth.lightings import mixed
from data_synth.shapes import SHAPES
from harmface.conventions import luminance
from harmface.geometry import GBuffer, Mesh, frame_orthographic, gbuffer
from harmface.rendering import harmonic_images, relight, render
from harmface.reproduce.experiment import Measurement
from harmface.reproduce.synthetic import light_of, mesh_of
from harmface.stereo import (
    angular_errors,
    factorize,
    fit_null_cone,
    lorentz_deviation,
    photometric_stereo,
    without_linear_map,
)

SIZE = 48
IMAGES = 64
METHODS = ("4d", "9d", "refined")


@lru_cache(maxsize=1)
def _objects() -> dict[str, tuple[GBuffer, np.ndarray]]:
    """Return the standard objects, and their images by the oracle: attached shadows only."""
    makers: dict[str, Callable[[], Mesh]] = {
        name: lambda name=name: mesh_of(SHAPES[name]())  # type: ignore[misc]
        for name in ("sphere", "ellipsoid", "vase", "bumpy_sphere", "ripples", "hills")
    }
    makers |= {f"head {seed}": lambda seed=seed: mesh_of(head(seed)) for seed in (1, 2)}  # type: ignore[misc]
    made = {}
    for number, (name, make) in enumerate(makers.items()):
        mesh = make()
        view = gbuffer(mesh, frame_orthographic(mesh, SIZE))
        made[name] = (view, render(view, light_of(mixed(IMAGES, number, directions=256))))
    return made


def rank() -> Measurement:
    """Tell how much of the images' energy is in their best approximations of rank 4 and 9."""
    shares = {
        name: factorize(images[:, view.mask], 9).energy
        for name, (view, images) in _objects().items()
    }
    worst = np.min([[energy[3], energy[8]] for energy in shares.values()], axis=0)
    listed = "; ".join(f"{name} {e[3]:.4f} / {e[8]:.4f}" for name, e in shares.items())
    return Measurement(
        worst.tolist(),
        f"{IMAGES} images of each object under mixtures of ambient, area and point lights; the "
        f"least of all objects. Rank 4 / 9: {listed}.",
    )


def lorentz() -> Measurement:
    """Hold the first-order structure of exact degree-1 images against the true one."""
    view, _ = _objects()["bumpy_sphere"]
    basis = harmonic_images(view.normals[view.mask], luminance(view.albedo[view.mask]), 1)
    lighting = np.random.default_rng(0).standard_normal((IMAGES, 4))
    lighting[:, 0] += 3
    found = factorize(relight(lighting, basis), 4)
    recovered = fit_null_cone(found.structure).frame @ found.structure
    ones = np.ones((1, view.mask.sum()))
    scaled = luminance(view.albedo[view.mask]) * np.vstack([ones, view.normals[view.mask].T])
    transformation = np.linalg.lstsq(scaled.T, recovered.T, rcond=None)[0].T
    return Measurement(
        [lorentz_deviation(transformation)],
        f"{view.mask.sum()} pixels of a bumpy sphere; A is the best linear map from the true "
        "(albedo, albedo n) to the recovered structure.",
    )


def normals() -> Measurement:
    """Recover the standard objects with nothing known, by each method."""
    errors: dict[str, list[float]] = {name: [] for name in METHODS}
    oracles: dict[str, list[float]] = {"4-D": [], "9-D": []}
    maps: dict[str, list[np.ndarray]] = {}
    for shape, (view, images) in _objects().items():
        truth = view.normals[view.mask]
        maps[shape] = [_as_picture(view.normals, view)]
        for name in METHODS:
            found = photometric_stereo(images, view.mask, method=name)
            errors[name].append(float(angular_errors(found.normals[view.mask], truth).mean()))
            maps[shape].append(_as_picture(found.normals, view))
        for name, dimension in (("4-D", 4), ("9-D", 9)):
            space = factorize(images[:, view.mask], dimension).structure.T
            nearest = without_linear_map(space, truth)
            oracles[name].append(float(angular_errors(nearest, truth).mean()))
    listed = "; ".join(
        f"{name} " + " / ".join(f"{values[i]:.1f}" for values in errors.values())
        for i, name in enumerate(_objects())
    )
    bounds = ", ".join(f"{name} {np.median(each):.1f}" for name, each in oracles.items())
    return Measurement(
        [float(np.median(values)) for values in errors.values()],
        "Mean angular errors in degrees, 4d / 9d / refined, in "
        f"{IMAGES} images of {SIZE} x {SIZE}: {listed}. The oracle, the best linear map from the "
        f"images' space to the true scaled normals, has a median of {bounds}.",
        {"Normals: truth, 4d, 9d, refined.": _normals_figure(maps)},
    )


def _as_picture(normals: np.ndarray, view: GBuffer) -> np.ndarray:
    return np.where(view.mask[..., None], (normals + 1) / 2, 1)


def _normals_figure(maps: dict[str, list[np.ndarray]]) -> Figure:
    figure = Figure(figsize=(1.5 * len(maps), 6.2))
    for column, (name, pictures) in enumerate(maps.items()):
        for row, picture in enumerate(pictures):
            axes = figure.add_subplot(4, len(maps), 1 + column + row * len(maps))
            axes.imshow(picture)
            axes.axis("off")
            if row == 0:
                axes.set_title(name, fontsize=8)
    figure.subplots_adjust(wspace=0.03, hspace=0.03)
    return figure
