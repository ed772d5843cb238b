"""Principal components as images, and their shares."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure

from harmface.viz.figures import NotebookFigure, colour_bar


def modes_figure(
    rows: Mapping[str, Float[np.ndarray, "count H W"]],
    fractions: Mapping[str, Float[np.ndarray, "_"]],
    mask: Bool[np.ndarray, "H W"],
) -> Figure:
    """Return modes side by side as R05 figure 9 does: zero is mid grey, positive bright.

    Parameters
    ----------
    rows
        Modes by what they come from, such as "analytic" and "empirical"; a row each.
    fractions
        Share of each mode in the variance, and perhaps of more, for the same names.
    mask
        Pixels of the surface; the background is mid grey.

    Returns
    -------
    matplotlib.figure.Figure
        A row for each of `rows`.
    """
    count = max(len(modes) for modes in rows.values())
    height, width = mask.shape
    figure = NotebookFigure(figsize=(1.7 * count + 0.4, len(rows) * (1.7 * height / width + 0.35)))
    for row, (name, modes) in enumerate(rows.items()):
        for column, mode in enumerate(modes):
            axes = figure.add_subplot(len(rows), count, 1 + row * count + column)
            scale = np.percentile(np.abs(mode[mask]), 99.5) or 1.0
            shown = axes.imshow(np.where(mask, mode, 0), cmap="gray", vmin=-scale, vmax=scale)
            if column == len(modes) - 1:
                bar = colour_bar(axes, shown, "mode / its 99.5th percentile")
                bar.set_ticks([-scale, 0, scale], labels=["−1", "0", "1"])
            axes.set(xticks=[], yticks=[])
            axes.set_title(f"{fractions[name][column]:.1%} of variance", fontsize=8, pad=3)
            if column == 0:
                axes.set_ylabel(name, fontsize=9)
    figure.subplots_adjust(wspace=0.04, hspace=0.2)
    return figure


def spectrum_figure(shares: Mapping[str, Sequence[float]]) -> Figure:
    """Return shares of the variance beside one another, mode by mode.

    Parameters
    ----------
    shares
        Shares of the first modes by what they come from, in [0, 1].

    Returns
    -------
    matplotlib.figure.Figure
        Bars, one group a mode.
    """
    axes = (figure := NotebookFigure(figsize=(7, 3.2))).add_subplot()
    width = 0.8 / len(shares)
    for number, (name, values) in enumerate(shares.items()):
        places = np.arange(1, len(values) + 1) + (number - (len(shares) - 1) / 2) * width
        axes.bar(places, values, width, label=name)
    axes.set(xlabel="mode", ylabel="share of variance", xticks=range(1, 6))
    axes.legend(frameon=False, fontsize=8)
    return figure
