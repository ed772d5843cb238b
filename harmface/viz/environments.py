"""Environment maps, tone-mapped, beside what nine coefficients keep of them."""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harmface.conventions import linear_to_srgb
from harmface.light import EnvironmentMap, layout_named, resample
from harmface.rendering import irradiance_map
from harmface.sphere import synthesize

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
        Its lighting coefficients.
    """
    latlong = layout_named("latlong")
    shown = resample(environment, "latlong", ROWS).radiance
    kept = synthesize(coefficients, latlong.directions(ROWS))
    received = irradiance_map(coefficients, "latlong", ROWS)
    figure = Figure(figsize=(11, 2.3))
    pictures = {
        "radiance (tone-mapped)": shown / (shown + np.median(shown) + 1e-12),
        f"{coefficients.shape[-1]} coefficients": kept / np.abs(kept).max(),
        "irradiance": received / np.abs(received).max(),
    }
    for number, (name, values) in enumerate(pictures.items(), 1):
        show_linear(figure.add_subplot(1, 3, number), values, name)
    figure.subplots_adjust(wspace=0.04)
    return figure


def show_linear(axes: Axes, values: Float[np.ndarray, "*channels H W"], title: str) -> None:
    """Show linear values in [0, 1], channels first, encoded for the screen."""
    values = np.moveaxis(values, 0, -1) if values.ndim == 3 else values
    axes.imshow(linear_to_srgb(np.clip(values, 0, 1)), cmap="gray", vmin=0, vmax=1)
    axes.set(xticks=[], yticks=[])
    axes.set_title(title, fontsize=9)
