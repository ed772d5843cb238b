"""What photometric stereo was given and what it found."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from harmface.conventions import light_direction
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.rendering import clamped_cosines
from harmface.viz.figures import NotebookFigure, colour_bar

SAMPLES = 5
MESH_PIXELS = 320
TURNS = ((-40, 15), (40, 15))
"""From where the mesh is shown: degrees about the vertical, and from above."""

STEEP = 0.17
"""Part of a face's normal towards the viewer below which it is not drawn, 80 degrees: at the rim
noise in the normals makes it a fringe."""


def stereo_figure(
    images: Float[np.ndarray, "F H W"],
    normals: Float[np.ndarray, "H W 3"],
    albedo: Float[np.ndarray, "H W"],
    depth: Float[np.ndarray, "H W"],
    mask: Bool[np.ndarray, "H W"],
    mesh: Mesh,
) -> Figure:
    """Return input samples and depth above normal map, albedo, relit views and the mesh.

    Parameters
    ----------
    images
        Photographs.
    normals, albedo, depth
        What was found; depth is shown as it is, zero where there is none.
    mask
        Pixels of the object.
    mesh
        The surface, shown in grey from two sides.

    Returns
    -------
    matplotlib.figure.Figure
        Two rows of panels; photographs, albedo and relit views relative to their 99th percentile.
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    window = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    seen = mask[window]
    panels: dict[str, np.ndarray] = {}
    for number in np.linspace(0, len(images) - 1, SAMPLES).astype(int):
        sample = images[number][window]
        panels[f"image {number + 1}"] = sample / (np.percentile(sample[seen], 99) or 1)
    panels["depth"] = np.where(seen & (depth[window] != 0), depth[window], np.nan)
    white = np.percentile(albedo[window][seen], 99) or 1
    relit = {}
    for name, azimuth in (("left", -50), ("right", 50)):
        shaded = clamped_cosines(normals[window], light_direction(azimuth, 20)[None])[0]
        relit[f"lit from the {name}"] = shaded * albedo[window] / white
    panels |= {
        "normals (n + 1) / 2": np.where(seen[..., None], (normals[window] + 1) / 2, 1),
        "albedo": albedo[window] / white,
        **relit,
        "mesh, from the left": mesh_picture(mesh, *TURNS[0]),
        "mesh, from the right": mesh_picture(mesh, *TURNS[1]),
    }
    figure = NotebookFigure(figsize=(13, 4.4 * min(1.3, seen.shape[0] / seen.shape[1]) + 0.3))
    for place, (name, picture) in enumerate(panels.items()):
        axes = figure.add_subplot(2, SAMPLES + 1, 1 + place)
        if name == "depth":
            shown = axes.imshow(picture, cmap="viridis")
            colour_bar(axes, shown, "towards the viewer / pixels")
        else:
            axes.imshow(np.clip(picture, 0, 1), cmap="gray", vmin=0, vmax=1)
        axes.set_title(name, fontsize=8)
        axes.axis("off")
    figure.subplots_adjust(wspace=0.06, hspace=0.12, left=0.01, right=0.99, bottom=0.01, top=0.94)
    return figure


def mesh_picture(mesh: Mesh, azimuth: float, elevation: float) -> Float[np.ndarray, "n n"]:
    """Return a mesh in grey, lit from the camera, seen from an azimuth and an elevation.

    Parameters
    ----------
    mesh
        What to show; albedo plays no part.
    azimuth, elevation
        Where the camera stands, degrees to the right of the +z axis and above it.

    Returns
    -------
    numpy.ndarray
        Grey in [0, 1], 1 in the background.
    """
    a, b, c = (mesh.vertices[corner] for corner in mesh.faces.T)
    across = np.cross(b - a, c - a)
    drawn = across[:, 2] > STEEP * np.linalg.norm(across, axis=1)
    front = replace(mesh, faces=mesh.faces[drawn]) if drawn.any() else mesh
    turn = Rotation.from_euler("yx", [-azimuth, elevation], degrees=True).as_matrix()
    turned = front.rotated(turn)
    view = gbuffer(turned, frame_orthographic(turned, MESH_PIXELS))
    lit = clamped_cosines(view.normals, light_direction(-20, 30)[None])[0]
    return np.where(view.mask, 0.08 + 0.85 * lit, 1.0)
