"""The oracle: images by summing over directions and casting rays, without harmonics.

Every image that a method is scored on comes from here, so that no method is judged by its own
model.
"""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import luminance
from harmface.errors import ArgumentError
from harmface.geometry import GBuffer, Mesh, visible
from harmface.geometry.visibility import OFFSET
from harmface.light import DistantLight, EnvironmentMap, sample

CHUNK = 2**22
"""Pairs of direction and pixel treated at a time: 32 MB in float64."""


@runtime_checkable
class Reflector(Protocol):
    """What the oracle asks of a material: its reflectance, as `reflectance.Material` has it."""

    def evaluate(self, incoming: np.ndarray, outgoing: np.ndarray) -> np.ndarray:
        """Return reflectance per steradian, `(*channels, *pairs)`, in the surface's frame.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal.

        Returns
        -------
        numpy.ndarray
            Per steradian, shape `(*channels, *pairs)`.
        """
        ...


def clamped_cosines(
    normals: Float[np.ndarray, "*pixels 3"], directions: Float[np.ndarray, "J 3"]
) -> Float[np.ndarray, "J *pixels"]:
    """Return `max(n . w, 0)`: irradiance from each direction alone, attached shadows included.

    Parameters
    ----------
    normals
        Unit normals; zero vectors (the background) give 0.
    directions
        Unit directions to the light.

    Returns
    -------
    numpy.ndarray
        Shape `(J, *pixels)`, in [0, 1].

    Raises
    ------
    ArgumentError
        If a component is not finite, or there are not three of each.
    """
    normals = checks.finite("normals", checks.vectors("normals", normals))
    directions = checks.finite("directions", checks.vectors("directions", directions))
    return np.maximum(np.tensordot(directions, np.moveaxis(normals, -1, 0), axes=1), 0)


def irradiance(
    normals: Float[np.ndarray, "*pixels 3"],
    light: DistantLight,
    visibility: Bool[np.ndarray, "J *pixels"] | None = None,
) -> Float[np.ndarray, "..."]:
    """Return `E(n) = sum_j e_j max(n . w_j, 0) V_j`, the integral of RH01 eq. 1 as a sum.

    Parameters
    ----------
    normals
        Unit normals; zero vectors (the background) give 0.
    light
        Directions and the irradiance each gives at normal incidence.
    visibility
        Whether each direction reaches each pixel; all do if not given.

    Returns
    -------
    numpy.ndarray
        Irradiance, the light's leading axes first.

    Raises
    ------
    ArgumentError
        If shapes do not agree, or the normals are no unit vectors.
    """
    normals = checks.vectors("normals", normals)
    pixels = normals.shape[:-1]
    flat = normals.reshape(-1, 3)
    shadow = None if visibility is None else visibility.reshape(len(light.directions), -1)
    total = np.zeros((*light.irradiances.shape[:-1], len(flat)))
    for some in _chunks(len(light.directions), len(flat)):
        cosines = clamped_cosines(flat, light.directions[some])
        if shadow is not None:
            cosines *= shadow[some]
        total += light.irradiances[..., some] @ cosines
    return total.reshape(*total.shape[:-1], *pixels)


def render(
    view: GBuffer,
    light: DistantLight,
    *,
    albedo: Float[np.ndarray, "*channels H W"] | None = None,
    caster: Mesh | None = None,
    material: Reflector | None = None,
) -> Float[np.ndarray, "... H W"]:
    """Return pi times the radiance that the camera sees; of a matte surface that is radiosity.

    Parameters
    ----------
    view
        What the camera sees.
    light
        Distant light; its leading axes (images, channels) lead the result.
    albedo
        Albedo that broadcasts against the images: a single channel, or channels first with
        light that has them too. By default the luminance of the view's albedo.
    caster
        The mesh that casts shadows; without it only attached shadows are rendered.
    material
        Its reflectance is multiplied by the albedo; by default Lambert's `1 / pi`. One in colour
        needs light of as many channels as its own, on the last leading axis.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, H, W)`, 0 in the background; float64.

    Raises
    ------
    ArgumentError
        If shapes do not agree.
    """
    if albedo is None:
        albedo = luminance(view.albedo)
    albedo = checks.non_negative("albedo", albedo)
    if albedo.shape[-2:] != view.mask.shape:
        raise ArgumentError(
            f"albedo must have the view's size {view.mask.shape}, got {albedo.shape}"
        )
    normals, points = view.normals[view.mask], view.position[view.mask]
    leading = light.irradiances.shape[:-1]
    received = np.zeros((*leading, len(normals)))
    # A material needs some eight numbers of each pair of direction and pixel.
    width = len(normals) * (1 if material is None else 8)
    for some in _chunks(len(light.directions), width):
        directions = light.directions[some]
        cosines = clamped_cosines(normals, directions)
        if caster is not None:
            cosines *= visible(caster, points, normals, directions)
        if material is None:
            received += light.irradiances[..., some] @ cosines
        else:
            outgoing = view.camera.towards(points)
            shown = shown_by(material, normals, outgoing, directions, cosines)
            received += np.einsum("...j,...jp->...p", light.irradiances[..., some], shown)
    image = np.zeros((*leading, *view.mask.shape))
    image[..., view.mask] = albedo[..., view.mask] * received
    return image


