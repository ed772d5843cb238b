"""What the viewer's page is given of an object and its light, as JSON can hold it.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

from base64 import b64encode
from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.conventions import LUMINANCE, harmonic_count, max_degree_of
from harmface.errors import ArgumentError
from harmface.geometry import Mesh
from harmface.geometry.camera import FRAME_MARGIN
from harmface.light import EnvironmentMap, project, resample
from harmface.rendering import irradiance_matrix
from harmface.sphere import gauss_legendre
from harmface.viz.harmonics import SIGNED

MAX_VERTICES = 1_000_000
"""Most vertices of a page: its text then takes 70 MB, which browsers still open."""

MAP_ROWS = 256
"""Rows of the map in the page: 0.7 MB of text, and finer than a screen shows of a background."""

COARSE_CELLS = 46
"""Cells along the longest side of a mesh, of whose vertices one is drawn while a machine that is
slow turns it: some 20,000 triangles, which Chromium's software renderer turns 15 times a second."""

MANY_FACES = 40_000
"""Triangles above which a page holds the coarser ones too."""

LIGHT_DEGREE = 4
"""Degree of the light in the page, as far as transfer vectors go in it."""

_EXPONENT_BIAS, _MANTISSA_BITS, _LARGEST_EXPONENT = 15, 9, 31


def surface_arrays(mesh: Mesh) -> dict[str, Any]:
    """Return a mesh's arrays and its frame, that of `frame_orthographic`.

    Normals take 16 bits a component and albedo 16 bits a channel, so neither moves a colour of 8
    bits by more than a hundredth of its step.

    Parameters
    ----------
    mesh
        The object.

    Returns
    -------
    dict
        Arrays in base64, and numbers.

    Raises
    ------
    ArgumentError
        If it has more than `MAX_VERTICES` vertices.
    """
    count = len(mesh.vertices)
    if count > MAX_VERTICES:
        raise ArgumentError(
            f"mesh must have at most {MAX_VERTICES} vertices to be shown in a page, got {count}; "
            f"decimate it first (--decimate {MAX_VERTICES // 2})"
        )
    low, high = mesh.bounds
    centre = (low + high) / 2
    radius = float(np.linalg.norm(high - low) / 2)
    if not radius > 0:
        raise ArgumentError("mesh must have an extent across the view, got none")
    return {
        "positions": packed(mesh.vertices, "<f4"),
        "normals": packed(np.round(mesh.normals * 32767), "<i2"),
        "albedo": packed(np.round(mesh.albedo * 65535), "<u2"),
        "faces": packed(mesh.faces, "<u4"),
        "coarseFaces": packed(coarse_faces(mesh), "<u4") if len(mesh.faces) > MANY_FACES else None,
        "centre": centre.tolist(),
        "extent": (high - low)[:2].tolist(),
        "radius": radius,
        "margin": FRAME_MARGIN,
    }


def coarse_faces(mesh: Mesh) -> Integer[np.ndarray, "F 3"]:
    """Return fewer triangles over some of a mesh's vertices: one vertex a cell of a grid.

    As in Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes,
    1993, but with a vertex of the mesh in place of the mean of those in its cell.

    Parameters
    ----------
    mesh
        What to draw coarsely.

    Returns
    -------
    numpy.ndarray
        Indices of vertices.
    """
    low, high = mesh.bounds
    place = (mesh.vertices - low) / (high - low).max() * COARSE_CELLS
    cell = np.clip(place.astype(np.int64), 0, COARSE_CELLS) @ (COARSE_CELLS + 1) ** np.arange(3)
    _, first, which = np.unique(cell, return_index=True, return_inverse=True)
    corners = first[which][mesh.faces]
    a, b, c = corners.T
    return corners[(a != b) & (b != c) & (c != a)]


def optics() -> dict[str, Any]:
    """Return what the page computes light with, made here once: no constant is written twice.

    Returns
    -------
    dict
        `matrices`, M of each coefficient alone ([RH01]_ eq. 12, which is linear in them);
        `quadrature`, exact for products of harmonics up to the degree of the light; the colours
        of signed values at -1, -1/2, 0, 1/2 and 1; the weights of luminance.
    """
    rule = gauss_legendre(2 * LIGHT_DEGREE)
    return {
        "matrices": irradiance_matrix(np.eye(9)).reshape(9, 16).tolist(),
        "quadrature": {"directions": rule.directions.tolist(), "weights": rule.weights.tolist()},
        "signedColours": SIGNED.resampled(5)(np.arange(5))[:, :3].tolist(),
        "luminance": list(LUMINANCE),
    }


def light_entry(
    name: str, light: EnvironmentMap | Float[np.ndarray, "*channels K"]
) -> dict[str, Any]:
    """Return a light that can be chosen: three channels of coefficients up to degree 4.

    Parameters
    ----------
    name
        What it is called.
    light
        A map, or coefficients of one channel or three: those above degree 4 are left out.

    Raises
    ------
    ArgumentError
        If there are other numbers of channels or coefficients, or one is not finite.
    """
    mapped = isinstance(light, EnvironmentMap)
    found = project(light, LIGHT_DEGREE) if isinstance(light, EnvironmentMap) else light
    found = np.atleast_2d(checks.finite("light", found)).astype(np.float64)
    if found.ndim != 2 or len(found) not in (1, 3):
        raise ArgumentError(f"light must have one channel or three, got shape {found.shape}")
    max_degree_of(found.shape[1])
    kept = np.zeros((3, harmonic_count(LIGHT_DEGREE)))
    count = min(found.shape[1], kept.shape[1])
    kept[:, :count] = found[:, :count]
    return {"name": name, "coefficients": kept.tolist(), "mapped": mapped}


