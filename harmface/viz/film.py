"""What a film showed and the surface found from it."""

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from harmface.conventions import harmonic_count
from harmface.geometry import Mesh
from harmface.light import layout_named
from harmface.moving import FilmSurface, Views
from harmface.sphere import real_harmonics
from harmface.viz.figures import NotebookFigure
from harmface.viz.stereo import mesh_picture

SAMPLES = 4
SIDES = (-60, 0, 60)
"""From where the surface is shown, degrees about the vertical."""


def film_figure(frames: Float[np.ndarray, "F H W"], views: Views, found: FilmSurface) -> Figure:
    """Return frames above the surface from three sides, normals, albedo, and the light.

    Parameters
    ----------
    frames
        Linear brightness.
    views
        Of the frames.
    found
        What the film told.

    Returns
    -------
    matplotlib.figure.Figure
        Two rows of four panels.
    """
    white = np.percentile(frames[:, found.mask], 99) or 1
    panels: dict[str, np.ndarray] = {}
    # Not the first and the last: a turn to and fro begins and ends alike.
    for number in np.linspace(0, len(frames) - 1, SAMPLES + 1)[1:-1].astype(int):
        panels[f"frame {number + 1}"] = (frames[number] / white) ** (1 / 2.2)
    panels["albedo"] = found.albedo
    turned: Mesh = found.mesh.rotated(views.rotations[found.frame])
    for side in SIDES:
        panels[f"surface, {side:+d} degrees"] = mesh_picture(turned, side, 5)
    directions = layout_named("latlong").directions(48)
    light = real_harmonics(directions, 2)[: harmonic_count(2)]
    seen = np.tensordot(found.lighting, light, axes=1)
    panels["light to degree 2, all directions"] = np.clip(seen / np.abs(seen).max(), 0, 1)
    figure = NotebookFigure(figsize=(12, 6.4))
    for place, (name, picture) in enumerate(panels.items()):
        axes = figure.add_subplot(2, SAMPLES, 1 + place)
        axes.imshow(np.clip(picture, 0, 1), cmap="gray", vmin=0, vmax=1)
        axes.set_title(name, fontsize=8)
        axes.axis("off")
    figure.suptitle(
        f"the fit leaves {found.residual:.1%} of the frames' brightness "
        f"({found.shading_error:.1%} for the normals of the surface)",
        fontsize=9,
    )
    return figure
