"""Where a mesh lies in a photograph: weak perspective from pairs of points, or from its outline.

References
----------
.. [HZ04] Hartley and Zisserman, Multiple View Geometry in Computer Vision, 2nd edition, 2004,
   sections 6.3 and 14.2.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import Mesh, OrthographicCamera, frame_orthographic, gbuffer

FEWEST = 2
"""Pairs that give place, size and a turn in the picture."""

FEWEST_SOLID = 4
"""Pairs that give a turn in space, if they do not lie in a plane."""

FLAT = 0.02
"""Third singular value of the points, as a share of the first, below which they lie in a plane."""


def pose_from_landmarks(
    mesh: Mesh,
    pixels: Float[np.ndarray, "n 2"],
    points: Float[np.ndarray, "n 3"],
    shape: tuple[int, int],
) -> tuple[Mesh, OrthographicCamera]:
    """Return the mesh as a photograph shows it, and the camera, by least squares.

    Under weak perspective a point `X` is seen at `s R X + t`, two rows of a rotation `R`. With four
    pairs or more that do not lie in a plane the best 2 x 3 matrix is found and the nearest scaled
    rows of a rotation to it ([HZ04]_); otherwise the mesh turns in the picture only.

    Parameters
    ----------
    mesh
        The mesh, facing the viewer unless landmarks turn it.
    pixels
        Column and row of each landmark, pixel centres at half-integers.
    points
        Its place on the mesh.
    shape
        Rows and columns of the photograph.

    Returns
    -------
    tuple of Mesh and OrthographicCamera
        The mesh turned, and a camera of the photograph's shape.

    Raises
    ------
    ArgumentError
        If there are fewer than two pairs, their numbers differ, or all coincide.
    """
    pixels, points = checks.finite("pixels", pixels), checks.finite("points", points)
    if pixels.ndim != 2 or pixels.shape[1] != 2 or points.shape != (len(pixels), 3):
        raise ArgumentError(
            "pixels (n, 2) and points (n, 3) must be pairs, got shapes "
            f"{pixels.shape} and {points.shape}"
        )
    if len(pixels) < FEWEST:
        raise ArgumentError(f"landmarks must be at least {FEWEST} pairs, got {len(pixels)}")
    rows, columns = shape
    seen = np.column_stack([pixels[:, 0] - columns / 2, rows / 2 - pixels[:, 1]])
    centre, middle = points.mean(axis=0), seen.mean(axis=0)
    shapes, places = points - centre, seen - middle
    spread = np.linalg.svd(shapes, compute_uv=False)
    if len(points) >= FEWEST_SOLID and spread[2] > FLAT * spread[0]:
        affine = np.linalg.lstsq(shapes, places, rcond=None)[0].T
        left, sizes, right = np.linalg.svd(affine, full_matrices=False)
        scale = float(sizes.mean())
        two = left @ right
        rotation = np.stack([two[0], two[1], np.cross(two[0], two[1])])
    else:
        # The turn and size that carry the points' own x and y to the picture.
        z, w = shapes[:, 0] + 1j * shapes[:, 1], places[:, 0] + 1j * places[:, 1]
        power = float(np.vdot(z, z).real)
        factor = np.vdot(z, w) / power if power > 0 else 0.0
        scale, angle = float(np.abs(factor)), float(np.angle(factor))
        c, s = np.cos(angle), np.sin(angle)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if not scale > 0:
        raise ArgumentError("landmarks must lie at different places in mesh and photograph")
    turned = mesh.rotated(rotation)
    x, y = (rotation @ centre)[:2] - middle / scale
    return turned, _camera(turned, float(x), float(y), rows / scale, shape)


def camera_from_mask(
    mesh: Mesh, mask: Bool[np.ndarray, "H W"], rounds: int = 3
) -> OrthographicCamera:
    """Return the camera under which the mesh's outline fills the box that a mask fills.

    Height and centre of the two boxes are made alike, by rendering a few times.

    Parameters
    ----------
    mesh
        The mesh in the pose of the photograph.
    mask
        Where the photograph shows it; it must not be cut by the picture's edge.
    rounds
        Corrections.

    Returns
    -------
    OrthographicCamera
        With as many rows and columns as the mask.

    Raises
    ------
    ArgumentError
        If the mask is empty.
    """
    if not mask.any():
        raise ArgumentError("mask must show the object, got one that is false everywhere")
    shape = (mask.shape[0], mask.shape[1])
    camera = frame_orthographic(mesh, shape)
    low, high = _box(mask)
    for _ in range(rounds):
        own_low, own_high = _box(gbuffer(mesh, camera).mask)
        pixel = camera.height / shape[0]
        ratio = (own_high[0] - own_low[0]) / (high[0] - low[0])
        # The centre of the own box, in the mesh's unit, is to appear at the mask's centre.
        middle = np.array([shape[0] / 2, shape[1] / 2])
        own, wanted = (own_low + own_high) / 2 - middle, (low + high) / 2 - middle
        x = camera.center[0] + pixel * (own[1] - ratio * wanted[1])
        y = camera.center[1] - pixel * (own[0] - ratio * wanted[0])
        camera = _camera(mesh, float(x), float(y), float(camera.height * ratio), shape)
    return camera


def _box(mask: Bool[np.ndarray, "H W"]) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and greatest row and column edges of a mask."""
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    return np.array([rows[0], columns[0]]), np.array([rows[-1] + 1, columns[-1] + 1])


def _camera(
    mesh: Mesh, x: float, y: float, height: float, shape: tuple[int, int]
) -> OrthographicCamera:
    low, high = mesh.bounds
    return OrthographicCamera((x, y, float(2 * high[2] - low[2] + height)), height, shape)