def mirrored(
    view: GBuffer, environment: EnvironmentMap, *, caster: Mesh | None = None
) -> Float[np.ndarray, "*channels H W"]:
    """Return pi times the radiance that the camera sees in a mirror, by looking it up.

    Parameters
    ----------
    view
        What the camera sees; its albedo is not used.
    environment
        Radiance from all sides.
    caster
        The mesh that hides what it mirrors of itself, as black.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, H, W)`, 0 in the background.
    """
    normals, points = view.normals[view.mask], view.position[view.mask]
    to_camera = view.camera.towards(points)
    along = np.einsum("pi,pi->p", to_camera, normals)
    directions = 2 * along[:, None] * normals - to_camera
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    seen = along > 0
    if caster is not None:
        starts = caster.rays.local(points + OFFSET * caster.rays.radius * normals)
        seen &= caster.rays.first_hits(starts, directions).face < 0
    image = np.zeros((*environment.channels, *view.mask.shape))
    image[..., view.mask] = np.pi * sample(environment, directions) * seen
    return image


def vertex_irradiance(
    mesh: Mesh,
    light: DistantLight,
    *,
    cast_shadows: bool = True,
    progress: Callable[[float], None] = lambda done: None,
) -> Float[np.ndarray, "*channels V"]:
    """Return the irradiance of every vertex of a mesh, by rays and sums.

    Parameters
    ----------
    mesh
        The surface, which also casts the shadows.
    light
        Distant light; its leading axes lead the result.
    cast_shadows
        Whether the mesh shadows itself.
    progress
        Told the fraction done.

    Returns
    -------
    numpy.ndarray
        Irradiance, the light's leading axes first.

    Examples
    --------
    A floor under a lamp straight above it receives what the lamp gives:

    >>> corners = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    >>> up = np.tile([0.0, 0, 1], (4, 1))
    >>> floor = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), up, np.ones((4, 3)))
    >>> vertex_irradiance(floor, DistantLight(up[:1], np.array([2.0])))
    array([2., 2., 2., 2.])
    """
    total = np.zeros((*light.irradiances.shape[:-1], len(mesh.vertices)))
    parts = _chunks(len(light.directions), len(mesh.vertices))
    for number, some in enumerate(parts, 1):
        directions = light.directions[some]
        part = DistantLight(directions, light.irradiances[..., some])
        reached = visible(mesh, mesh.vertices, mesh.normals, directions) if cast_shadows else None
        total += irradiance(mesh.normals, part, reached)
        progress(number / len(parts))
    return total


