"""Which pixels show something, and how much each counts."""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError


def visible_pixels(
    normals: Float[np.ndarray, "*pixels 3"],
    albedo: Float[np.ndarray, "*pixels"] | None,
    weights: Float[np.ndarray, "*pixels"] | None,
) -> tuple[
    Float[np.ndarray, "*pixels 3"], Float[np.ndarray, "*pixels"], Float[np.ndarray, "*pixels"]
]:
    """Return checked normals, albedo and weights, the weights 0 where nothing is seen.

    Parameters
    ----------
    normals
        Unit normals; zero vectors are background.
    albedo
        Fraction of the light reflected, not negative; 1 if not given.
    weights
        Weight of each pixel, not negative; all alike if not given.

    Raises
    ------
    ArgumentError
        If nothing is visible, the shapes differ, a value is negative, NaN or infinite, the
        weights are all zero, or a normal is neither zero nor of unit length.
    """
    normals = checks.vectors("normals", normals)
    pixels = normals.shape[:-1]
    albedo = per_pixel("albedo", albedo, pixels)
    weights = pixel_weights(weights, pixels)
    background = ~normals.any(axis=-1)
    checks.unit_vectors("normals", normals[~background])
    weights = np.where(background | (albedo == 0), 0, weights)
    if not weights.any():
        raise ArgumentError(
            "normals must show something, but no pixel has a normal, albedo and weight above "
            "zero; turn the object to the camera or look at the mask"
        )
    return normals, albedo, weights


def pixel_weights(
    weights: Float[np.ndarray, "*pixels"] | None, pixels: tuple[int, ...]
) -> Float[np.ndarray, "*pixels"]:
    """Return checked weights of the pixels, all alike by default."""
    weights = per_pixel("weights", weights, pixels)
    if not weights.any():
        raise ArgumentError("weights must not be all zero; give visible pixels a positive weight")
    return weights


def per_pixel(
    name: str, values: Float[np.ndarray, "*pixels"] | None, pixels: tuple[int, ...]
) -> Float[np.ndarray, "*pixels"]:
    """Return checked values of the pixels, not negative, 1 by default."""
    if values is None:
        return np.ones(pixels)
    values = checks.non_negative(name, values)
    if values.shape != pixels:
        raise ArgumentError(
            f"{name} must have the shape of the pixels {pixels}, got {values.shape}"
        )
    return values
