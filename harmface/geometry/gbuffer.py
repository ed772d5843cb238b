"""What a camera sees of a mesh, pixel by pixel."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer
from scipy.sparse import csr_array

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.camera import Camera
from harmface.geometry.mesh import Mesh
from harmface.geometry.texture import Texture
from harmface.summaries import summary

MAX_SAMPLES = 2**27
"""Most rays of one G-buffer: about 20 GB of intermediate arrays."""


@dataclass(frozen=True, eq=False)
class GBuffer:
    """Geometry and albedo of the surface seen at each pixel; background pixels hold zeros.

    Parameters
    ----------
    normals
        Unit normals in the frame of the mesh.
    albedo
        Linear RGB in [0, 1].
    depth
        Distance in front of the camera along -z, the mean over a pixel's samples; infinite in the
        background.
    position
        Point on the surface: the sample nearest to their mean, which itself lies below a curved
        surface, in the dark.
    mask
        True where the mesh covers at least half the samples of a pixel.
    camera
        The view it was taken from.
    """

    normals: Float[np.ndarray, "H W 3"]
    albedo: Float[np.ndarray, "H W 3"]
    depth: Float[np.ndarray, "H W"]
    position: Float[np.ndarray, "H W 3"]
    mask: Bool[np.ndarray, "H W"]
    camera: Camera

    __repr__ = summary


def gbuffer(mesh: Mesh, camera: Camera, supersampling: int = 1) -> GBuffer:
    """Cast rays through every pixel and return what they meet first.

    Normals and albedo are interpolated linearly between the vertices; where the mesh has a
    texture, albedo is looked up in it at each sample, averaged over what the sample stands for.
    With `supersampling = n`
    each pixel averages the samples that hit the mesh among n x n; the mean normal is made unit
    again.

    Parameters
    ----------
    mesh
        The surface.
    camera
        The view.
    supersampling
        Samples along each side of a pixel.

    Returns
    -------
    GBuffer
        Float64 arrays of the camera's rows and columns.

    Raises
    ------
    ArgumentError
        If no ray meets the mesh, or the picture is larger than memory.
    """
    n = checks.positive_integer("supersampling", supersampling)
    rows, columns = camera.shape
    hit, face, weights = _cast(mesh, camera, n)
    interpolate, samples, starts = _interpolation(mesh, camera, n, hit, face, weights)
    normals = interpolate @ mesh.normals.astype(np.float64, copy=False)
    mask = samples * 2 >= n * n
    length = np.sqrt(np.einsum("pi,pi->p", normals, normals))
    # Opposite normals in one pixel leave nothing to normalise: no surface to speak of.
    mask &= length > 1e-6 * samples
    normals *= np.divide(1, length, out=np.zeros_like(length), where=mask)[:, None]
    share = np.divide(1, samples, out=np.zeros_like(length), where=mask)[:, None]
    middle = interpolate @ mesh.vertices.astype(np.float64, copy=False) * share
    position = middle if n == 1 else _nearest(mesh, face, weights, middle, samples) * mask[:, None]
    if mesh.texture is None:
        albedo = interpolate @ mesh.albedo.astype(np.float64, copy=False)
    else:
        each = _looked_up(mesh, mesh.texture, face, weights, camera, n)
        ones = np.ones(len(each))
        albedo = csr_array((ones, np.arange(len(each)), starts)) @ each
    # Rounding of the weights can carry a mean past the ends of the range.
    albedo = np.clip(albedo * share, 0, 1)
    depth = np.where(mask, camera.center[2] - middle[:, 2], np.inf)
    image = (rows, columns)
    return GBuffer(
        normals.reshape(*image, 3),
        albedo.reshape(*image, 3),
        depth.reshape(image),
        position.reshape(*image, 3),
        mask.reshape(image),
        camera,
    )


def vertex_weights(mesh: Mesh, camera: Camera) -> csr_array:
    """Return the matrix that interpolates values of vertices at the centres of all pixels.

    Parameters
    ----------
    mesh
        The surface.
    camera
        The view.

    Returns
    -------
    scipy.sparse.csr_array
        A row of three weights for each pixel, `(H W, V)`, none in the background: times values
        `(V, ...)` it gives what `gbuffer` without supersampling sees of them.

    Raises
    ------
    ArgumentError
        If no ray meets the mesh, or the picture is larger than memory.
    """
    return _interpolation(mesh, camera, 1, *_cast(mesh, camera, 1))[0]


def _cast(
    mesh: Mesh, camera: Camera, n: int
) -> tuple[Bool[np.ndarray, "S"], Integer[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Return which samples hit the mesh, and of these the face and the weights of its vertices."""
    rows, columns = camera.shape
    if rows * columns * n * n > MAX_SAMPLES:
        raise ArgumentError(
            f"shape {camera.shape} with supersampling {n} takes {rows * columns * n * n} rays, "
            f"more than {MAX_SAMPLES}; ask for a smaller picture"
        )
    origins, directions = camera.rays(n)
    hits = mesh.rays.first_hits(mesh.rays.local(origins), directions)
    hit = hits.face >= 0
    if not hit.any():
        raise ArgumentError("camera must see the mesh, but no ray meets it; use a framing helper")
    u, v = hits.u[hit].astype(np.float64), hits.v[hit].astype(np.float64)
    return hit, hits.face[hit], np.stack([1 - u - v, u, v], axis=1)


