"""Other tools' lighting coefficients, one tool a module: what theirs mean in ours, and back."""

from harmface.errors import ArgumentError
from harmface.light.interchange.convention import Convention
from harmface.light.interchange.deca import DECA
from harmface.light.interchange.deep3d import DEEP3D
from harmface.light.interchange.directx import DIRECTX, UNREAL
from harmface.light.interchange.dpr import DPR
from harmface.light.interchange.filament import FILAMENT, FILAMENT_RADIANCE, filament_window
from harmface.light.interchange.kaolin import KAOLIN
from harmface.light.interchange.libraries import (
    HEALPY,
    PYSHTOOLS,
    SCIPY,
    Healpy,
    Pyshtools,
    Scipy,
)
from harmface.light.interchange.mitsuba import MITSUBA
from harmface.light.interchange.pifu import PIFU
from harmface.light.interchange.sfsnet import SFSNET
from harmface.light.interchange.three_js import THREE_JS
from harmface.light.interchange.unity import UNITY

Tool = Convention | Scipy | Healpy | Pyshtools

TOOLS: dict[str, Tool] = {
    tool.name: tool
    for tool in (
        THREE_JS,
        FILAMENT,
        FILAMENT_RADIANCE,
        UNITY,
        UNREAL,
        DIRECTX,
        KAOLIN,
        MITSUBA,
        PYSHTOOLS,
        HEALPY,
        SCIPY,
        PIFU,
        DECA,
        DEEP3D,
        DPR,
        SFSNET,
    )
}
"""Every tool that is read and written, by its name."""


def tool_named(name: str) -> Tool:
    """Return a tool by its name.

    Parameters
    ----------
    name
        Name as `TOOLS` has it.

    Returns
    -------
    Tool
        What reads and writes its coefficients.

    Raises
    ------
    ArgumentError
        If there is none, with the names that there are.
    """
    if name not in TOOLS:
        raise ArgumentError(f"tool must be one of {', '.join(TOOLS)}, got {name!r}")
    return TOOLS[name]


__all__ = [
    "DECA",
    "DEEP3D",
    "DIRECTX",
    "DPR",
    "FILAMENT",
    "FILAMENT_RADIANCE",
    "HEALPY",
    "KAOLIN",
    "MITSUBA",
    "PIFU",
    "PYSHTOOLS",
    "SCIPY",
    "SFSNET",
    "THREE_JS",
    "TOOLS",
    "UNITY",
    "UNREAL",
    "Convention",
    "Tool",
    "filament_window",
    "tool_named",
]
