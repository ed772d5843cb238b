"""Why a face was given its name: the probe beside what the nearest subjects can look like."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harmface.conventions import linear_to_srgb, max_degree_of
from harmface.rendering import harmonic_images, relight
from harmface.viz.figures import NotebookFigure, colour_bar

WHITE = 99.5
"""Percentile of the probe that is shown white, in its reconstructions too."""

DIFFERENCE = 0.25
"""Difference, as a share of white, that takes the end of the colour scale."""

SPHERE = 96
"""Rows of the sphere that shows the light."""

BACKGROUND = "#d8d8d8"


@dataclass(frozen=True, eq=False)
class Explanation:
    """What is shown of one probe.

    Parameters
    ----------
    name
        Its title.
    probe
        Linear values.
    subjects
        Titles of the nearest subject and of the runner-up, if there is one, each with the image
        nearest to the probe that the subject can look like.
    light
        Harmonic coefficients of the light that does so for the nearest; None if that is unknown.
    """

    name: str
    probe: Float[np.ndarray, "H W"]
    subjects: Sequence[tuple[str, Float[np.ndarray, "H W"]]]
    light: Float[np.ndarray, "K"] | None


def explanation_figure(
    explanations: Sequence[Explanation], mask: Bool[np.ndarray, "H W"]
) -> Figure:
    """Return a row for each probe: it, its light, and the two nearest subjects made to look so.

    Beside each reconstruction stands the probe less it, red where the probe is brighter. All
    images of a row share one exposure, and are encoded for the screen. Light that the fit takes
    as negative leaves the sphere black.

    Parameters
    ----------
    explanations
        One or more.
    mask
        Pixels that were compared; the rest of a reconstruction is left grey.

    Returns
    -------
    matplotlib.figure.Figure
        A row for each probe.
    """
    lit = any(each.light is not None for each in explanations)
    first = 1 + lit
    columns = first + 2 * max(len(each.subjects) for each in explanations)
    height = 1.7 * mask.shape[0] / mask.shape[1] + 0.3
    figure = NotebookFigure(figsize=(1.7 * columns, height * len(explanations)))
    for row, each in enumerate(explanations):
        axes = [
            figure.add_subplot(len(explanations), columns, 1 + row * columns + column)
            for column in range(columns)
        ]
        white = np.percentile(each.probe[mask], WHITE) or 1.0
        _show(axes[0], each.name, each.probe / white)
        if each.light is not None:
            sphere, inside = lit_sphere(each.light)
            negative = float((sphere[inside] < 0).mean())
            title = f"light ({negative:.0%} < 0, black)" if negative >= 0.005 else "light"
            _show(axes[1], title, sphere, inside)
        for number, (title, picture) in enumerate(each.subjects):
            _show(axes[first + 2 * number], title, picture / white, mask)
            difference = np.ma.array((each.probe - picture) / white, mask=~mask)
            panel = axes[first + 2 * number + 1]
            panel.set_facecolor(BACKGROUND)
            shown = panel.imshow(difference, cmap="RdBu_r", vmin=-DIFFERENCE, vmax=DIFFERENCE)
            panel.set_title("probe less it", fontsize=7)
            if number == len(each.subjects) - 1:
                colour_bar(panel, shown, "share of white")
        for each_axes in axes:
            each_axes.set(xticks=[], yticks=[])
            each_axes.set_frame_on(each_axes.has_data())
    figure.subplots_adjust(wspace=0.06, hspace=0.2)
    return figure


def lit_sphere(
    light: Float[np.ndarray, "K"],
) -> tuple[Float[np.ndarray, "R R"], Bool[np.ndarray, "R R"]]:
    """Return a white sphere under a light, its brightest point 1, and where it is.

    Parameters
    ----------
    light
        Harmonic coefficients.

    Returns
    -------
    tuple of numpy.ndarray
        Irradiance relative to its maximum, (96, 96) float64, which a fit may make negative, and
        the pixels of the sphere.
    """
    across = (np.arange(SPHERE) + 0.5) / SPHERE * 2 - 1
    x, y = np.meshgrid(across, -across)
    squared = x**2 + y**2
    inside = squared < 1
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - squared, 0))], axis=-1)[inside]
    basis = harmonic_images(normals, np.ones(len(normals)), max_degree_of(len(light)))
    received = relight(light.astype(np.float64), basis)
    image = np.zeros(inside.shape)
    image[inside] = received / (max(received.max(), 0.0) or 1.0)
    return image, inside


def _show(
    axes: Axes,
    title: str,
    values: Float[np.ndarray, "H W"],
    mask: Bool[np.ndarray, "H W"] | None = None,
) -> None:
    shown = linear_to_srgb(np.clip(values, 0, 1))
    axes.set_facecolor(BACKGROUND)
    axes.imshow(
        shown if mask is None else np.ma.array(shown, mask=~mask), cmap="gray", vmin=0, vmax=1
    )
    axes.set_title(title, fontsize=7)
