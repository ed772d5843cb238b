"""Files of other tools' lighting coefficients: NPY, JSON or text, as each tool writes them."""

import io
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.coefficients import read_coefficients
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, read_bytes
from harmface.io.glsl import glsl_uniforms
from harmface.io.tables import npy_header
from harmface.light.interchange import FILAMENT, THREE_JS, TOOLS, tool_named

OWN, GLSL = "harmface", "glsl"
"""Formats that are no tool's array: our JSON, and a shader's text, which is only written."""

_NUMBER = re.compile(
    r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf)\w*", re.IGNORECASE
)
_COMMENT = re.compile(r"(//|#).*")
_FILAMENT_ROWS = ("L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22")


def read_tool_coefficients(path: Path | str, tool: str) -> Float[np.ndarray, "channels K"]:
    """Read a tool's file as lighting coefficients.

    Parameters
    ----------
    path
        NPY, JSON or text; `.npz` and pickled files are refused.
    tool
        "harmface" or a name of `light.interchange.TOOLS`, or what one of them alone begins with.

    Returns
    -------
    numpy.ndarray
        Coefficients of radiance in our own frame, shape (channels, K).

    Raises
    ------
    ArgumentError
        If there is no such tool.
    FileError
        If the file does not hold what the tool writes.
    """
    tool = _name(tool)
    if tool == OWN:
        return read_coefficients(path)
    if tool == GLSL:
        raise ArgumentError("glsl is only written; give the file that it was made from")
    convention = tool_named(tool)
    try:
        return convention.decode(_values(read_bytes(path, MAX_TEXT)))
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: {excerpt(error)}") from None


def tool_text(light: Float[np.ndarray, "channels K"], tool: str) -> str:
    """Return lighting coefficients as text in a tool's own form.

    Parameters
    ----------
    light
        Coefficients.
    tool
        "harmface", "glsl" or a name of `light.interchange.TOOLS`, or what one of them alone begins
        with.

    Returns
    -------
    str
        Text that ends with a newline.

    Raises
    ------
    ArgumentError
        If there is no such tool, or it cannot hold this light.
    """
    tool = _name(tool)
    if tool == OWN:
        return json.dumps({"coefficients": light.tolist()}, indent=1) + "\n"
    if tool == GLSL:
        return glsl_uniforms(light)
    values = tool_named(tool).encode(light)
    if tool == THREE_JS.name:
        probe = {"type": "LightProbe", "intensity": 1, "sh": values.ravel().tolist()}
        return json.dumps({"object": probe}, indent=1) + "\n"
    if tool == FILAMENT.name:
        rows = [", ".join(f"{value:18.15f}" for value in row) for row in values]
        return "".join(
            f"({row}); // {name}, irradiance, pre-scaled base\n"
            for row, name in zip(rows, _FILAMENT_ROWS, strict=True)
        )
    if np.iscomplexobj(values):
        return json.dumps([[[z.real, z.imag] for z in row] for row in values.tolist()]) + "\n"
    return json.dumps(values.tolist()) + "\n"


def write_tool_coefficients(
    path: Path | str, light: Float[np.ndarray, "channels K"], tool: str
) -> None:
    """Write lighting coefficients as a tool's file: an array if the name ends in `.npy`.

    Parameters
    ----------
    path
        The file to write.
    light
        Coefficients.
    tool
        "harmface", "glsl" or a name of `light.interchange.TOOLS`, or what one of them alone begins
        with.

    Raises
    ------
    ArgumentError
        If there is no such tool, or it cannot hold this light.
    """
    tool = _name(tool)
    if Path(path).suffix.lower() == ".npy" and tool not in (OWN, GLSL):
        buffer = io.BytesIO()
        np.save(buffer, tool_named(tool).encode(light), allow_pickle=False)
        data = buffer.getvalue()
    else:
        data = tool_text(light, tool).encode()
    with atomic_write(path) as file:
        file.write(data)


def _name(tool: str) -> str:
    """Return the whole name of a tool, of which a beginning will do if no other begins so.

    "json" is our own.
    """
    tool = OWN if tool == "json" else tool
    known = (OWN, *TOOLS, GLSL)
    found = [name for name in known if name == tool] or [
        name for name in known if tool and name.startswith(tool)
    ]
    if len(found) != 1:
        raise ArgumentError(f"tool must be one of {', '.join(known)}, got {tool!r}")
    return found[0]


def _values(data: bytes) -> np.ndarray:
    """Return the numbers of a file, in the shape it gives them."""
    if data.startswith(np.lib.format.MAGIC_PREFIX):
        file = io.BytesIO(data)
        shape, fortran, dtype = npy_header(file)
        size = math.prod(shape) * dtype.itemsize
        if dtype.kind not in "fiubc" or size != len(data) - file.tell():
            raise ValueError("it does not hold the array of numbers that its header promises")
        array = np.frombuffer(data, dtype, offset=file.tell())
        return array.reshape(shape, order="F" if fortran else "C")
    text = data.decode("utf-8-sig")
    if text.lstrip()[:1] in ("{", "["):
        return _from_json(json.loads(text))
    words = _NUMBER.findall(_COMMENT.sub("", text))
    if not words:
        raise ValueError("it holds no numbers")
    return np.array([float(word) for word in words])


def _from_json(found: Any) -> np.ndarray:
    """Return the numbers of a JSON list, or of a three.js object."""
    if isinstance(found, dict):
        probe = found.get("object", found)
        if "sh" not in probe:
            raise ValueError('it has no "sh"')
        # Infinity times zero would be said to be no number before it is refused.
        sh, intensity = np.array(probe["sh"], float), np.array(probe.get("intensity", 1), float)
        return checks.finite("sh", sh) * checks.finite("intensity", intensity)
    array = np.array(found, float)
    if array.ndim == 3 and array.shape[-1] == 2:
        return array[..., 0] + 1j * array[..., 1]
    return array
