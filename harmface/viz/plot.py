"""One line draws a result: `viz.plot(result)`; `plot` names the kinds that it knows."""

from collections.abc import Mapping
from functools import singledispatch
from typing import Any

import matplotlib as mpl
import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harmface.conventions import light_direction, linear_to_srgb
from harmface.errors import ArgumentError
from harmface.geometry import GBuffer, Mesh, frame_orthographic, gbuffer
from harmface.inverse import LightEstimate
from harmface.light import DistantLight, EnvironmentMap, project
from harmface.pca import EmpiricalPCA, LightingPCA
from harmface.recognition import Gallery, SubjectClassifier
from harmface.rendering import clamped_cosines
from harmface.sphere import synthesize
from harmface.stereo import StereoResult
from harmface.viz.environments import environment_figure, show_linear
from harmface.viz.evaluation import evaluation_figure
from harmface.viz.harmonics import BACKGROUND
from harmface.viz.inverse import light_figure
from harmface.viz.modes import modes_figure

SHOWN = 5
"""Modes, or photographs a subject, that are drawn."""

SUBJECTS = 8
"""Subjects of a gallery that are drawn."""

SIDE = 192
"""Rows and columns of a mesh, or of the sphere that shows functions of the normal."""


@singledispatch
def plot(result: Any) -> Figure:
    """Return a figure of a result, whatever it is of.

    Parameters
    ----------
    result
        An environment map, directional lights, the light of a photograph, a mesh or what a camera
        sees of it, a stereo result, analytic or empirical principal components, a gallery or a
        fitted classifier, or what `harmface evaluate` found (a mapping of methods). Arrays have
        figures with names: `basis_figure` for harmonic images, `explanation_figure` for answers.

    Returns
    -------
    matplotlib.figure.Figure
        To be shown, or written by `write_figure`.

    Raises
    ------
    ArgumentError
        If nothing is known of such a result.
    """
    known = sorted(kind.__name__ for kind in plot.registry if kind is not object)
    raise ArgumentError(
        f"result must be one of {', '.join(known)}, got {type(result).__name__}; arrays have "
        "figures by name, such as basis_figure"
    )


@plot.register
def _map(result: EnvironmentMap) -> Figure:
    return environment_figure(result, project(result, 2))


@plot.register
def _lights(result: DistantLight) -> Figure:
    """Draw directions as the camera sees them, a disc's area being its light's irradiance."""
    figure = Figure(figsize=(4.4, 4.2), layout="constrained")
    axes = figure.add_subplot()
    strengths = result.irradiances.reshape(-1, len(result.directions)).mean(axis=0)
    areas = 200 * strengths / (strengths.max() or 1)
    x, y, z = result.directions.T
    front = z >= 0
    axes.scatter(x[front], y[front], areas[front], label="in front", color="C0")
    axes.scatter(
        x[~front], y[~front], areas[~front], label="behind", facecolors="none", edgecolors="C1"
    )
    axes.add_patch(mpl.patches.Circle((0, 0), 1, fill=False, color="0.6", lw=0.8))
    axes.set(xlabel="x, to the right", ylabel="y, up", title="lights, by direction", aspect="equal")
    axes.legend(frameon=False, fontsize=8)
    return figure


@plot.register
def _estimate(result: LightEstimate) -> Figure:
    if len(result.shape) != 2:
        raise ArgumentError(f"result must be of a picture, got one of shape {result.shape}")
    mask = np.zeros(result.shape, bool)
    mask.flat[np.concatenate(result.pixels.blocks)] = True
    image = np.moveaxis(result.pixels.values.reshape(-1, *result.shape), 0, -1)
    return light_figure(image[..., 0] if image.shape[-1] == 1 else image, result, mask)


@plot.register
def _mesh(result: Mesh) -> Figure:
    return plot(gbuffer(result, frame_orthographic(result, SIDE), 2))


