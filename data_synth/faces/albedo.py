"""The colour of skin, lips, hair and eyes, as linear RGB albedo.

Skin is bare dermis seen through two absorbers, melanin and blood, by Beer and Lambert's law.
The absorption per unit of volume falls from blue to red for melanin and has its maximum in the
green and blue for blood ([Jacques13]_); the coefficients, which stand for mean path lengths
through the two layers, are fitted so that the range of melanin spans the luminances and hues of
published skin colours, from about 0.6 to 0.07.

.. [Jacques13] S. L. Jacques, "Optical properties of biological tissues: a review", Physics in
   Medicine and Biology 58, 2013.
"""

import numpy as np

from .eyes import CENTRE, fissure, opening
from .fields import bump, ramp
from .hair import beard_mask, brow_mask, hair_mask, long_hair_mask
from .mouth import lip_curves
from .nose import nostril

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear RGB, Rec. 709

_BARE = np.array([0.82, 0.68, 0.58])
_MELANIN = np.array([3.7, 5.0, 6.6])
_BLOOD = np.array([0.9, 6.0, 5.0])


def skin(melanin: np.ndarray | float, blood: np.ndarray | float) -> np.ndarray:
    """Albedo `(..., 3)` of skin with the given volume fractions of melanosomes and blood."""
    melanin, blood = np.asarray(melanin)[..., None], np.asarray(blood)[..., None]
    return _BARE * np.exp(-melanin * _MELANIN - blood * _BLOOD)


def melanin_of_tone(tone: float) -> float:
    """Melanin of a skin tone from -1 (lightest) to 1 (darkest).

    Equal steps of tone are equal steps in the square root of the luminance, which is roughly how
    light a skin looks; it goes from 0.56 to 0.075.
    """
    root = np.sqrt(0.56) + (tone + 1) / 2 * (np.sqrt(0.075) - np.sqrt(0.56))
    return float(np.log(0.57 / root**2) / 4.7)


def paint(c: np.ndarray, p: dict[str, float], spots: np.ndarray) -> np.ndarray:
    """Albedo `(V, 3)` at canonical points `c`; `spots` `(V,)` is noise of unit variance."""
    x, y, z = np.abs(c[:, 0]), c[:, 1], c[:, 2]
    front = ramp((z - 20) / 20)
    upper, _, lower = lip_curves(x, p)
    lips = front * ramp((upper - y) / 1.6 + 0.5) * ramp((y - lower) / 1.6 + 0.5)
    lips *= ramp((p["mouth_width"] / 2 - x) / 3)

    flush = bump(x / 24, (y + 34) / 16) + bump((x - 42) / 26, (y + 34) / 24)
    ear = bump((y + 17) / 36, (z + 20) / 22) * ramp((x - 50) / 10)
    blood = p["haemoglobin"] * (1 + 0.35 * front * flush + 0.3 * ear + p["blotches"] * spots)
    blood = blood + 0.07 * p["lip_blood"] * lips
    tan = p["melanin"] * (1 + 0.25 * lips) + 0.01 * lips
    under_eye = front * bump((x - 30) / 20, (y + 9) / 8)
    tan = tan + 0.25 * p["melanin"] * under_eye
    tan = tan + 0.10 * p["freckles"] * front * ramp(spots - 1.0) * bump(x / 70, (y + 20) / 60)
    colour = skin(tan, blood)

    strand = np.array([0.36, 0.26, 0.15]) * np.exp(-p["hair_melanin"] * np.array([2.5, 2.8, 2.9]))
    strand = strand + p["grey"] * (0.42 - strand)
    scalp = np.maximum(hair_mask(c, p, 10.0), ramp(4 * long_hair_mask(c, p)))
    colour = _cover(colour, strand * (1 + 0.12 * spots[:, None]), p["hair_cover"] * scalp)
    colour = _cover(colour, strand, p["brow_density"] * front * brow_mask(x, y, p))
    colour = _cover(colour, strand, p["stubble"] * beard_mask(c) * (1 - lips))
    colour = colour * (1 - 0.85 * front * nostril(x, y))[:, None]
    return np.clip(_add_eyes(colour, x - CENTRE[0], y - CENTRE[1], front, p), 0.0, 1.0)


def _add_eyes(
    colour: np.ndarray, x: np.ndarray, y: np.ndarray, front: np.ndarray, p: dict[str, float]
) -> np.ndarray:
    upper, lower = fissure(x, p)
    wide = ramp((upper - lower) / 3)
    colour = _cover(colour, np.full(3, 0.03), 0.7 * front * wide * bump((y - upper - 0.2) / 1.5))
    colour = _cover(colour, np.full(3, 0.05), 0.3 * front * wide * bump((y - lower + 0.3) / 1.2))
    reach = np.hypot(x, y - 0.4)
    iris = np.array([0.15, 0.20, 0.23]) * np.exp(-p["iris_melanin"] * np.array([1.3, 2.3, 3.3]))
    # The lids shade the white of the eye above and in the corners.
    white = np.array([0.50, 0.46, 0.42]) * (1 - 0.45 * ramp((reach - 5) / 10))[:, None]
    eye = _cover(white, iris * 0.45, ramp((6.4 - reach) / 0.7))
    eye = _cover(eye, iris, ramp((5.7 - reach) / 1.2))
    eye = _cover(eye, np.full(3, 0.012), ramp((2.5 - reach) / 0.7))
    eye = eye * (1 - 0.5 * ramp((y - upper + 2.6) / 2.2))[:, None]
    return _cover(colour, eye, front * opening(x, y, p))


def _cover(colour: np.ndarray, other: np.ndarray, amount: np.ndarray) -> np.ndarray:
    return colour + amount[:, None] * (other - colour)
