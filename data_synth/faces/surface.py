"""The whole surface of a head: loft, features, hair, asymmetry and relief, with its normals."""

import numpy as np

from .albedo import paint
from .ears import add_ears
from .eyes import add_eyes
from .fields import bump, ramp
from .hair import add_hair
from .mouth import add_mouth
from .nose import add_nose
from .parameters import ASYMMETRY, MEAN
from .skull import RINGS, Loft, add_relief, rings
from .template import Template

_STEP = 1e-5  # of the disc's radius, for the tangents
_COLOUR = 1.5  # mm in shape that a step of 1 in albedo counts for when the template is made


class Canvas:
    """The right half of the head's surface at fixed points of the parameter disc."""

    def __init__(self, points: np.ndarray) -> None:
        self._loft = Loft(points)
        self.canonical = self._loft(RINGS)

    def __call__(self, p: dict[str, float]) -> np.ndarray:
        """Positions `(N, 3)` of one person's symmetric head."""
        c = self.canonical
        out = np.zeros_like(c)
        add_relief(c, out, p)
        add_nose(c, out, p)
        add_mouth(c, out, p)
        add_eyes(c, out, p)
        add_hair(c, out, p)
        add_ears(c, out, p)
        return self._loft(rings(p)) + out


def mean_surface(points: np.ndarray) -> np.ndarray:
    """Evaluate the mean head at `(N, 2)` points of the right half disc, for the template.

    Columns 3 to 5 are the albedo, scaled so that a step in colour counts like one in shape.
    """
    canvas = Canvas(points)
    colour = paint(canvas.canonical, MEAN, np.zeros(len(points)))
    return np.concatenate([canvas(MEAN), _COLOUR * colour], axis=1)


class Figure:
    """A template ready to take any person's shape and colour.

    The surface is evaluated at each vertex and at two neighbours a hair's breadth away in the
    disc; the tangents to them give the normal.
    """

    def __init__(self, template: Template) -> None:
        at = template.points
        self._paired = template.paired
        right, up = np.array([_STEP, 0]), np.array([0, _STEP])
        self._canvas = Canvas(np.concatenate([at, at + right, at + up]))
        self._canonical = self._with_twins(self._canvas.canonical)
        self._lean = asymmetry_fields(self._canonical)
        self.faces = template.faces
        self.uvs = 0.5 + 0.5 * np.concatenate([at, at[template.paired] * [-1.0, 1.0]])

    def __call__(self, p: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices, unit normals and albedo of one person, each `(V, 3)`."""
        lean = self._lean @ np.array([p[q.name] for q in ASYMMETRY])
        c = self._canonical
        noise = unevenness(c, int(p["relief_pattern"]))
        relief = (p["skin_relief"] * noise)[..., None] * (c / 100.0)
        point, right, up = self._with_twins(self._canvas(p)) + lean + relief
        normal = np.cross(up - point, right - point)
        normal[-len(self._paired) :] *= -1
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return point, normal, paint(c[0], p, noise[0])

    def _with_twins(self, half: np.ndarray) -> np.ndarray:
        """`(3H, 3)` values for the points and their neighbours as `(3, V, 3)`, both sides."""
        parts = half.reshape(3, -1, 3)
        return np.concatenate([parts, parts[:, self._paired] * [-1.0, 1.0, 1.0]], axis=1)


def asymmetry_fields(c: np.ndarray) -> np.ndarray:
    """Displacement `(..., 3, A)` at canonical points for one unit of each of `ASYMMETRY`."""
    x, y, z = np.moveaxis(c, -1, 0)
    front = ramp((z - 10) / 40)
    sided = np.tanh(x / 12)
    mouth = front * bump(x / 48, (y + 66) / 26)
    eyes = ramp((42 - np.abs(np.abs(x) - 31)) / 30) * bump(y / 28)
    ears = bump((y + 18) / 60, (z + 15) / 50) * ramp((np.abs(x) - 40) / 30)
    fields = {
        "nose_deviation": (0, front * bump(x / 26, (y + 32) / 34)),
        "mouth_shift": (0, mouth),
        "mouth_tilt": (1, mouth * x / 52),
        "eye_level_difference": (1, front * eyes * sided / 2),
        "jaw_shift": (0, ramp((-60 - y) / 50) * ramp((y + 150) / 45)),
        "brow_difference": (1, front * bump((y - 22) / 18) * sided / 2),
        "ear_difference": (1, ears * np.sign(x) / 2),
    }
    out = np.zeros((*c.shape, len(ASYMMETRY)))
    for k, parameter in enumerate(ASYMMETRY):
        axis, amount = fields[parameter.name]
        out[..., axis, k] = amount
    return out


def unevenness(c: np.ndarray, pattern: int) -> np.ndarray:
    """Evaluate a random field of unit variance with wavelengths from 7 to 40 mm."""
    rng = np.random.default_rng(pattern)
    count = 12
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    wavelength = np.geomspace(7, 40, count)
    phase = rng.uniform(0, 2 * np.pi, count)
    waves = np.cos(c @ (2 * np.pi * direction / wavelength[:, None]).T + phase)
    return waves @ np.sqrt(2 * wavelength / wavelength.sum())
