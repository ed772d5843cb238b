"""The head without features: a loft of rings from the crown, over face and skull, to the neck.

Each ring is a short Fourier series in the angle round the head, made to pass through a front, a
side and a back point; those points run along cubic splines. Rings below the mouth tilt, so that
they follow the jaw line and then its underside.
"""

import numpy as np

from .fields import bump, ramp
from .parameters import FACE, MEAN, SKULL
from .splines import cardinal_weights

# One ring a row, all lengths in mm: disc radius v; front (y, z); side (x, y, z); back (y, z);
# breadth: how far the widest place lies to the front (+) or back (-); square: 0 an ellipse.
RINGS = np.array([
    # v     yf    zf    xs    ys    zs    yb    zb   breadth square
    (0.00, 113,   -8,    0,  113,   -8,  113,   -8,   0.00,  0.00),
    (0.08, 109,   24,   32,  109,  -10,  109,  -40,  -0.03,  0.00),
    (0.17,  90,   63,   58,   90,  -14,   92,  -72,  -0.03,  0.01),
    (0.26,  56,   88,   72,   62,  -17,   62,  -92,  -0.02,  0.03),
    (0.34,  22,   94,   76,   35,  -18,   35,  -98,   0.00,  0.04),
    (0.40,   2,   86,   74,   10,  -16,    8,  -97,   0.03,  0.05),
    (0.47, -20,   83,   69,  -12,  -14,  -18,  -91,   0.05,  0.06),
    (0.54, -45,   88,   65,  -30,  -13,  -42,  -80,   0.06,  0.05),
    (0.60, -66,   89,   62,  -46,  -13,  -57,  -73,   0.06,  0.04),
    (0.65, -84,   85,   59,  -57,  -14,  -66,  -69,   0.05,  0.03),
    (0.69, -98,   86,   56,  -66,  -15,  -73,  -67,   0.03,  0.01),
    (0.73, -110,  79,   54,  -75,  -16,  -80,  -66,   0.01,  0.00),
    (0.78, -115,  60,   51,  -86,  -17,  -87,  -66,  -0.02,  0.00),
    (0.83, -121,  40,   49,  -98,  -18,  -95,  -67,  -0.04,  0.00),
    (0.91, -135,  33,   50, -119,  -20, -114,  -70,  -0.04,  0.00),
    (1.00, -155,  34,   56, -155,  -26, -155,  -82,  -0.04,  0.00),
])  # fmt: skip


def rings(p: dict[str, float]) -> np.ndarray:
    """Make the ring table of one person."""
    r = RINGS.copy()
    v = r[:, 0]
    d = {q.name: p[q.name] - q.mean for q in (*SKULL, *FACE)}
    down = d["nose_height"]
    lip = down + d["upper_lip_length"]
    chin = lip + d["lower_face_height"]
    level = [-155, -111, -66, -45, 0, 113]
    moved = [-155 - chin, -111 - chin, -66 - lip, -45 - down, 0, p["vault_height"]]
    r[:, [1, 4, 6]] = np.interp(r[:, [1, 4, 6]], level, moved)
    r[:, 4] -= d["gonial_drop"] * np.interp(v, [0.54, 0.69, 0.78, 0.91], [0, 1, 1, 0])

    breadths = ("head_breadth", "bizygomatic_breadth", "bigonial_breadth", "neck_breadth")
    wider = np.array([p[name] / MEAN[name] for name in breadths])
    r[:, 3] *= np.interp(v, [0.34, 0.43, 0.54, 0.65, 0.78, 0.9], wider[[0, 1, 1, 2, 2, 3]])
    r[:, 8] += 0.012 * d["face_flatness"] * np.interp(v, [0.3, 0.42, 0.66, 0.76], [0, 1, 1, 0])
    long = 1 + d["head_length"] / MEAN["head_length"] * np.interp(v, [0.54, 0.8], [1, 0])
    r[:, [2, 5, 7]] *= long[:, None]
    thick = d["neck_depth"] * np.interp(v, [0.69, 0.88], [0, 1])
    r[:, 2] += 0.3 * thick
    r[:, 7] -= 0.7 * thick
    r[:, 2] -= d["forehead_slope"] * np.interp(v, [0.08, 0.17, 0.34], [0.4, 1, 0])
    r[:, 2] += d["forehead_bulge"] * np.interp(v, [0.17, 0.26, 0.34], [0, 1, 0])
    r[:, 2] += d["midface_protrusion"] * np.interp(v, [0.4, 0.54, 0.66, 0.73], [0, 1, 1, 0])
    r[:, 2] += d["chin_protrusion"] * np.interp(v, [0.6, 0.69, 0.73, 0.83], [0, 1, 1, 0])
    fat = d["submental_fullness"] * np.interp(v, [0.72, 0.78, 0.83, 0.95], [0, 1, 1.3, 0])
    r[:, 1] -= 0.7 * fat
    r[:, 2] += 0.7 * fat
    return r


