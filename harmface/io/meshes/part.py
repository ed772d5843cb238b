"""What the readers of mesh formats return: one surface with one material."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Integer

from harmface.errors import FileError
from harmface.geometry import TextureImage


@dataclass
class Part:
    """A surface as its file has it, unchecked.

    Parameters
    ----------
    vertices, faces
        Positions, and indices of triangles.
    normals
        A vector for each vertex, of any length, NaN where the file has none.
    colors
        RGB of each vertex in [0, 1], encoded as in the file.
    uv
        Texture coordinates of each vertex, v upwards.
    image
        The picture of the base colour.
    factor
        RGB of the material in [0, 1], encoded as in the file.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Integer[np.ndarray, "F 3"]
    normals: Float[np.ndarray, "V 3"] | None = None
    colors: Float[np.ndarray, "V 3"] | None = None
    uv: Float[np.ndarray, "V 2"] | None = None
    image: TextureImage | None = None
    factor: Float[np.ndarray, "3"] = field(default_factory=lambda: np.ones(3))


def unit_colors(
    values: Float[np.ndarray, "V 3"], name: str
) -> tuple[Float[np.ndarray, "V 3"], bool]:
    """Return colours in [0, 1] of real numbers in [0, 1] or [0, 255], and whether it was the last.

    Nothing in OBJ and PLY files says which; a value above 1, rounding aside, does.
    """
    top = values.max(initial=0)
    if not (np.isfinite(values).all() and values.min(initial=0) >= 0 and top <= 255):
        raise FileError(f"{name} must lie in [0, 1] or [0, 255], got {values.min()} to {top}")
    if top > 1.001:
        return values / 255, True
    return np.minimum(values, 1), False
