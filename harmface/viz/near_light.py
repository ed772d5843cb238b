"""A mesh under lamps near by, by different numbers of samples of the light."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from harmface.viz.environments import show_linear


def near_light_figure(
    panels: Mapping[str, Float[np.ndarray, "3 H W"]], errors: Mapping[str, float]
) -> Figure:
    """Return images side by side at one exposure, as AKDS04 figures 5 and 7.

    Parameters
    ----------
    panels
        Radiosity by what it was made of; the last is the reference, which sets the exposure.
    errors
        Relative error of the light of some of them.

    Returns
    -------
    matplotlib.figure.Figure
        A row of pictures, their errors in the titles.
    """
    white = np.percentile(list(panels.values())[-1], 99.5)
    figure = Figure(figsize=(2.4 * len(panels), 2.8))
    for number, (name, image) in enumerate(panels.items(), 1):
        title = f"{name}\nerror of the light {errors[name]:.0%}" if name in errors else f"{name}\n"
        show_linear(figure.add_subplot(1, len(panels), number), image / white, title)
    figure.subplots_adjust(wspace=0.03)
    return figure