def reflected(
    mesh: Mesh,
    view: GBuffer,
    light: DistantLight,
    bounces: int,
    *,
    rays: int = 256,
    rng: np.random.Generator | int = 0,
) -> Float[np.ndarray, "... H W"]:
    """Return the irradiance that a mesh sends to itself, which `render` leaves out.

    Each bounce is a mean over rays drawn with the cosine as their density, between which radiosity
    is interpolated linearly from the vertices.

    Parameters
    ----------
    mesh
        The surface; vertices reflect the luminance of their albedo.
    view
        What the camera sees of it.
    light
        Distant light; its leading axes lead the result.
    bounces
        How often light is reflected from the surface to itself.
    rays
        Number from each vertex and pixel.
    rng
        Generator or seed.

    Returns
    -------
    numpy.ndarray
        Irradiance, `(..., H, W)`; 0 in the background.

    Raises
    ------
    ArgumentError
        If `bounces` is negative, or `rays` below 1.
    """
    from scipy.sparse import csr_array, vstack

    bounces = checks.integer("bounces", bounces, 0)
    rays = checks.positive_integer("rays", rays)
    rng = checks.generator(rng)
    normals, points = view.normals[view.mask], view.position[view.mask]

    def shares(points: np.ndarray, normals: np.ndarray) -> csr_array:
        """Return how much of each vertex's radiosity arrives at points, by rays."""
        rows = []
        starts = mesh.rays.local(points + OFFSET * mesh.rays.radius * normals)
        for some in _chunks(len(points), rays):
            # A unit vector plus one uniform over the sphere has the cosine's density.
            drawn = rng.standard_normal((some.stop - some.start, rays, 3))
            drawn /= np.linalg.norm(drawn, axis=-1, keepdims=True)
            drawn += normals[some, None]
            drawn /= np.linalg.norm(drawn, axis=-1, keepdims=True)
            directions = drawn.reshape(-1, 3)
            hits = mesh.rays.first_hits(np.repeat(starts[some], rays, axis=0), directions)
            facing = np.einsum("ni,ni->n", mesh.face_normals[hits.face], directions) < 0
            met = (hits.face >= 0) & facing
            u, v = hits.u[met], hits.v[met]
            weights = np.stack([1 - u - v, u, v], axis=1) / rays
            columns = mesh.faces[hits.face[met]]
            counts = 3 * met.reshape(-1, rays).sum(axis=1)
            ends = np.concatenate([[0], np.cumsum(counts)])
            shape = (len(counts), len(mesh.vertices))
            rows.append(csr_array((weights.ravel(), columns.ravel(), ends), shape=shape))
        return vstack(rows, format="csr")

    image = np.zeros((*light.irradiances.shape[:-1], *view.mask.shape))
    if bounces:
        arriving = np.zeros((*light.irradiances.shape[:-1], len(mesh.vertices)))
        for some in _chunks(len(light.directions), len(mesh.vertices)):
            directions = light.directions[some]
            cosines = clamped_cosines(mesh.normals, directions)
            cosines *= visible(mesh, mesh.vertices, mesh.normals, directions)
            arriving += light.irradiances[..., some] @ cosines
        albedo = luminance(mesh.albedo)
        flat = arriving.reshape(-1, len(albedo)).T
        between = shares(mesh.vertices, mesh.normals)
        total = flat
        for _ in range(bounces - 1):
            flat = between @ (albedo[:, None] * flat)
            total = total + flat
        found = shares(points, normals) @ (albedo[:, None] * total)
        image[..., view.mask] = found.T.reshape(*image.shape[:-2], -1)
    return image


def box_average(
    images: Float[np.ndarray, "*images H W"], factor: int
) -> Float[np.ndarray, "*images h w"]:
    """Return images of `1 / factor` the size, each pixel the mean of its block.

    Parameters
    ----------
    images
        Linear images whose sides are multiples of `factor`.
    factor
        Side of a block.

    Returns
    -------
    numpy.ndarray
        Shape `(*images, H / factor, W / factor)`, in the precision of `images`.

    Raises
    ------
    ArgumentError
        If `factor` is below 1 or does not divide both sides.
    """
    factor = checks.positive_integer("factor", factor)
    images = checks.finite("images", images)
    *leading, rows, columns = images.shape
    if rows % factor or columns % factor:
        raise ArgumentError(f"images of {rows} x {columns} do not divide into blocks of {factor}")
    blocks = images.reshape(*leading, rows // factor, factor, columns // factor, factor)
    return blocks.mean(axis=(-3, -1))


def shown_by(
    material: Reflector,
    normals: Float[np.ndarray, "p 3"],
    to_camera: Float[np.ndarray, "p 3"],
    directions: Float[np.ndarray, "J 3"],
    cosines: Float[np.ndarray, "J p"],
) -> Float[np.ndarray, "*channels J p"]:
    """Return pi times reflectance times cosine, for pairs that are lit and seen only."""
    along = np.einsum("pi,pi->p", to_camera, normals)
    lit, pixel = np.nonzero((cosines > 0) & (along > 0))
    # An isotropic material knows the height of both directions, and how they lie to each other:
    # the viewer is put in the plane of z and x, whatever tangent that is.
    across = to_camera - along[:, None] * normals
    sine = np.linalg.norm(across, axis=-1)
    spare = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=-1)])
    tangent = np.where(sine[:, None] > 1e-6, across, spare)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    frame = np.stack([tangent, np.cross(normals, tangent), normals], axis=1)
    incoming = np.einsum("ni,nki->nk", directions[lit], frame[pixel])
    outgoing = np.stack([sine, np.zeros_like(sine), along], axis=-1)[pixel]
    values = material.evaluate(incoming, outgoing)
    shown = np.zeros((*values.shape[:-1], *cosines.shape))
    shown[..., lit, pixel] = np.pi * values * cosines[lit, pixel]
    return shown


def _chunks(count: int, width: int) -> list[slice]:
    step = max(1, CHUNK // max(1, width))
    return [slice(first, min(first + step, count)) for first in range(0, count, step)]
