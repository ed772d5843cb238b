"""Whether a mesh shows a face to the viewer, the right side out and the right way up."""

from collections.abc import Iterator
from itertools import permutations, product

import numpy as np
from jaxtyping import Float, UInt8

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.camera import frame_box, frame_orthographic
from harmface.geometry.gbuffer import gbuffer
from harmface.geometry.mesh import Mesh
from harmface.geometry.rays import used_vertices

_SIZE = 80
"""Rows and columns of the pictures that faces are looked for in; the least face looked for,
24 pixels, is that of a bust."""

_WINDOWS = 12
"""Overlapping windows that must agree on a face. A scan and procedural heads have 22 to 40 from
the front, and 0 to 6 from any other side, as have vases and rings."""

_LIGHT = np.array([0.0, 0.3, 1.0]) / np.hypot(0.3, 1.0)
"""Where the light comes from in pictures that faces are looked for in: from slightly above."""


def outward_share(mesh: Mesh) -> float:
    """Return how much of what is seen from the front has normals that point to the viewer.

    It is 1 up to a rim of pixels for a sound mesh, and near 0 for one that is inside out, or for
    an open surface, such as a face mask, seen from behind.

    Parameters
    ----------
    mesh
        Any surface.

    Returns
    -------
    float
        Share in [0, 1] of the rays that meet the mesh.

    Raises
    ------
    ArgumentError
        If nothing of it is seen from the front, such as of a plane seen edge-on.
    """
    facing = _normals_seen(mesh, np.eye(3))[..., 2]
    if not facing.any():
        raise ArgumentError("mesh must be seen from the front, but no ray meets it")
    return float((facing > 0).sum() / (facing != 0).sum())


def face_rotation(mesh: Mesh) -> str | None:
    """Return the rotation, as `axis_rotations` takes it, that turns a face to the viewer.

    Pictures of the shape in frontal light, albedo left out, are shown to a detector of upright
    frontal faces (local binary patterns, by scikit-image): as it is, and turned by quarters.

    Parameters
    ----------
    mesh
        Any surface, inside out or not.

    Returns
    -------
    str or None
        Empty if a face is seen already; None if none is seen from any side.
    """
    for text, rotation in _orientations():
        normals = _normals_seen(mesh, rotation)
        side = 1 if normals[..., 2].sum() > 0 else -1
        shaded = np.maximum(side * normals @ _LIGHT, 0)
        if _is_face(shaded.reshape(_SIZE, _SIZE, 4).mean(axis=2)):
            return text
    return None


def paints_a_face(mesh: Mesh) -> bool:
    """Return whether the mesh's albedo alone, without shading, shows a face from the front.

    Parameters
    ----------
    mesh
        A surface with a texture or vertex colours.

    Returns
    -------
    bool
        Whether a detector of faces finds one.
    """
    view = gbuffer(mesh, frame_orthographic(mesh, _SIZE), supersampling=2)
    return _is_face(view.albedo.mean(axis=-1))


def axis_rotations(text: str) -> Float[np.ndarray, "3 3"]:
    """Return the rotation matrix of turns about axes, one after the other.

    Parameters
    ----------
    text
        Turns such as "y:180" or "x:-90,y:180": degrees about a fixed axis, counter-clockwise
        seen from its end; the first is done first. "y:90" turns what faces +z to +x. Empty for
        none.

    Returns
    -------
    numpy.ndarray
        Rotation matrix, shape (3, 3), float64.

    Raises
    ------
    ArgumentError
        If the text reads otherwise.

    Examples
    --------
    >>> np.round(axis_rotations("x:-90") @ [0, 1, 0])
    array([ 0.,  0., -1.])
    """
    total = np.eye(3)
    if not text:
        return total
    for turn in text.split(","):
        axis, _, angle = turn.strip().partition(":")
        try:
            radians = np.radians(float(angle))
        except ValueError:
            radians = np.nan
        if axis not in ("x", "y", "z") or not np.isfinite(radians):
            raise ArgumentError(
                f"a rotation must be AXIS:DEGREES, such as y:180 or x:-90,y:180, got {text[:80]!r}"
            )
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = np.cos(radians)
        matrix[j, i] = np.sin(radians)
        matrix[i, j] = -matrix[j, i]
        total = matrix @ total
    return checks.rotation("rotation", total)


def _orientations() -> Iterator[tuple[str, Float[np.ndarray, "3 3"]]]:
    """Yield the 24 orientations by quarter turns, those of the fewest turns first."""
    seen: set[bytes] = set()
    for count in (0, 1, 2):
        for axes in permutations("yxz", count):
            for angles in product((180, 90, -90), repeat=count):
                pairs = zip(axes, angles, strict=True)
                text = ",".join(f"{axis}:{angle}" for axis, angle in pairs)
                rotation = axis_rotations(text)
                key = np.round(rotation).astype(np.int8).tobytes()
                if key not in seen:
                    seen.add(key)
                    yield text, rotation


def _normals_seen(mesh: Mesh, rotation: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "samples 3"]:
    """Return the normals of a turned mesh at four samples a pixel; zero in the background.

    The rays are turned instead of the mesh, which need not be made ready for rays each time.
    """
    used = mesh.vertices[used_vertices(mesh.faces, len(mesh.vertices))] @ rotation.T
    camera = frame_box(np.stack([used.min(axis=0), used.max(axis=0)]), (_SIZE, _SIZE))
    origins, directions = camera.rays(2)
    hits = mesh.rays.first_hits(mesh.rays.local(origins @ rotation), directions @ rotation)
    hit = hits.face >= 0
    u, v = hits.u[hit], hits.v[hit]
    corners = mesh.normals[mesh.faces[hits.face[hit]]]
    normals = np.zeros((len(hit), 3))
    normals[hit] = np.einsum("nc,nci->ni", np.stack([1 - u - v, u, v], axis=1), corners)
    return normals @ rotation.T


def _is_face(picture: Float[np.ndarray, "H W"]) -> bool:
    # scikit-image is slow to import.
    from skimage.data import lbp_frontal_face_cascade_filename
    from skimage.feature import Cascade

    top = picture.max()
    if top == 0:
        return False
    encoded: UInt8[np.ndarray, "H W"] = (255 * (picture / top) ** (1 / 2.2)).astype(np.uint8)
    found = Cascade(lbp_frontal_face_cascade_filename()).detect_multi_scale(
        encoded,
        scale_factor=1.1,
        step_ratio=1.5,
        min_size=(24, 24),
        max_size=encoded.shape,
        min_neighbor_number=_WINDOWS,
        intersection_score_threshold=0.3,
    )
    return bool(found)
