"""A map beside what a glossy material shows of it."""

import numpy as np
from matplotlib.figure import Figure

from harmface.light import EnvironmentMap, resample
from harmface.viz.environments import ROWS, show_linear
from harmface.viz.figures import NotebookFigure


def reflection_figure(
    environment: EnvironmentMap, reflected: EnvironmentMap, material: str
) -> Figure:
    """Return a map and its reflection, as lat-long maps with the same tones.

    Parameters
    ----------
    environment, reflected
        The map, and what `rendering.reflection_map` made of it.
    material
        What to call the material.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, tone-mapped by `v / (v + m)`, m being the median of the first.
    """
    shown = [resample(each, "latlong", ROWS).radiance for each in (environment, reflected)]
    median = np.median(shown[0]) + 1e-12
    figure = NotebookFigure(figsize=(8.4, 2.5))
    titles = ("radiance", f"shown by {material}, by the mirrored direction")
    for number, (name, values) in enumerate(zip(titles, shown, strict=True), 1):
        show_linear(figure.add_subplot(1, 2, number), values / (values + median), name)
    figure.subplots_adjust(wspace=0.04)
    return figure
