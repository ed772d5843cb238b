import numpy as np
import pytest

from data_synth.shapes import bumpy_sphere
from harmface.light import DistantLight
from harmface.reproduce.films import rendered_film, turns
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import fibonacci_directions


@pytest.fixture(scope="session")
def film():
    """A bumpy sphere that turns about two axes under soft light from above, small."""
    directions = fibonacci_directions(60)
    light = DistantLight(directions, np.maximum(0.3 + directions[:, 1] + directions[:, 0] / 2, 0))
    return rendered_film(
        mesh_of(bumpy_sphere()), turns("yaw:-30:30,pitch:-15:15", 16), light, 32, noise=0.0, rng=0
    )