def map_texture(environment: EnvironmentMap) -> dict[str, Any]:
    """Return a map as a lat-long texture of at most `MAP_ROWS` rows, five bytes' worth a texel.

    Parameters
    ----------
    environment
        Of one channel or three.
    """
    rows = min(MAP_ROWS, environment.height)
    radiance = resample(environment, "latlong", rows).radiance
    radiance = np.broadcast_to(np.atleast_3d(radiance.T).T, (3, rows, 2 * rows))
    return {
        "width": 2 * rows,
        "height": rows,
        "texels": packed(shared_exponents(np.moveaxis(radiance, 0, -1)), "<u4"),
    }


def shared_exponents(rgb: Float[np.ndarray, "*pixels 3"]) -> Integer[np.ndarray, "*pixels"]:
    """Return linear RGB as OpenGL's RGB9_E5: nine bits a channel and five of a common exponent.

    As in section 3.8.4.3 of the OpenGL 3.0 specification; larger values than it can hold are cut
    off at 65408.

    Parameters
    ----------
    rgb
        Not negative.

    Returns
    -------
    numpy.ndarray
        uint32, red in the lowest bits.

    Examples
    --------
    >>> [hex(code) for code in shared_exponents(np.array([[1.0, 0.5, 0.0]]))]
    ['0x80010100']
    """
    largest = (
        (2**_MANTISSA_BITS - 1) / 2**_MANTISSA_BITS * 2.0 ** (_LARGEST_EXPONENT - _EXPONENT_BIAS)
    )
    rgb = np.clip(np.asarray(rgb, dtype=np.float64), 0, largest)
    brightest = rgb.max(axis=-1)
    # frexp gives m 2^e with m in [1/2, 1), and zero as 0 2^0.
    exponent = np.maximum(np.frexp(brightest)[1], -_EXPONENT_BIAS) + _EXPONENT_BIAS
    step = np.exp2(exponent - float(_EXPONENT_BIAS + _MANTISSA_BITS))
    # Rounding may carry the brightest over to the next exponent.
    exponent = exponent + (np.floor(brightest / step + 0.5) == 2**_MANTISSA_BITS)
    step = np.exp2(exponent - float(_EXPONENT_BIAS + _MANTISSA_BITS))
    codes = np.floor(rgb / step[..., None] + 0.5).astype(np.uint32)
    red, green, blue = np.moveaxis(codes, -1, 0)
    return red | green << 9 | blue << 18 | exponent.astype(np.uint32) << 27


def transfer_arrays(transfer: Float[np.ndarray, "*channels K V"], vertices: int) -> dict[str, Any]:
    """Return transfer vectors with 16 bits a number, scaled harmonic by harmonic.

    Parameters
    ----------
    transfer
        What a unit of each lighting coefficient adds to the irradiance of each vertex, of one
        channel or three; what is above degree 4 is left out.
    vertices
        `V`.

    Returns
    -------
    dict
        Numbers in base64, vertex by vertex, their scales, and how many channels there are.

    Raises
    ------
    ArgumentError
        If the shape is another or a value is not finite.
    """
    transfer = checks.finite("transfer", transfer)
    *channels, count, found = transfer.shape if transfer.ndim > 1 else (0, 0)
    if channels not in ([], [3]) or found != vertices:
        raise ArgumentError(
            f"transfer must have shape (K, {vertices}) or (3, K, {vertices}), a vector for each "
            f"vertex of the mesh, got {transfer.shape}"
        )
    max_degree_of(count)
    by_vertex = np.moveaxis(transfer, -1, 0)[..., : harmonic_count(LIGHT_DEGREE)]
    scales = np.abs(by_vertex).reshape(-1, by_vertex.shape[-1]).max(axis=0) / 32767.0
    scales[scales == 0] = 1
    return {
        "values": packed(np.round(by_vertex / scales), "<i2"),
        "scales": scales.tolist(),
        "channels": 3 if channels else 1,
    }


def colour_arrays(colours: Mapping[str, Float[np.ndarray, "V 3"]], vertices: int) -> dict[str, str]:
    """Return colours of every vertex, encoded for the screen, with 8 bits a channel.

    Parameters
    ----------
    colours
        By what they show; values in [0, 1].
    vertices
        `V`.

    Raises
    ------
    ArgumentError
        If the shape is another or a value is out of range.
    """
    found = {}
    for name, values in colours.items():
        values = checks.non_negative(f"colours {name!r}", values)
        if values.shape != (vertices, 3) or values.max(initial=0) > 1:
            raise ArgumentError(
                f"colours {name!r} must have shape ({vertices}, 3) and lie in [0, 1], got "
                f"{values.shape} up to {values.max(initial=0):.4g}"
            )
        found[name] = packed(np.round(values * 255), "<u1")
    return found


def packed(values: np.ndarray, dtype: str) -> str:
    """Return an array's numbers as base64 of their bytes."""
    return b64encode(np.ascontiguousarray(values, dtype=dtype).tobytes()).decode()
