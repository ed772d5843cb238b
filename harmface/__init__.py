"""Spherical harmonics of diffuse objects under any distant light.

Subpackages load on first use, so that `import harmface` stays light.
"""

import importlib
import logging
from types import ModuleType

from harmface.errors import HarmfaceError

__version__ = "0.1.0"

_SUBPACKAGES = (
    "conventions",
    "enrollment",
    "geometry",
    "inverse",
    "io",
    "light",
    "moving",
    "pca",
    "recognition",
    "reflectance",
    "rendering",
    "reproduce",
    "scale",
    "sphere",
    "stereo",
    "viz",
)

# Silent until a program configures logging; `harmface --verbose` does.
logging.getLogger(__name__).addHandler(logging.NullHandler())

__all__ = ["HarmfaceError", "__version__", *_SUBPACKAGES]


def __getattr__(name: str) -> ModuleType:
    if name in _SUBPACKAGES:
        return importlib.import_module(f"harmface.{name}")
    raise AttributeError(f"module 'harmface' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
