"""Guards at the door: each refuses nonsense by naming the argument, what was needed, what came."""

import operator

import numpy as np
from numpy.typing import ArrayLike

from harmface.errors import ArgumentError

UNIT_TOLERANCE = 1e-4
"""Largest departure of a squared norm from 1 that still counts as a unit vector: it admits
normals stored in half precision nowhere near their limit, and refuses unnormalised ones."""


def integer(name: str, value: int, least: int) -> int:
    """Return `value` as an int if it is a whole number of at least `least`."""
    try:
        number = operator.index(value)
    except TypeError:
        raise ArgumentError(f"{name} must be an integer, got {value!r}") from None
    if number < least:
        raise ArgumentError(f"{name} must be {least} or more, got {number}")
    return number


def degree(name: str, value: int) -> int:
    """Return `value` as an int if it is a harmonic degree: a whole number of at least 0."""
    return integer(name, value, 0)


def positive_integer(name: str, value: int) -> int:
    """Return `value` as an int if it is a whole number of at least 1."""
    return integer(name, value, 1)


def array_of(name: str, values: ArrayLike) -> np.ndarray:
    """Return what numpy makes of an array of another kind, or of a list.

    Raises
    ------
    ArgumentError
        If it is no array, such as a list of lists of unlike length, or has masked values.
    """
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise ArgumentError(
            f"{name} must have no masked values, got {np.ma.getmaskarray(values).sum()}; fill "
            "them, or leave them out"
        )
    try:
        return np.asarray(values)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name} must be an array of numbers ({str(error)[:200]})") from None


def floating(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as float32 or float64: those are kept, integers and booleans become float64.

    Raises
    ------
    ArgumentError
        If the values are not real numbers.
    """
    array = array_of(name, array)
    if array.dtype in (np.float32, np.float64):
        return array
    if array.dtype.kind not in "fiub":
        raise ArgumentError(f"{name} must hold real numbers, got dtype {array.dtype}")
    return array.astype(np.float32 if array.dtype == np.float16 else np.float64)


def finite(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as floating point if it holds neither NaN nor infinity."""
    array = floating(name, array)
    if not np.isfinite(array).all():
        bad = int(array.size - np.isfinite(array).sum())
        raise ArgumentError(
            f"{name} must be finite, got NaN or Inf in {bad} of {array.size} values"
        )
    return array


def intensities(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` if it is floating point and finite: of a code, only its scale tells the light.

    Raises
    ------
    ArgumentError
        If the values are integers or no numbers, NaN or infinite.
    """
    values = array_of(name, array)
    if values.dtype.kind in "iub":
        raise ArgumentError(
            f"{name} must be floating point, got dtype {values.dtype}; divide codes by the "
            "largest there is, such as 255"
        )
    return finite(name, values)


def indices(name: str, array: ArrayLike, count: int) -> np.ndarray:
    """Return `array` if it holds whole numbers from 0 to `count - 1`."""
    values = array_of(name, array)
    if values.dtype.kind not in "iu":
        raise ArgumentError(f"{name} must hold whole numbers, got dtype {values.dtype}")
    if values.size and not (values.min() >= 0 and values.max() < count):
        raise ArgumentError(
            f"{name} must index {count} vertices, got indices from {values.min()} to {values.max()}"
        )
    return values


def mask(name: str, array: ArrayLike, shape: tuple[int, ...]) -> np.ndarray:
    """Return `array` if it is true or false for every pixel of a picture."""
    values = array_of(name, array)
    if values.dtype != np.bool_:
        raise ArgumentError(
            f"{name} must be true or false, got dtype {values.dtype}; compare it, such as image > 0"
        )
    if values.shape != shape:
        raise ArgumentError(f"{name} must have the size {shape}, got {values.shape}")
    return values


def non_negative(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as floating point if it is finite and nowhere below zero."""
    array = finite(name, array)
    if array.size and array.min() < 0:
        raise ArgumentError(f"{name} must not be negative, got a least value of {array.min():.4g}")
    return array


def picture(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as floating point if it is a finite grey or RGB picture with pixels."""
    array = finite(name, array)
    if array.ndim not in (2, 3) or array.shape[2:] not in ((), (3,)) or array.size == 0:
        raise ArgumentError(
            f"{name} must have shape (H, W) or (H, W, 3), with pixels, got {array.shape}"
        )
    return array


def vectors(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as floating point if its last axis has three components."""
    array = floating(name, array)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ArgumentError(f"{name} must have shape (..., 3), got {array.shape}")
    return array


def unit_vectors(name: str, array: ArrayLike) -> np.ndarray:
    """Return `array` as floating point if it holds unit vectors, shape (..., 3)."""
    array = vectors(name, array)
    squared = np.einsum("...i,...i->...", array, array)
    # Written so that NaN fails too.
    wrong = ~(np.abs(squared - 1) <= UNIT_TOLERANCE)
    if wrong.any():
        raise not_unit(name, int(wrong.sum()), squared.size)
    return array


def not_unit(name: str, wrong: int, total: int) -> ArgumentError:
    """Make the error for vectors that are not of unit length."""
    return ArgumentError(
        f"{name} must be unit vectors, got {wrong} of {total} with another length or NaN; "
        "divide them by their norm"
    )


def orthogonal(name: str, matrix: ArrayLike) -> np.ndarray:
    """Return `matrix` as float64 if it is a 3 x 3 rotation or reflection."""
    matrix = np.asarray(finite(name, matrix), dtype=np.float64)
    if matrix.shape != (3, 3):
        raise ArgumentError(f"{name} must have shape (3, 3), got {matrix.shape}")
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > UNIT_TOLERANCE:
        raise ArgumentError(f"{name} must be orthogonal: rows of unit length at right angles")
    return matrix


def rotation(name: str, matrix: ArrayLike) -> np.ndarray:
    """Return `matrix` as float64 if it is a 3 x 3 rotation."""
    matrix = orthogonal(name, matrix)
    if np.linalg.det(matrix) < 0:
        raise ArgumentError(f"{name} must be a rotation, got a reflection (determinant -1)")
    return matrix


def generator(rng: np.random.Generator | int) -> np.random.Generator:
    """Return a random generator from a generator (kept) or a seed."""
    if isinstance(rng, np.random.Generator):
        return rng
    if not isinstance(rng, int | np.integer) or rng < 0:
        raise ArgumentError(f"rng must be a Generator or a seed of 0 or more, got {rng!r}")
    return np.random.default_rng(rng)
