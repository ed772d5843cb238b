"""Images from geometry and light: the harmonic model, and the oracle without harmonics."""

from harmface.rendering.harmonic_images import harmonic_images, outgoing_radiance, relight
from harmface.rendering.reference import (
    Phong,
    box_average,
    clamped_cosines,
    irradiance,
    render,
)

__all__ = [
    "Phong",
    "box_average",
    "clamped_cosines",
    "harmonic_images",
    "irradiance",
    "outgoing_radiance",
    "relight",
    "render",
]
