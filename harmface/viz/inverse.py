"""The light of a photograph: what was fitted, what is left, and how well each number is known."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from harmface.conventions import degree_order, linear_to_srgb
from harmface.inverse import LightEstimate
from harmface.light import layout_named
from harmface.rendering import harmonic_irradiance
from harmface.sphere import synthesize
from harmface.viz.recognition import lit_sphere

ROWS = 96
WHITE = 99.5
"""Percentile of the photograph that is shown white."""

LEFT = 0.2
"""Residual, as a share of white, at the ends of the colour scale."""

BARS = 1.96
"""Standard errors that an error bar reaches to either side."""

COLORS = ("#c0392b", "#1e8449", "#2471a3")


def light_figure(
    image: Float[np.ndarray, "H W *channels"],
    estimate: LightEstimate,
    mask: Bool[np.ndarray, "H W"],
) -> Figure:
    """Return photograph, fit, residual and votes above the light as sphere, map and numbers.

    Parameters
    ----------
    image
        The linear photograph that the light was estimated from.
    estimate
        What was found.
    mask
        Where the surface is.

    Returns
    -------
    matplotlib.figure.Figure
        Four pictures above three of the light.
    """
    white = np.percentile(image[mask], WHITE) or 1.0
    fit = np.where(mask, estimate.fit, 0)
    fit = np.moveaxis(fit, 0, -1) if fit.ndim == 3 else fit
    left = image - fit
    left = left.mean(axis=-1) if left.ndim == 3 else left
    votes = estimate.weights
    votes = votes.mean(axis=0) if votes.ndim == 3 else votes
    figure = Figure(figsize=(11, 5.6))
    grid = figure.add_gridspec(2, 8, height_ratios=(1, 1.05), hspace=0.3, wspace=0.35)
    shown = {"photograph": image / white, "under the light found": fit / white}
    for number, (title, values) in enumerate(shown.items()):
        axes = figure.add_subplot(grid[0, 2 * number : 2 * number + 2])
        axes.imshow(linear_to_srgb(np.clip(values, 0, 1)), cmap="gray", vmin=0, vmax=1)
        axes.set_title(title, fontsize=9)
    axes = figure.add_subplot(grid[0, 4:6])
    axes.imshow(np.ma.array(left / white, mask=~mask), cmap="RdBu_r", vmin=-LEFT, vmax=LEFT)
    axes.set_title(f"residual, ±{LEFT:g} of white", fontsize=9)
    axes = figure.add_subplot(grid[0, 6:8])
    axes.imshow(np.ma.array(votes, mask=~mask), cmap="viridis", vmin=0, vmax=1)
    axes.set_title("vote of each pixel", fontsize=9)
    coefficients = np.atleast_2d(estimate.least_norm)
    spheres = [lit_sphere(each) for each in coefficients]
    axes = figure.add_subplot(grid[1, 0:2])
    axes.imshow(_coloured_sphere(estimate, spheres[0][1]))
    axes.set_title("a white sphere in it", fontsize=9)
    axes = figure.add_subplot(grid[1, 2:5])
    radiance = synthesize(coefficients, layout_named("latlong").directions(ROWS))
    radiance = np.moveaxis(radiance, 0, -1) / radiance.max()
    axes.imshow(linear_to_srgb(np.clip(radiance, 0, 1)).squeeze(), cmap="gray", vmin=0, vmax=1)
    x, y, z = estimate.direction
    azimuth, elevation = np.arctan2(x, z), np.arcsin(np.clip(y, -1, 1))
    axes.plot(
        ROWS * (1 - azimuth / np.pi) - 0.5, ROWS * (0.5 - elevation / np.pi) - 0.5, "+", color="red"
    )
    axes.set_title("radiance, lat-long, +z in the middle", fontsize=9)
    for axes in figure.axes:
        axes.set(xticks=[], yticks=[])
    _error_bars(figure, grid[1, 5:8], estimate)
    return figure


def _coloured_sphere(estimate: LightEstimate, inside: np.ndarray) -> np.ndarray:
    side = len(inside)
    across = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(across, -across)
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)[inside]
    received = np.maximum(harmonic_irradiance(np.atleast_2d(estimate.least_norm), normals), 0)
    image = np.ones((side, side, 3))
    image[inside] = linear_to_srgb(received / (received.max() or 1)).T
    return image


def _error_bars(figure: Figure, place: SubplotSpec, estimate: LightEstimate) -> None:
    axes = figure.add_subplot(place)
    values = np.atleast_2d(estimate.coefficients)
    errors = np.atleast_2d(estimate.standard_errors)
    colors = COLORS if len(values) == len(COLORS) else ("black",) * len(values)
    places = np.arange(values.shape[1])
    for number, (own, spread, color) in enumerate(zip(values, errors, colors, strict=True)):
        known = np.isfinite(own)
        shift = 0.2 * (number - (len(values) - 1) / 2)
        axes.errorbar(
            places[known] + shift,
            own[known],
            BARS * spread[known],
            fmt="o",
            ms=3,
            lw=1,
            color=color,
            capsize=2,
        )
    top = np.nanmax(np.abs(values)) * 1.3
    axes.set(ylim=(-top, top), xlim=(-0.6, values.shape[1] - 0.4))
    for k in places[~estimate.determined]:
        axes.axvspan(k - 0.5, k + 0.5, color="0.85", lw=0)
    axes.axhline(0, color="0.6", lw=0.6)
    labels = ["{},{}".format(*degree_order(int(k))) for k in places]
    axes.set_xticks(places, labels, fontsize=6, rotation=60 if len(labels) > 9 else 0)
    axes.tick_params(axis="y", labelsize=7)
    axes.set_title("coefficients l,m and their 95 % intervals", fontsize=9)
