"""Figures, by matplotlib and pyvista; the only place where either is imported."""

from harmface.viz.environments import environment_figure, show_linear
from harmface.viz.figures import figure_bytes, write_figure
from harmface.viz.harmonics import basis_figure
from harmface.viz.modes import modes_figure, spectrum_figure
from harmface.viz.stereo import stereo_figure

__all__ = [
    "basis_figure",
    "environment_figure",
    "figure_bytes",
    "modes_figure",
    "show_linear",
    "spectrum_figure",
    "stereo_figure",
    "write_figure",
]
