"""Figures, by matplotlib and pyvista; the only place where either is imported."""

from harmface.viz.figures import figure_bytes, write_figure
from harmface.viz.harmonics import basis_figure

__all__ = ["basis_figure", "figure_bytes", "write_figure"]
