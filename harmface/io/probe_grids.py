"""Probe grids in files."""

from pathlib import Path

from harmface.errors import FileError
from harmface.io.files import PARSE_ERRORS, excerpt
from harmface.io.npz import read_npz, write_npz
from harmface.light import ProbeGrid

KIND = "probe grid"
VERSION = 1


def write_probe_grid(path: Path | str, grid: ProbeGrid) -> None:
    """Write a probe grid as NPZ, with a digest of its bytes.

    Parameters
    ----------
    path
        The file to make or replace.
    grid
        What to write.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    arrays = {"origin": grid.origin, "spacing": grid.spacing, "coefficients": grid.coefficients}
    if grid.gradients is not None:
        arrays["gradients"] = grid.gradients
    write_npz(path, KIND, VERSION, arrays)


def read_probe_grid(path: Path | str) -> ProbeGrid:
    """Return the probe grid of a file that `write_probe_grid` made.

    Parameters
    ----------
    path
        A file of `write_probe_grid`.

    Returns
    -------
    ProbeGrid
        With coefficients as they were written.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, damaged, or holds no probe grid.
    """
    arrays, _ = read_npz(path, KIND, VERSION)
    try:
        return ProbeGrid(
            arrays["origin"], arrays["spacing"], arrays["coefficients"], arrays.get("gradients")
        )
    except KeyError as error:
        raise FileError(f"{path}: has no array {error}; make it again") from None
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: is no probe grid of use ({excerpt(error)})") from None
