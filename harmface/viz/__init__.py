"""Figures, by matplotlib and pyvista; the only place where either is imported."""

from harmface.viz.decimation import decimated
from harmface.viz.environments import environment_figure, show_linear
from harmface.viz.evaluation import evaluation_figure
from harmface.viz.figures import figure_bytes, write_figure
from harmface.viz.film import film_figure
from harmface.viz.glossy import reflection_figure
from harmface.viz.harmonics import basis_figure
from harmface.viz.interactive import interactive
from harmface.viz.inverse import light_figure
from harmface.viz.modes import modes_figure, spectrum_figure
from harmface.viz.near_light import near_light_figure
from harmface.viz.plot import plot
from harmface.viz.recognition import Explanation, explanation_figure, lit_sphere
from harmface.viz.stereo import stereo_figure
from harmface.viz.viewer import Viewer, confidence_colours, subject_viewer, viewer

__all__ = [
    "Explanation",
    "Viewer",
    "basis_figure",
    "confidence_colours",
    "decimated",
    "environment_figure",
    "evaluation_figure",
    "explanation_figure",
    "figure_bytes",
    "film_figure",
    "interactive",
    "light_figure",
    "lit_sphere",
    "modes_figure",
    "near_light_figure",
    "plot",
    "reflection_figure",
    "show_linear",
    "spectrum_figure",
    "stereo_figure",
    "subject_viewer",
    "viewer",
    "write_figure",
]
