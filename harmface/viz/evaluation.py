"""How recognisers did on the same probes: by lighting subset, by rank, as verification."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from harmface.viz.figures import NotebookFigure

RANKS = 20
"""Ranks of the cumulative match that are shown."""


def evaluation_figure(methods: Mapping[str, Mapping[str, Any]]) -> Figure:
    """Return errors by subset with their intervals, cumulative match, ROC and reliability.

    Parameters
    ----------
    methods
        What `harmface evaluate` found of each: `subsets` of `errors`, `probes` and `interval`;
        `cumulative_match`; `roc` of `false_accepts`, `true_accepts` and `true_accepts_relative`;
        `reliability` of `claimed`, `right` and `count`, or None without probabilities.

    Returns
    -------
    matplotlib.figure.Figure
        Four panels side by side.
    """
    figure = NotebookFigure(figsize=(18, 3.9), layout="constrained")
    by_subset, by_rank, verification, trust = figure.subplots(1, 4)
    colors = {name: f"C{number % 10}" for number, name in enumerate(methods)}
    _bars(by_subset, methods, colors)
    for number, (name, found) in enumerate(methods.items()):
        # Curves that coincide stay visible under one another.
        style = {"color": colors[name], "lw": 1.5 + 0.7 * (len(methods) - 1 - number)}
        match = np.array(found["cumulative_match"][:RANKS])
        by_rank.plot(1 + np.arange(len(match)), 100 * match, label=name, **style)
        rates, absolute, relative = (100 * np.array(curve) for curve in found["roc"].values())
        verification.plot(rates, relative, **style)
        verification.plot(rates, absolute, color=colors[name], lw=0.8, ls=":")
        if found["reliability"] is not None:
            claimed, right, count = (
                np.array(found["reliability"][key]) for key in ("claimed", "right", "count")
            )
            some = count > 0
            trust.plot(100 * claimed[some], 100 * right[some], "o-", color=colors[name])
    trust.plot([0, 100], [0, 100], color="0.6", lw=0.8, ls="--")
    trust.set(title="reliability of the probabilities", xlabel="claimed, %", ylabel="right, %")
    by_rank.set(title="cumulative match", xlabel="rank", ylabel="probes, %")
    by_rank.xaxis.set_major_locator(MaxNLocator(integer=True))
    by_rank.legend(frameon=False, fontsize=8)
    verification.set(
        title="verification of the enrolled\nby relative distance (dotted: by distance)",
        xlabel="false accepts, %",
        ylabel="true accepts, %",
        xscale="log",
    )
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _bars(axes: Axes, methods: Mapping[str, Mapping[str, Any]], colors: Mapping[str, str]) -> None:
    """Draw a group of bars for each subset, a bar for each method."""
    width = 0.8 / len(methods)
    subsets = next(iter(methods.values()))["subsets"]
    for place, (name, found) in enumerate(methods.items()):
        rates = [found["subsets"][number] for number in subsets]
        heights = np.array([100 * rate["errors"] / rate["probes"] for rate in rates])
        low, high = 100 * np.array([rate["interval"] for rate in rates]).T
        axes.bar(
            np.arange(len(subsets)) + (place - (len(methods) - 1) / 2) * width,
            heights,
            width,
            color=colors[name],
            yerr=np.maximum([heights - low, high - heights], 0),
            error_kw={"lw": 0.8},
        )
    named = [
        f"{'all' if number == '0' else f'subset {number}'}\n{rate['probes']} probes"
        for number, rate in subsets.items()
    ]
    axes.set(title="errors at rank 1", ylabel="probes, %", xticks=range(len(named)))
    axes.set_xticklabels(named, fontsize=8)
