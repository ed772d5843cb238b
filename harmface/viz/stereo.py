"""What photometric stereo was given and what it found."""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure

from harmface.conventions import light_direction
from harmface.rendering import clamped_cosines


def stereo_figure(
    images: Float[np.ndarray, "F H W"],
    normals: Float[np.ndarray, "H W 3"],
    albedo: Float[np.ndarray, "H W"],
    depth: Float[np.ndarray, "H W"],
    mask: Bool[np.ndarray, "H W"],
) -> Figure:
    """Return input samples above the normal map, albedo, two relit views and the depth.

    Parameters
    ----------
    images
        Photographs.
    normals, albedo, depth
        What was found.
    mask
        Pixels of the object.
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    window = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    seen = mask[window]
    figure = Figure(figsize=(11, 4.4 * min(1.3, seen.shape[0] / seen.shape[1]) + 0.3))
    for place, number in enumerate(np.linspace(0, len(images) - 1, 5).astype(int)):
        axes = figure.add_subplot(2, 5, 1 + place)
        sample = images[number][window]
        axes.imshow(sample, cmap="gray", vmin=0, vmax=np.percentile(sample[seen], 99) or 1)
        axes.set_title(f"image {number}", fontsize=8)
    directions = np.stack([light_direction(-50, 20), light_direction(50, 20)])
    shaded = clamped_cosines(normals[window], directions) * albedo[window]
    white = np.percentile(albedo[window][seen], 99) or 1
    pictures = {
        "normals (n + 1) / 2": np.where(seen[..., None], (normals[window] + 1) / 2, 1),
        "albedo": albedo[window] / white,
        "lit from the left": shaded[0] / white,
        "lit from the right": shaded[1] / white,
    }
    for place, (name, picture) in enumerate(pictures.items()):
        axes = figure.add_subplot(2, 5, 6 + place)
        axes.imshow(np.clip(picture, 0, 1), cmap="gray", vmin=0, vmax=1)
        axes.set_title(name, fontsize=8)
    axes = figure.add_subplot(2, 5, 10)
    axes.imshow(np.where(seen, depth[window], np.nan), cmap="viridis")
    axes.set_title("depth", fontsize=8)
    for axes in figure.axes:
        axes.axis("off")
    figure.subplots_adjust(wspace=0.04, hspace=0.12)
    return figure
