"""A closed room, in which light is the same everywhere."""

import numpy as np

from harmface.light import PolygonLight

QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def walls(radiance):
    """Return the walls of the cube from -1 to 1, which shine inwards."""
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    found = []
    for quad in QUADS:
        wall = PolygonLight(corners[list(quad)], radiance)
        if wall.area_vector @ wall.vertices[0] > 0:
            wall = PolygonLight(wall.vertices[::-1], radiance)
        found.append(wall)
    return found
