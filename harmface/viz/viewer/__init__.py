"""A page with WebGL that shows an object under light that turns; its parts lie here as files."""

from harmface.viz.viewer.page import Viewer, viewer
from harmface.viz.viewer.sources import confidence_colours, subject_viewer

__all__ = ["Viewer", "confidence_colours", "subject_viewer", "viewer"]
