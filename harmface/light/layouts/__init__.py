"""Arrangements of all directions in an image: lat-long, angular, mirror ball, cube."""

from harmface.errors import ArgumentError
from harmface.light.layouts.angular import Angular, RH01Probe
from harmface.light.layouts.cube import FACES, Cube
from harmface.light.layouts.latlong import LatLong
from harmface.light.layouts.layout import Layout
from harmface.light.layouts.mirror_ball import MirrorBall

LAYOUTS: dict[str, Layout] = {
    layout.name: layout for layout in (LatLong(), Angular(), MirrorBall(), Cube())
}
"""Every layout by its name."""


def layout_named(layout: str | Layout) -> Layout:
    """Return a layout from its name; a layout is returned as it is.

    Parameters
    ----------
    layout
        "latlong", "angular", "mirror-ball" or "cube", or a layout.

    Returns
    -------
    Layout
        The layout.

    Raises
    ------
    ArgumentError
        If there is no layout of that name.
    """
    if isinstance(layout, Layout):
        return layout
    if layout not in LAYOUTS:
        raise ArgumentError(f"layout must be one of {', '.join(LAYOUTS)}, got {layout!r}")
    return LAYOUTS[layout]


__all__ = [
    "FACES",
    "LAYOUTS",
    "Angular",
    "Cube",
    "LatLong",
    "Layout",
    "MirrorBall",
    "RH01Probe",
    "layout_named",
]
