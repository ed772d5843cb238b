"""Harmonic images laid out by degree and order."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from harmface.conventions import degree_order, max_degree_of

SIGNED = LinearSegmentedColormap.from_list(
    "signed", ["#5b8cff", "#2b56c9", "#000000", "#2f9d3c", "#7be887"]
)
"""Green above zero, blue below, black at zero: the colours of RH01 figure 4 and R05 figure 5."""

BACKGROUND = "#b8b8b8"


def basis_figure(images: Float[np.ndarray, "K H W"], mask: Bool[np.ndarray, "H W"]) -> Figure:
    """Return harmonic images as a pyramid: a row for each degree, orders from left to right.

    Green is positive, blue negative and black zero; each degree has its own scale, its 99th
    percentile, which its row tells, so that the weak high degrees can be seen.

    Parameters
    ----------
    images
        Harmonic images.
    mask
        Pixels of the surface; the rest is left grey.
    """
    top = max_degree_of(len(images))
    height, width = mask.shape
    side = min(1.7, 16 / (2 * top + 1))
    figure = Figure(
        figsize=(side * (2 * top + 1) + 1.2, side * (top + 1) * height / width * 1.12 + 0.3),
        facecolor="white",
    )
    grid = figure.add_gridspec(top + 1, 2 * top + 1, wspace=0.05, hspace=0.15)
    sizes = np.abs(images[:, mask])
    scales = [
        np.percentile(sizes[degree**2 : (degree + 1) ** 2], 99.0) or 1.0
        for degree in range(top + 1)
    ]
    for k, image in enumerate(images):
        degree, order = degree_order(k)
        axes = figure.add_subplot(grid[degree, top + order])
        axes.set_facecolor(BACKGROUND)
        scale = scales[degree]
        axes.imshow(
            np.ma.array(image, mask=~mask), cmap=SIGNED, vmin=-scale, vmax=scale, aspect="equal"
        )
        axes.set(xticks=[], yticks=[])
        axes.set_title(f"$Y_{{{degree},{order}}}$", fontsize=8, pad=2)
        if order == -degree:
            axes.set_ylabel(f"±{scale:.3g}", fontsize=7)
    return figure