def _interpolation(
    mesh: Mesh,
    camera: Camera,
    n: int,
    hit: Bool[np.ndarray, "S"],
    face: Integer[np.ndarray, "N"],
    weights: Float[np.ndarray, "N 3"],
) -> tuple[csr_array, Integer[np.ndarray, "P"], Integer[np.ndarray, "P1"]]:
    """Return the matrix from vertices to sums over pixels, and the samples of each and their start.

    The samples of a pixel follow one another, so a sparse matrix with a row a pixel both
    interpolates between the vertices and sums over the samples, in one pass.
    """
    rows, columns = camera.shape
    samples = hit.reshape(rows * columns, n * n).sum(axis=1)
    starts = np.concatenate([[0], np.cumsum(samples)])
    interpolate = csr_array(
        (weights.reshape(-1), mesh.faces[face].reshape(-1), 3 * starts),
        shape=(rows * columns, len(mesh.vertices)),
    )
    return interpolate, samples, starts


def _nearest(
    mesh: Mesh,
    face: Integer[np.ndarray, "N"],
    weights: Float[np.ndarray, "N 3"],
    middle: Float[np.ndarray, "P 3"],
    samples: Integer[np.ndarray, "P"],
) -> Float[np.ndarray, "P 3"]:
    """Return the sample of each pixel that is nearest to a point, zero where there is none."""
    places = np.einsum("nc,nci->ni", weights, mesh.vertices[mesh.faces[face]])
    pixel = np.repeat(np.arange(len(samples)), samples)
    distance = ((places - middle[pixel]) ** 2).sum(axis=1)
    # Sorted by pixel, and by distance within: the first of each run.
    order = np.lexsort((distance, pixel))
    covered = samples > 0
    first = np.concatenate([[0], np.cumsum(samples)])[:-1][covered]
    found = np.zeros((len(samples), 3))
    found[covered] = places[order[first]]
    return found


def _looked_up(
    mesh: Mesh,
    texture: Texture,
    face: Integer[np.ndarray, "N"],
    weights: Float[np.ndarray, "N 3"],
    camera: Camera,
    supersampling: int,
) -> Float[np.ndarray, "N 3"]:
    """Return the albedo of samples: the texture's, or the vertices' where a face has none."""
    corners = mesh.faces[face]
    image = texture.image[face]
    points = np.einsum("nc,nci->ni", weights, mesh.vertices[corners])
    side = camera.pixel_sizes(points) / supersampling
    edges = mesh.vertices[mesh.faces[:, 1:]] - mesh.vertices[mesh.faces[:, :1]]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    edges = texture.uv[mesh.faces[:, 1:]] - texture.uv[mesh.faces[:, :1]]
    pictured = np.abs(np.linalg.det(edges))
    stretch = np.sqrt(np.divide(pictured, area, out=np.zeros_like(area), where=area > 0))
    found = texture.sample(corners, image, weights, side * stretch[face])
    plain = image < 0
    found[plain] = np.einsum("nc,nci->ni", weights[plain], mesh.albedo[corners[plain]])
    return found
