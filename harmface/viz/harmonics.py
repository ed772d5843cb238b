"""Harmonic images laid out by degree and order."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from harmface.conventions import degree_order, max_degree_of
from harmface.viz.figures import NotebookFigure, colour_bar

SIGNED = LinearSegmentedColormap.from_list(
    "signed", ["#5b8cff", "#2b56c9", "#000000", "#2f9d3c", "#7be887"]
)
"""Green above zero, blue below, black at zero: the colours of RH01 figure 4 and R05 figure 5."""

BACKGROUND = "#b8b8b8"


TITLE = 0.5
"""Inches above the first row, for the title of all."""

VANISHING = 1e-9
"""Share of the largest degree below which a degree is taken for zero."""


def basis_figure(images: Float[np.ndarray, "K H W"], mask: Bool[np.ndarray, "H W"]) -> Figure:
    """Return harmonic images as a pyramid: a row for each degree, orders from left to right.

    Green is positive, blue negative and black zero; each degree has its own scale, its 99th
    percentile, beside its row, so that the weak high degrees can be seen. Degrees that vanish,
    as odd ones above the first do, say so.

    Parameters
    ----------
    images
        Harmonic images `albedo A_l Y_lm(n)`: irradiance per unit of a lighting coefficient.
    mask
        Pixels of the surface; the rest is left grey.

    Returns
    -------
    matplotlib.figure.Figure
        One panel for each image.
    """
    top = max_degree_of(len(images))
    height, width = mask.shape
    side = min(1.7, 16 / (2 * top + 1))
    inches = side * (top + 1) * height / width * 1.12 + 0.5
    figure = NotebookFigure(figsize=(side * (2 * top + 1) + 1.2, inches), facecolor="white")
    grid = figure.add_gridspec(
        top + 1, 2 * top + 1, wspace=0.05, hspace=0.18, top=1 - TITLE / inches
    )
    sizes = np.abs(images[:, mask])
    scales = np.array(
        [np.percentile(sizes[d**2 : (d + 1) ** 2], 99.0) for d in range(top + 1)], float
    )
    vanishing = scales <= VANISHING * (scales.max() or 1.0)
    scales[vanishing] = 1.0
    for k, image in enumerate(images):
        degree, order = degree_order(k)
        axes = figure.add_subplot(grid[degree, top + order])
        axes.set_facecolor(BACKGROUND)
        scale = scales[degree]
        shown = axes.imshow(
            np.ma.array(image, mask=~mask), cmap=SIGNED, vmin=-scale, vmax=scale, aspect="equal"
        )
        axes.set(xticks=[], yticks=[])
        # Its argument is the same everywhere, and named once, above.
        axes.set_title(f"$A_{{{degree}}} Y_{{{degree},{order}}}$", fontsize=8, pad=2)
        if vanishing[degree]:
            axes.text(
                *(0.5, 0.5, "zero"),
                ha="center",
                va="center",
                fontsize=7,
                color="white",
                transform=axes.transAxes,
            )
        elif order == degree:
            colour_bar(axes, shown, "irradiance / $L_{lm}$")
    figure.suptitle(r"harmonic images $\rho\, A_l\, Y_{lm}(n)$", fontsize=10, y=1.0)
    return figure
