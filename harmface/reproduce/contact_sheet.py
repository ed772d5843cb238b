"""Many heads on one picture."""

import numpy as np
from jaxtyping import Float

from data_synth.environments import ENVIRONMENTS, rasterise
from harmface.geometry import Mesh, frame_orthographic, gbuffer
from harmface.light import EnvironmentMap
from harmface.rendering import box_average, render
from harmface.reproduce.synthetic import Progress

SIDE = 192
SUPERSAMPLING = 2
DIRECTIONS = 96
BACKGROUND = 0.18
WHITE = 0.9
"""Where the brightest half percent of all skin is put."""


def contact_sheet(
    meshes: list[Mesh], progress: Progress = lambda done: None
) -> Float[np.ndarray, "H W 3"]:
    """Return heads side by side, rendered by the oracle in the studio's soft light.

    All share one exposure, so that skin tones can be compared.

    Parameters
    ----------
    meshes
        The heads.
    progress
        Told how much is done.

    Returns
    -------
    numpy.ndarray
        Linear RGB.
    """
    studio = EnvironmentMap.from_image(rasterise(ENVIRONMENTS["studio"](), 64))
    light = studio.as_distant_light(DIRECTIONS)
    tiles, masks = [], []
    for number, mesh in enumerate(meshes):
        view = gbuffer(mesh, frame_orthographic(mesh, SIDE * SUPERSAMPLING))
        image = render(view, light, albedo=np.moveaxis(view.albedo, -1, 0), caster=mesh)
        tiles.append(np.moveaxis(box_average(image, SUPERSAMPLING), 0, -1))
        masks.append(box_average(view.mask.astype(float), SUPERSAMPLING)[..., None])
        progress((number + 1) / len(meshes))
    pictures, cover = np.stack(tiles), np.stack(masks)
    exposure = WHITE / np.percentile(pictures[cover[..., 0] == 1], 99.5)
    pictures = pictures * exposure + (1 - cover) * BACKGROUND
    columns = int(np.ceil(np.sqrt(1.5 * len(meshes))))
    rows = -(-len(meshes) // columns)
    sheet = np.full((rows * columns, SIDE, SIDE, 3), BACKGROUND)
    sheet[: len(pictures)] = pictures
    return (
        sheet.reshape(rows, columns, SIDE, SIDE, 3)
        .swapaxes(1, 2)
        .reshape(rows * SIDE, columns * SIDE, 3)
    )