@plot.register
def _view(result: GBuffer) -> Figure:
    lit = clamped_cosines(result.normals, light_direction(-20, 30)[None])[0]
    figure, axes = _row(4)
    _coded(axes[0], (result.normals + 1) / 2, result.mask, "normals (n + 1) / 2")
    _coded(axes[1], linear_to_srgb(np.clip(result.albedo, 0, 1)), result.mask, "albedo")
    _coloured(axes[2], -result.depth, result.mask, "height towards the viewer")
    _coded(axes[3], np.repeat(lit[..., None], 3, axis=2), result.mask, "lit from the upper left")
    return figure


@plot.register
def _stereo(result: StereoResult) -> Figure:
    figure, axes = _row(4)
    mask = result.mask
    lit = clamped_cosines(result.normals, light_direction(-50, 20)[None])[0]
    white = np.percentile(result.albedo[mask], 99) or 1.0
    _coded(axes[0], (result.normals + 1) / 2, mask, "normals (n + 1) / 2")
    _coded(axes[1], _grey(result.albedo / white), mask, "albedo")
    _coded(axes[2], _grey(lit * result.albedo / white), mask, "lit from the left")
    _coloured(axes[3], result.expected_error, mask, "expected error of a normal, degrees")
    return figure


@plot.register
def _analytic(result: LightingPCA) -> Figure:
    """Draw modes as functions of the normal, on a sphere seen from the front."""
    across = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = np.meshgrid(across, -across)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    modes = np.zeros((min(SHOWN, len(result.expansion)), SIDE, SIDE))
    normals = np.stack([x, y, z], axis=-1)[inside]
    modes[:, inside] = synthesize(result.expansion[: len(modes)], normals)
    return modes_figure(
        {"modes of a white sphere": modes}, {"modes of a white sphere": result.fractions}, inside
    )


@plot.register
def _empirical(result: EmpiricalPCA) -> Figure:
    if result.weights.ndim != 2:
        raise ArgumentError(
            f"result must be of images to be drawn, got pixels of shape {result.weights.shape}"
        )
    return modes_figure(
        {"modes": result.modes[:SHOWN]}, {"modes": result.fractions}, result.weights > 0
    )


@plot.register
def _gallery(result: Gallery) -> Figure:
    """Draw the first photographs of the first subjects."""
    names = result.names[:SUBJECTS]
    each = [
        result.photographs.images[result.photographs.subjects == name][:SHOWN] for name in names
    ]
    columns = max(map(len, each))
    figure = Figure(figsize=(1.3 * columns + 0.6, 1.4 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), columns, squeeze=False)
    for row, (name, images) in enumerate(zip(names, each, strict=True)):
        for place in axes[row]:
            place.set_axis_off()
        for place, image in zip(axes[row], images, strict=False):
            show_linear(place, image / (np.percentile(image, 99.5) or 1.0), "")
        axes[row, 0].set_title(str(name), fontsize=9, loc="left", parse_math=False)
    figure.suptitle(result.summary, fontsize=9)
    return figure


@plot.register
def _classifier(result: SubjectClassifier) -> Figure:
    return plot(result.gallery_)


@plot.register
def _evaluation(result: Mapping) -> Figure:
    return evaluation_figure(result)


def _row(count: int) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(3.2 * count, 3.1), layout="constrained")
    return figure, list(figure.subplots(1, count))


def _grey(values: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "H W 3"]:
    """Return linear values encoded for the screen, in three channels."""
    return np.repeat(linear_to_srgb(np.clip(values, 0, 1))[..., None], 3, axis=2)


def _coded(axes: Axes, rgb: Float[np.ndarray, "H W 3"], mask: np.ndarray, title: str) -> None:
    axes.imshow(np.where(mask[..., None], rgb, mpl.colors.to_rgb(BACKGROUND)))
    axes.set(xticks=[], yticks=[])
    axes.set_title(title, fontsize=9)


def _coloured(axes: Axes, values: np.ndarray, mask: np.ndarray, title: str) -> None:
    axes.set_facecolor(BACKGROUND)
    shown = axes.imshow(np.ma.array(values, mask=~mask), cmap="cividis")
    axes.figure.colorbar(shown, ax=axes, shrink=0.8)
    axes.set(xticks=[], yticks=[])
    axes.set_title(title, fontsize=9)
