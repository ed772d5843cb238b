import numpy as np
import pytest

from data_synth.shapes import sphere
from harmface.geometry import frame_orthographic, gbuffer
from harmface.light import DistantLight, EnvironmentMap
from harmface.pca import analytic_pca, uniform_lights
from harmface.reproduce.synthetic import mesh_of
from harmface.sphere import lebedev


def test_arrays_are_shown_by_shape_and_dtype():
    lamps = DistantLight(np.eye(3, dtype=np.float32), np.ones(3))
    assert repr(lamps) == "DistantLight(directions=(3, 3) float32, irradiances=(3,) float64)"


@pytest.mark.parametrize(
    "make",
    [
        lambda: mesh_of(sphere()),
        lambda: gbuffer(mesh_of(sphere()), frame_orthographic(mesh_of(sphere()), 32)),
        lambda: EnvironmentMap.from_image(np.ones((8, 16, 3))),
        lambda: uniform_lights(2),
        lambda: lebedev(5),
        lambda: analytic_pca(lebedev(5).directions),
    ],
)
def test_one_line_tells_what_there_is(make):
    shown = repr(make())
    assert shown.startswith(type(make()).__name__)
    assert len(shown) < 500
    assert "\n" not in shown
    assert "array(" not in shown


class OtherArray:
    """What another library's array looks like to numpy."""

    def __init__(self, values):
        self.values = values

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype)


def test_arrays_of_other_libraries_are_taken(unchecked):
    from harmface.rendering import harmonic_irradiance
    from harmface.sphere import real_harmonics

    normals = lebedev(5).directions
    assert np.array_equal(real_harmonics(OtherArray(normals), 2), real_harmonics(normals, 2))
    light = np.arange(9.0)
    assert np.array_equal(
        harmonic_irradiance(OtherArray(light), OtherArray(normals)),
        harmonic_irradiance(light, normals),
    )
