"""Figures, by matplotlib and pyvista; the only place where either is imported."""

from harmface.viz.environments import environment_figure, show_linear
from harmface.viz.evaluation import evaluation_figure
from harmface.viz.figures import figure_bytes, write_figure
from harmface.viz.harmonics import basis_figure
from harmface.viz.modes import modes_figure, spectrum_figure
from harmface.viz.near_light import near_light_figure
from harmface.viz.recognition import Explanation, explanation_figure, lit_sphere
from harmface.viz.stereo import stereo_figure

__all__ = [
    "Explanation",
    "basis_figure",
    "environment_figure",
    "evaluation_figure",
    "explanation_figure",
    "figure_bytes",
    "lit_sphere",
    "modes_figure",
    "near_light_figure",
    "show_linear",
    "spectrum_figure",
    "stereo_figure",
    "write_figure",
]