def add_relief(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Add bones and flesh between the features at canonical points `c` (right half) to `out`."""
    x, y, z = c.T
    rows = np.flatnonzero(z > 0)
    x, y, z = x[rows], y[rows], z[rows]
    front = ramp((z - 10) / 30)

    def at(cx: float, cy: float, rx: float, ry: float) -> np.ndarray:
        return front * bump((x - cx) / rx, (y - cy) / ry)

    lift = p["brow_ridge"] * at(26, 19 + p["brow_height"], 36, 12)
    lift -= 8.5 * at(30, -1, 26, 20) + 3.5 * at(17, 2, 10, 16)
    lift += 3 * at(0, -102, p["chin_breadth"], 18)
    lift -= p["chin_cleft"] * at(0, -101, 4, 12)
    lift -= (p["mentolabial_depth"] - MEAN["mentolabial_depth"]) * at(0, -83, 18, 8)
    for level in (40.0, 53.0):
        lift -= p["forehead_lines"] * at(0, level, 46, 5.5)
    side = -p["temple_hollow"] * bump((x - 66) / 25, (y - 28) / 34, (z - 42) / 40)
    bone = p["cheekbone_prominence"] * bump((x - 54) / 36, (y + 22) / 32, (z - 40) / 52)
    flesh = p["cheek_fullness"] * bump((x - 46) / 46, (y + 56) / 52, (z - 44) / 76)
    sag = p["jowl"] * bump((x - 42) / 22, (y + 92) / 20, (z - 45) / 45)
    side += 0.9 * bone + 0.75 * flesh + 0.5 * sag
    lift += 0.8 * bone + 0.7 * flesh + 0.5 * sag
    lift += p["larynx"] * bump(x / 13, (y + 140) / 16)
    cord = bump((x - 34.0 - 0.35 * (y + 120)) / 13, (y + 140) / 40)
    lift += p["neck_cord"] * cord
    side += 0.6 * p["neck_cord"] * cord
    out[rows, 0] += side * ramp(x / 20)
    out[rows, 1] -= 0.5 * sag
    out[rows, 2] += lift


class Loft:
    """The rings' surface at fixed disc points, quick to evaluate for any ring table."""

    def __init__(self, points: np.ndarray) -> None:
        radius = np.hypot(points[:, 0], points[:, 1])
        angle = np.arctan2(points[:, 0], points[:, 1])
        self._even = cardinal_weights(RINGS[:, 0], radius, even=True)
        self._odd = cardinal_weights(RINGS[:, 0], radius, even=False)
        self._sin = [np.sin(k * angle) for k in range(4)]
        self._cos = [np.cos(k * angle) for k in range(4)]

    def __call__(self, rings: np.ndarray) -> np.ndarray:
        """Evaluate the surface `(N, 3)` of a ring table like `RINGS`."""
        yf, zf, xs, ys, zs, yb, zb, breadth, square = rings[:, 1:].T
        sin, cos = self._sin, self._cos
        even = self._even @ np.stack(
            [
                (yf + yb) / 4 + ys / 2,
                (yf + yb) / 4 - ys / 2,
                (zf + zb) / 4 + zs / 2,
                (zf + zb) / 4 - zs / 2,
            ],
            axis=1,
        )
        half_y, half_z = (yf - yb) / 2, (zf - zb) / 2
        odd = self._odd @ np.stack(
            [
                half_y,
                half_z * (1 + square),
                -half_z * square,
                xs * (1 + square),
                xs * breadth,
                xs * square,
            ],
            axis=1,
        )
        x = odd[:, 3] * sin[1] + odd[:, 4] * sin[2] + odd[:, 5] * sin[3]
        y = even[:, 0] + even[:, 1] * cos[2] + odd[:, 0] * cos[1]
        z = even[:, 2] + even[:, 3] * cos[2] + odd[:, 1] * cos[1] + odd[:, 2] * cos[3]
        return np.stack([x, y, z], axis=1)
