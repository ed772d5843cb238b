"""A camera: from linear radiance to a photograph, one small function a stage.

Signal is counted in electrons: `exposure` fills the well in proportion to radiance, photons
arrive as a Poisson process, the well overflows, the amplifier adds Gaussian noise, and the
converter rounds the encoded voltage to an integer code.
"""

from typing import Literal

import numpy as np

Encoding = Literal["linear", "srgb"] | float
"""How values are laid out on the codes: linearly, by the sRGB curve, or by a gamma."""


def photograph(
    image: np.ndarray,
    *,
    rng: np.random.Generator | int,
    exposure: float = 1.0,
    full_well: float = 20_000.0,
    read_noise: float = 5.0,
    bits: int = 16,
    encoding: Encoding = "linear",
    codes: bool = False,
) -> np.ndarray:
    """Photograph linear radiance, through all stages in turn.

    Parameters
    ----------
    image : (...) float, non-negative
        Linear radiance, of any shape; channels and images are treated alike.
    rng : numpy Generator or seed
    exposure : float
        Fraction of the full well that unit radiance fills; above 1 the highlights saturate.
    full_well : float
        Electrons at saturation, the scale of the shot noise.
    read_noise : float
        Standard deviation of the amplifier's noise, in electrons.
    bits : int
        Of the converter, 1 to 16.
    encoding : "linear", "srgb" or a gamma
        Curve applied before rounding.
    codes : bool
        Return the integer codes, not their fraction of the largest.

    Returns
    -------
    (...) float64 in [0, 1], or uint8 / uint16 codes
        Encoded as asked; linear values by default.

    Raises
    ------
    ValueError
        For a negative or non-finite image, or a setting out of range.

    Examples
    --------
    >>> photograph(np.array([0.0, 0.5, 2.0]), rng=1, read_noise=0.0, bits=8, codes=True)
    array([  0, 128, 255], dtype=uint8)
    """
    image = np.asarray(image)
    if not (np.isfinite(image).all() and (image >= 0).all()):
        raise ValueError(
            "image must be finite and non-negative, got NaN, Inf or a value below 0: "
            "photograph linear radiance"
        )
    _require_positive("exposure", exposure)
    _require_positive("full_well", full_well)
    rng = np.random.default_rng(rng)
    electrons = expose(image, exposure, full_well)
    electrons = saturate(shot_noise(electrons, rng), full_well)
    electrons = saturate(add_read_noise(electrons, read_noise, rng), full_well)
    digital = quantise(encode(electrons / full_well, encoding), bits)
    return digital if codes else dequantise(digital, bits)


def expose(image: np.ndarray, exposure: float, full_well: float) -> np.ndarray:
    """Convert radiance to expected electrons: radiance x exposure x full well, unlimited."""
    return np.asarray(image, dtype=np.float64) * (exposure * full_well)


def shot_noise(electrons: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Draw the electrons that arrive: Poisson, its variance equal to its mean."""
    return rng.poisson(electrons).astype(np.float64)


def add_read_noise(electrons: np.ndarray, sigma: float, rng: np.random.Generator) -> np.ndarray:
    """Add Gaussian noise of standard deviation `sigma` electrons."""
    if not (np.isfinite(sigma) and sigma >= 0):
        raise ValueError(
            f"read_noise must be finite and at least 0 electrons, got {sigma}: use 0 for none"
        )
    return electrons + sigma * rng.standard_normal(electrons.shape)


def saturate(electrons: np.ndarray, full_well: float) -> np.ndarray:
    """Hold electrons between an empty and a full well."""
    held: np.ndarray = np.clip(electrons, 0.0, full_well)
    return held


def encode(values: np.ndarray, encoding: Encoding) -> np.ndarray:
    """Put linear values in [0, 1] on a curve: linear, sRGB (IEC 61966-2-1) or v^(1/gamma)."""
    if encoding == "linear":
        return values
    if encoding == "srgb":
        return np.where(
            values <= 0.0031308,
            12.92 * values,
            1.055 * np.maximum(values, 0.0) ** (1 / 2.4) - 0.055,
        )
    if isinstance(encoding, str) or not (np.isfinite(encoding) and encoding > 0):
        raise ValueError(
            f"encoding must be 'linear', 'srgb' or a gamma above 0, got {encoding!r}: "
            "for instance 2.2"
        )
    return values ** (1.0 / encoding)


def quantise(values: np.ndarray, bits: int) -> np.ndarray:
    """Round values in [0, 1] to the nearest of `2^bits` codes: uint8 up to 8 bits, else uint16."""
    _require_bits(bits)
    codes: np.ndarray = np.rint(values * (2**bits - 1))
    return codes.astype(np.uint8 if bits <= 8 else np.uint16)


def dequantise(codes: np.ndarray, bits: int) -> np.ndarray:
    """Return integer codes as fractions of the largest, float64 in [0, 1]."""
    _require_bits(bits)
    values: np.ndarray = codes / (2**bits - 1)
    return values


def _require_bits(bits: int) -> None:
    if not 1 <= bits <= 16:
        raise ValueError(f"bits must be from 1 to 16, got {bits}: 8 and 16 are what PNG stores")


def _require_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be finite and above 0, got {value}: 1 is a usual start")
