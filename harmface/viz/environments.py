"""Environment maps, tone-mapped, beside what nine coefficients keep of them."""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harmface.conventions import linear_to_srgb
from harmface.light import EnvironmentMap, layout_named, resample
from harmface.rendering import irradiance_map
from harmface.sphere import synthesize
from harmface.viz.figures import NotebookFigure

ROWS = 128


def environment_figure(
    environment: EnvironmentMap, coefficients: Float[np.ndarray, "*channels K"]
) -> Figure:
    """Return a map, its harmonic reconstruction and its irradiance, as lat-long maps.

    Parameters
    ----------
    environment
        The map.
    coefficients
        Its lighting coefficients, radiance.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels: radiance tone-mapped by `v / (v + median)`, the two others relative to their
        maximum. Negative values are black, and how much of all directions they are is said.
    """
    latlong = layout_named("latlong")
    shown = resample(environment, "latlong", ROWS).radiance
    kept = synthesize(coefficients, latlong.directions(ROWS))
    received = irradiance_map(coefficients, "latlong", ROWS)
    figure = NotebookFigure(figsize=(11, 2.3))
    pictures = {
        "radiance (tone-mapped)": shown / (shown + np.median(shown) + 1e-12),
        f"{coefficients.shape[-1]} coefficients{_negative(kept)}": kept / np.abs(kept).max(),
        f"irradiance{_negative(received)}": received / np.abs(received).max(),
    }
    for number, (name, values) in enumerate(pictures.items(), 1):
        show_linear(figure.add_subplot(1, 3, number), values, name)
    figure.subplots_adjust(wspace=0.04)
    return figure


def _negative(values: Float[np.ndarray, "*channels H W"]) -> str:
    """Return words on how much of all directions is negative in a channel, and thus black."""
    weights = layout_named("latlong").solid_angles(ROWS) / (4 * np.pi)
    share = float(((values < 0) * weights).sum(axis=(-2, -1)).max())
    return f" ({share:.1%} < 0, black)" if share > 0 else ""


def show_linear(axes: Axes, values: Float[np.ndarray, "*channels H W"], title: str) -> None:
    """Show linear values, channels first, encoded for the screen.

    Parameters
    ----------
    axes
        Where to.
    values
        Linear values, clipped to [0, 1]; (H, W) or (3, H, W).
    title
        What they are.
    """
    values = np.moveaxis(values, 0, -1) if values.ndim == 3 else values
    axes.imshow(linear_to_srgb(np.clip(values, 0, 1)), cmap="gray", vmin=0, vmax=1)
    axes.set(xticks=[], yticks=[])
    axes.set_title(title, fontsize=9)
