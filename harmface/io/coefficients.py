"""Lighting coefficients as JSON."""

import json
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, read_bytes


def read_coefficients(path: Path | str) -> Float[np.ndarray, "channels K"]:
    """Read lighting coefficients: a JSON object whose "coefficients" are channels x K.

    Parameters
    ----------
    path
        A file of `write_coefficients`, or of `harmface envmap project --out`.

    Returns
    -------
    numpy.ndarray
        Radiance coefficients, shape (channels, K), float64.

    Raises
    ------
    FileError
        If the file is missing, no such JSON, longer than 16 MiB, or K is not a square.
    """
    try:
        found = json.loads(read_bytes(path, MAX_TEXT))
        coefficients = checks.finite("coefficients", np.array(found["coefficients"], float))
        if coefficients.ndim != 2:
            raise ArgumentError(f"coefficients must be channels x K, got {coefficients.shape}")
        max_degree_of(coefficients.shape[1])
    except FileError:
        raise
    except PARSE_ERRORS as error:
        reason = "it has no coefficients" if isinstance(error, KeyError) else excerpt(error)
        raise FileError(
            f"{path}: holds no lighting coefficients ({reason}); "
            "make it with `harmface envmap project --out`"
        ) from None
    return coefficients


def write_coefficients(path: Path | str, coefficients: Float[np.ndarray, "channels K"]) -> None:
    """Write lighting coefficients as `read_coefficients` reads them.

    Parameters
    ----------
    path
        The file to make or replace.
    coefficients
        Radiance coefficients, shape (channels, K).
    """
    with atomic_write(path) as file:
        file.write(json.dumps({"coefficients": coefficients.tolist()}, indent=1).encode() + b"\n")
