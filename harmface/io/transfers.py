"""Precomputed transfer in files, together with what tells the mesh that it is of."""

import hashlib
from pathlib import Path

import numpy as np

from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError, FileError
from harmface.geometry import Mesh
from harmface.io.npz import read_npz, write_npz
from harmface.rendering import Transfer

KIND, VERSION = "transfer", 1


def write_transfer(path: Path | str, transfer: Transfer, mesh: Mesh) -> None:
    """Write the transfer of a mesh's vertices as NPZ, in single precision.

    Parameters
    ----------
    path
        The file to make or replace.
    transfer
        At the vertices.
    mesh
        The mesh.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    arrays = {
        "transfer": transfer.coefficients.astype(np.float32),
        "standard_errors": transfer.standard_errors.astype(np.float32),
    }
    facts = {"mesh": mesh_digest(mesh), "back_share": transfer.back_share}
    write_npz(path, KIND, VERSION, arrays, facts)


def read_transfer(path: Path | str, mesh: Mesh) -> Transfer:
    """Return the transfer of a mesh from a file that `write_transfer` made.

    Parameters
    ----------
    path
        The file.
    mesh
        The mesh that it must be of.

    Returns
    -------
    Transfer
        For the mesh's vertices, in their order.

    Raises
    ------
    FileError
        If the file is missing, damaged, of another kind, or of another mesh.
    """
    arrays, facts = read_npz(path, KIND, VERSION)
    if facts.get("mesh") != mesh_digest(mesh):
        raise FileError(
            f"{path}: holds the transfer of another mesh, or of this one turned otherwise; make it "
            "again with `harmface transfer` and the same --rotate and --flip-normals"
        )
    try:
        coefficients, errors = arrays["transfer"], arrays["standard_errors"]
        if coefficients.ndim not in (2, 3) or coefficients.shape[-1] != len(mesh.vertices):
            raise ArgumentError(f"its array has shape {coefficients.shape}")
        max_degree_of(coefficients.shape[-2])
        return Transfer(coefficients, errors, float(facts["back_share"]))
    except (KeyError, TypeError, ValueError) as error:
        raise FileError(f"{path}: holds no transfer of use ({error}); make it again") from None


def mesh_digest(mesh: Mesh) -> str:
    """Return a digest of the places and faces of a mesh, and of its normals."""
    found = hashlib.sha256()
    for array in (mesh.vertices, mesh.faces, mesh.normals):
        found.update(f"{array.shape}".encode())
        found.update(np.ascontiguousarray(array, "<f8").tobytes())
    return found.hexdigest()
